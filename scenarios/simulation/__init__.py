"""What a run simulates, without I/O: the vehicle with its sensors, the air, the autopilot with its drone."""
