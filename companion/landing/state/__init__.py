"""What a step is given, what it remembers, and what it hands on."""
