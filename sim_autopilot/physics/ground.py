"""How high the ground is: flat, at z = 0 in W, and about a vehicle whose road leads down as low as it drives.

Such a road runs in a cutting of `CUTTING_M`: roughness moves no ground. Nor does a ship that heaves: it is on no road.
Far from the vehicle the ground stays as low as its road has led, so that a valley does not fill up under a drone that
the vehicle has left there. Nor does the ground move on which the drone starts, about W's origin, unless the road leads
through there.
"""

import math

from link.compiled import kernel

CUTTING_M = 0.5
START_M = 10.0
"""From W's origin, as far as the ground of the start reaches."""
PASSES_M = 25.0
"""From the vehicle, within which the ground is as high as its road: a drone over the start is 15 m from it when it has
passed by, and one that it leaves behind is higher than the road rises over so short a way."""


def ground_height(
    east_m: float, north_m: float, vehicle_east_m: float, vehicle_north_m: float, road_m: float, lowest_m: float
) -> float:
    """Return the ground's height in W at a place.

    Args:
        east_m: of the place.
        north_m: of the place.
        vehicle_east_m: of the vehicle.
        vehicle_north_m: of the vehicle.
        road_m: height of the road that it is on.
        lowest_m: the least that this has been.
    """
    if min(road_m, lowest_m) >= -CUTTING_M:
        return 0.0
    if math.hypot(east_m, north_m) < START_M and math.hypot(vehicle_east_m, vehicle_north_m) > PASSES_M:
        return 0.0
    is_near = math.hypot(east_m - vehicle_east_m, north_m - vehicle_north_m) < PASSES_M
    return min((road_m if is_near else min(road_m, lowest_m)) + CUTTING_M, 0.0)


ground_height_kernel = kernel(ground_height)
"""The same for compiled functions; who calls it from Python, as the range finder does, waits for no compiler."""
