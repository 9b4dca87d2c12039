"""What a camera on the drone sees in the simulation: light, surfaces, lens and sensor, without I/O."""
