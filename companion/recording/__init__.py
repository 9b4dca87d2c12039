"""A companion that records what it was given and what it made of it."""
