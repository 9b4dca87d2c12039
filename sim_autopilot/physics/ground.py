"""How high the ground is: flat, at z = 0 in W, and beside a road that leads down as low as the vehicle drives.

Such a road runs in a cutting of `CUTTING_M`: roughness and a ship's heave move no ground. Nor does the ground move on
which the drone starts, about W's origin, unless the road leads through there.
"""

import math

from link.compiled import kernel

CUTTING_M = 0.5
START_M = 10.0
"""From W's origin, as far as the ground of the start reaches."""
PASSES_M = 25.0
"""From there, within which the vehicle passes by the start: a drone over it is no farther behind than 15 m."""


@kernel
def ground_height(east_m: float, north_m: float, vehicle_east_m: float, vehicle_north_m: float, road_m: float) -> float:
    """Return the ground's height in W at a place, while the vehicle is on a road at the height `road_m`."""
    if road_m >= -CUTTING_M:
        return 0.0
    is_start = math.hypot(east_m, north_m) < START_M and math.hypot(vehicle_east_m, vehicle_north_m) > PASSES_M
    return 0.0 if is_start else road_m + CUTTING_M
