"""What runs the steps: configuration, node, wire loop, links."""
