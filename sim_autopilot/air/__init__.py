"""The air at the drone: wind, turbulence, and what a vehicle makes of them."""
