"""The gravity that the companion reckons with; a simulated drone has its own, of its physics."""

GRAVITY_M_S2 = 9.81
"""At mid latitudes; 9.780 at the equator to 9.832 at the poles (WGS 84)."""
