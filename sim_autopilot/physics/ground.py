"""How high the ground is: flat, at z = 0 in W, about the start, and beside a road that leads down as low as this.

Such a road runs in a cutting of at most `CUTTING_M`: roughness and a ship's heave move no ground. Where the flat ends,
it falls like a bank.
"""

import math

from link.compiled import kernel

CUTTING_M = 0.5
LEVEL_M = 10.0
"""As far from W's origin, where the drone starts, the ground is flat."""
BANK = 0.5
"""Height per length, as banks of roads are built at most: 1 in 2."""


@kernel
def ground_height(east_m: float, north_m: float, road_m: float) -> float:
    """Return the ground's height in W at a place, while the vehicle's road is at the height `road_m`."""
    bank_m = -BANK * max(math.hypot(east_m, north_m) - LEVEL_M, 0.0)
    return min(0.0, max(road_m + CUTTING_M, bank_m))
