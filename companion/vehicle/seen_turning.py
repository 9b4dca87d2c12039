"""How a vehicle turns, from two sightings of its pad: by how much the pad has turned in between; pure.

For a vehicle that tells nothing. However the board lies on it, it turns as the vehicle does; so the change of its
heading is taken, and not the heading. Each sighting is used once, or the rates would err alike.
"""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import Measurement, OwnState, Quantity
from link.frames.rotations import multiply, wrap_angle, yaw_of
from link.messages import PadSighting

_OVER_S = (0.4, 0.8)  # between the two: long for the noise, short for a road that bends
_YAW_STD_RAD = 0.03  # of a pad that is seen; benchmark: 0.02, and the drone's own attitude


class SeenYaw(Struct, frozen=True, kw_only=True):
    """The pad's yaw about W's z, rad, as it was seen at `t_ns`."""

    t_ns: int
    yaw_rad: float


def update_turning(
    before: SeenYaw | None, sighting: PadSighting, own_then: OwnState
) -> tuple[SeenYaw, Measurement | None]:
    """Return the sighting that the next one is compared with, and the yaw rate, once they are far enough apart.

    Args:
        before: the one to compare with, None before the first.
        sighting: of the pad.
        own_then: the drone at its stamp.
    """
    now = SeenYaw(t_ns=sighting.t_ns, yaw_rad=yaw_of(multiply(own_then.orientation_wxyz, sighting.orientation_wxyz)))
    if before is None:
        return now, None
    apart_s = (now.t_ns - before.t_ns) * 1e-9
    shortest_s, longest_s = _OVER_S
    if 0.0 <= apart_s < shortest_s:
        return before, None
    if not 0.0 <= apart_s <= longest_s:
        return now, None
    rate = Measurement(
        t_ns=(before.t_ns + now.t_ns) // 2,
        quantity=Quantity.YAW_RATE,
        value=np.array([wrap_angle(now.yaw_rad - before.yaw_rad) / apart_s]),
        covariance=np.array([[2.0 * (_YAW_STD_RAD / apart_s) ** 2]]),
    )
    return now, rate if math.isfinite(float(rate.value[0])) else None
