"""Reading an autopilot and a vehicle before a flight, judging them, and setting the advised parameters."""
