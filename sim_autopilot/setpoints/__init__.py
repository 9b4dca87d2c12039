"""Setpoints, and what each firmware makes of them."""
