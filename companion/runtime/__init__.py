"""What runs the steps: node, wire loop, terminal, views, and what a user starts them with."""
