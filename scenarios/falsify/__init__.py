"""The search for a world in which a landing fails, and its reduction to a small scenario file."""
