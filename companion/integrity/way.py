"""Where on the vehicle's way a fix puts it, against where it was expected then; pure.

A clock that was set puts it elsewhere on its way by as much as it drives in that time; a receiver that fixes its
phases wrongly puts it anywhere, and a link that has become slower nowhere else.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import Estimator, EstimatorMemory

_SPEED_MIN_M_S = 1.0  # below it the way of a tenth of a second is no longer than two fixed phases err
_NOW_S = np.zeros(1)


class WayError(Struct, frozen=True, kw_only=True):
    """How a fix differs from what was expected at its stamp.

    Attributes:
        ahead_s: by how much of its driving the vehicle is ahead of that, negative behind it.
        across_m: how far it is beside its way.
        speed_m_s: of the vehicle, horizontal.
    """

    ahead_s: float
    across_m: float
    speed_m_s: float


def way_error(
    estimator: Estimator, memory: EstimatorMemory | None, measurements: Sequence[Measurement]
) -> WayError | None:
    """Return it of the oldest new fix, None without one and of a vehicle that hardly drives.

    Args:
        estimator: of the vehicle.
        memory: before these measurements.
        measurements: that have come.
    """
    newest_ns = estimator.newest_fix_ns(memory)
    new = [one for one in measurements if one.quantity is Quantity.POSITION]
    if newest_ns is None or not any(one.t_ns > newest_ns for one in new):
        return None
    fix = min((one for one in new if one.t_ns > newest_ns), key=lambda one: one.t_ns)
    expected = estimator.forecast(memory, fix.t_ns, _NOW_S)
    if expected is None:
        return None
    vx_m_s, vy_m_s = expected.velocity_enu_m_s[0, :2].tolist()
    speed_m_s = math.hypot(vx_m_s, vy_m_s)
    if speed_m_s < _SPEED_MIN_M_S:
        return None
    place_enu_m = expected.position_enu_m[0, :2]
    if expected.frame_offset_enu_m is not None:
        place_enu_m = place_enu_m - expected.frame_offset_enu_m
    east_m, north_m = (fix.value[:2] - place_enu_m).tolist()
    return WayError(
        ahead_s=(east_m * vx_m_s + north_m * vy_m_s) / speed_m_s**2,
        across_m=abs(vx_m_s * north_m - vy_m_s * east_m) / speed_m_s,
        speed_m_s=speed_m_s,
    )
