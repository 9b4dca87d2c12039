"""What only PX4 tells a ground station: metadata, modes, health."""
