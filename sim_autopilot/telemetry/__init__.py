"""What the autopilot tells of itself, and when."""
