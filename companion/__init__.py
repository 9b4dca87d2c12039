"""Lands a drone on a moving vehicle: estimates the vehicle, plans by MPC, flies any MAVLink autopilot."""
