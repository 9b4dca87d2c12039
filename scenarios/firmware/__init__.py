"""Landings with a firmware's own simulation."""
