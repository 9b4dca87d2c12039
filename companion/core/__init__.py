"""What all parts of the companion hand to each other, in SI units and W."""
