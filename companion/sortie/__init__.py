"""Flights away from the vehicle and home to it: stations, the way round it, the energy, the quiet deck."""
