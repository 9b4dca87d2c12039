"""The drone under its flight controller, and how well it knows itself."""
