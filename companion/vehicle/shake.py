"""How much of a pad's swing to the sides a drone that lands on it does not follow; compiled in part.

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
from companion.vehicle.compiled import compiled_kernel

_TILT_RAD, _SPEED_M_S = math.radians(10.0), 0.5  # S2's limits (docs/benchmark.md)
_EVEN_RAD_S = GRAVITY_M_S2 * _TILT_RAD / _SPEED_M_S


class PadSwing(Struct, frozen=True, kw_only=True, eq=False):
    """How a deck tilts and its pad shakes, over a forecast's n instants.

    Attributes:
        slope: (n, 2) of the deck by its swing, height per length in W.
        shake_enu: (3, n, 2) place, velocity and acceleration of the horizontal swing that is not followed.
        tilt_std_rad: (n, 4) standard deviations of roll, its rate, rad/s, pitch and its rate.
        above_m: height of the pad over the axis about which the deck tilts.
        heave_rad_s: angular frequency of the heave.
    """

    slope: Array
    shake_enu: Array
    tilt_std_rad: Array
    above_m: float
    heave_rad_s: float


def swing_of(forecast: Forecast, above_m: float) -> PadSwing | None:
    """Return the swing of a pad, None of a vehicle that does not tell its tilt or its heading.

    Args:
        forecast: of the vehicle.
        above_m: height of the pad over the axis about which the deck tilts.
    """
    if forecast.yaw_rad is None or forecast.tilt_rad is None or forecast.swing is None:
        return None
    heave, *tilts = forecast.swing.tolist()
    roll, pitch = ((w, damping, above_m * _left_out(w)) for w, damping in tilts)
    slope, shake_enu = tilted_deck(forecast.yaw_rad, forecast.tilt_rad, roll, pitch)
    return PadSwing(
        slope=slope,
        shake_enu=shake_enu,
        tilt_std_rad=np.zeros((len(slope), 4)) if forecast.tilt_std_rad is None else forecast.tilt_std_rad,
        above_m=above_m,
        heave_rad_s=heave[0],
    )


def _left_out(w: float) -> float:
    """Return the share of a swing of `w`, rad/s, that is not followed."""
    return 1.0 - 1.0 / (1.0 + (w / _EVEN_RAD_S) ** 2)


@compiled_kernel
def tilted_deck(
    yaw_rad: Array, tilt: Array, roll: tuple[float, float, float], pitch: tuple[float, float, float]
) -> tuple[Array, Array]:
    """Return the slope (n, 2) of a deck in W and the shake (3, n, 2) of its pad, as `PadSwing` has them.

    To the first order a roll of phi, port up, moves the pad by phi to starboard, a pitch, bow down, forward.

    Args:
        yaw_rad: (n,) of V.
        tilt: (n, 4) roll and its rate, pitch and its rate, rad and rad/s.
        roll: angular frequency, rad/s, damping, and the length by which a tilt shakes the pad, m.
        pitch: angular frequency, damping and length of the other axis.
    """
    n = len(yaw_rad)
    slope, shake = np.zeros((n, 2)), np.zeros((3, n, 2))
    for i in range(n):
        c, s = math.cos(yaw_rad[i]), math.sin(yaw_rad[i])
        for first, (w, damping, length_m), ahead in ((0, roll, (s, -c)), (2, pitch, (c, s))):
            angle, rate = tilt[i, first], tilt[i, first + 1]
            motion = (angle, rate, -(w**2) * angle - 2.0 * damping * w * rate)
            for axis in range(2):
                slope[i, axis] -= angle * ahead[axis]
                for order in range(3):
                    shake[order, i, axis] += length_m * motion[order] * ahead[axis]
    return slope, shake
