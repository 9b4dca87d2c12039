"""The MAVLink session as a machine without I/O."""
