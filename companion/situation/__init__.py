"""What is known in one step, and the phases of a landing that decide on it."""
