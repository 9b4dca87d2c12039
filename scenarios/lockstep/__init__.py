"""A run in one process on a simulated clock: the same seed gives the same result, bit for bit."""
