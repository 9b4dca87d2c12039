"""A simulated quadrotor with its flight controller, behind the MAVLink front of a real one."""
