"""What differs between the autopilots that the companion flies."""
