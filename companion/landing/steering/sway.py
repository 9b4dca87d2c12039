"""How much the drone's lean has grown in the last moment, judged just above the pad; pure.

The horizontal part of the thrust, as an acceleration, is `g tan(tilt)`. Its mean over the last second is what steady
flight with the vehicle needs: its acceleration in a curve, and what holds against the air. What the drone leans beyond
that, a gust, a hurried correction or a noisy estimate asks for, and it passes; a drone that touched down so would do it
with one foot. Only more lean than the mean counts: a drone that comes upright, or stands on the pad, does not sway.
"""

import math

from msgspec import Struct

from companion.config.descent import SwayConfig
from companion.core.data import GRAVITY_M_S2, OwnState
from companion.landing.steering.virtual_model import UPRIGHT_MIN
from link.frames.rotations import rotate

_MEAN_S = 1.0  # longer than a gust's beginning, shorter than the turn of a curve


class Sway(Struct, frozen=True, kw_only=True):
    """What has been seen of it.

    Attributes:
        t_ns: of the newest report that was taken, monotonic; None before the first.
        mean_enu_m_s2: (2,) horizontal thrust over the last second.
        swayed_ns: when the drone last leaned too hard, monotonic; None when it never did.
    """

    t_ns: int | None = None
    mean_enu_m_s2: tuple[float, float] = (0.0, 0.0)
    swayed_ns: int | None = None


def update_sway(sway: Sway, own: OwnState, own_ns: int, config: SwayConfig) -> Sway:
    """Return the sway after the drone's newest report `own`, of `own_ns` (monotonic); an older one changes nothing."""
    if sway.t_ns is not None and own_ns <= sway.t_ns:
        return sway
    x, y, up = rotate(own.orientation_wxyz, (0.0, 0.0, 1.0))
    per_up = GRAVITY_M_S2 / max(up, UPRIGHT_MIN)
    share = 1.0 if sway.t_ns is None else -math.expm1(-(own_ns - sway.t_ns) * 1e-9 / _MEAN_S)
    mean_x, mean_y = sway.mean_enu_m_s2
    mean = (mean_x + share * (per_up * x - mean_x), mean_y + share * (per_up * y - mean_y))
    is_too_much = per_up * math.hypot(x, y) - math.hypot(*mean) > config.acceleration_max_m_s2
    return Sway(t_ns=own_ns, mean_enu_m_s2=mean, swayed_ns=own_ns if is_too_much else sway.swayed_ns)


def is_swaying(sway: Sway, monotonic_ns: int, config: SwayConfig) -> bool:
    """Return whether the drone leans too hard at `monotonic_ns`, or did a moment ago."""
    return sway.swayed_ns is not None and (monotonic_ns - sway.swayed_ns) * 1e-9 < config.calm_hold_s
