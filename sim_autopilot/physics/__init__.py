"""The quadrotor, its rotors, the air and what it stands on."""
