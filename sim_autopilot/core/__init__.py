"""What all parts of the autopilot hand to each other: modes, settings, parameters, streams, and what a firmware is."""
