"""How much of a pad's swing to the sides a drone that lands on it does not follow; pure.

A pad h above the axis about which its deck rolls or pitches swings to the sides, x'' = -w^2 x. A drone that follows a
share s of a swing of amplitude A leans against the deck by s A w^2 / g; what it does not follow is (1 - s) A w of speed
against the pad. Both count as shares of what S2 allows at a contact, the tilt T and the speed V. The sum of their
squares is least at

    s = 1 / (1 + (w / w0)^2),    w0 = g T / V = 3.4 rad/s

A ship's pad is followed, a car's that shakes once a second is not: for 8 cm a drone would lean by 18 degrees.
"""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import GRAVITY_M_S2, Array, Forecast

_TILT_RAD, _SPEED_M_S = math.radians(10.0), 0.5  # S2's limits (docs/benchmark.md)
_EVEN_RAD_S = GRAVITY_M_S2 * _TILT_RAD / _SPEED_M_S


class PadSwing(Struct, frozen=True, kw_only=True, eq=False):
    """How a deck tilts and its pad shakes, over a forecast's n instants.

    Attributes:
        slope: (n, 2) of the deck by its swing, height per length in W.
        shake_enu: (3, n, 2) place, velocity and acceleration of the horizontal swing that is not followed.
        climb_std_m_s: (n,) standard deviation of the pad's velocity upwards.
        heave_rad_s: angular frequency of the heave.
    """

    slope: Array
    shake_enu: Array
    climb_std_m_s: Array
    heave_rad_s: float


def swing_of(forecast: Forecast, above_m: float) -> PadSwing | None:
    """Return the swing of a pad, None of a vehicle that does not tell its tilt or its heading.

    Args:
        forecast: of the vehicle.
        above_m: height of the pad over the axis about which the deck tilts.
    """
    shake, slope = np.zeros((3, len(forecast.offset_s), 2)), np.zeros((len(forecast.offset_s), 2))
    if forecast.yaw_rad is None or forecast.tilt_rad is None or forecast.swing is None:
        return None
    climb_std_m_s = np.zeros(len(slope)) if forecast.climb_std_m_s is None else forecast.climb_std_m_s
    cosine, sine = np.cos(forecast.yaw_rad), np.sin(forecast.yaw_rad)
    # To the first order a roll of phi, port up, moves the pad by phi to starboard, a pitch, bow down, forward.
    for first, (w, damping), ahead in zip(
        (0, 2), forecast.swing[1:].tolist(), ((sine, -cosine), (cosine, sine)), strict=True
    ):
        left_out = above_m * (1.0 - 1.0 / (1.0 + (w / _EVEN_RAD_S) ** 2))
        tilt_rad, rate_rad_s = forecast.tilt_rad[:, first], forecast.tilt_rad[:, first + 1]
        motion = (tilt_rad, rate_rad_s, -(w**2) * tilt_rad - 2.0 * damping * w * rate_rad_s)
        for order, value in enumerate(motion):
            shake[order] += left_out * value[:, None] * np.column_stack(ahead)
        slope -= tilt_rad[:, None] * np.column_stack(ahead)
    return PadSwing(slope=slope, shake_enu=shake, climb_std_m_s=climb_std_m_s, heave_rad_s=float(forecast.swing[0, 0]))
