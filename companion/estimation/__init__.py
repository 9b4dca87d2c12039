"""Where the vehicle is, and where it will be."""
