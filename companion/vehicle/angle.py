"""The short way round for the estimators, whose compiled functions call it.

`link.frames.rotations.wrap_angle` does the same where all is Python: it is exact, and numba has no `math.remainder`.
"""

import math

from companion.vehicle.compiled import compiled_kernel


@compiled_kernel
def short_way_round(angle_rad: float) -> float:
    """Return the same angle in [-pi, pi)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi
