"""The quadrotor, its rotors and what it stands on."""
