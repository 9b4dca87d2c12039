"""The MAVLink session as a machine without I/O, and the transports around it."""
