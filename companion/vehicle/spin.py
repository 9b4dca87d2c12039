"""A turn on the spot, as yaw rates tell it; pure. One reading may be an outlier: a second one makes it believed.

Where a unit tells the heading as well, that must turn along: a gyro that has run away turns nothing.
"""

import math

from msgspec import Struct

from link.frames.rotations import wrap_angle
from link.records import replace

_SURE_S = 0.09  # from the first reading to one that confirms it: a knock is over, and a gyro of 10 Hz has told it twice
_COMPARED_S = 0.2  # where a heading is told, too: a unit's may lag behind its gyro by up to half of that
_HOLDS_S = 0.5  # without another reading: several periods of the slowest gyro
_STDS = 5.0  # of the difference of two headings, by which they have turned: noise alone does it once in a million


class Spin(Struct, frozen=True, kw_only=True):
    """A turn on the spot.

    Attributes:
        told_rad_s: how fast, by the newest yaw rate beyond the curve; 0 of a vehicle that does not turn so.
        told_s: for how long that has been told.
        left_s: for how long it goes on without another yaw rate.
        is_believed: whether a second one has told it.
        is_denied: whether the heading has not turned along.
        heading_rad: that was told since it began, or since it was last found to turn along; None before.
        turned_rad: by how much the yaw rates say that it has turned since then.
        sure_s: after which it is believed: later where a heading is going to show by then whether it turns along.
    """

    told_rad_s: float = 0.0
    told_s: float = 0.0
    left_s: float = 0.0
    is_believed: bool = False
    is_denied: bool = False
    heading_rad: float | None = None
    turned_rad: float = 0.0
    sure_s: float = _SURE_S

    @property
    def is_open(self) -> bool:
        """Whether a heading is to show whether the vehicle turns."""
        return self.sure_s > _SURE_S and not (self.is_believed or self.is_denied)

    @property
    def rad_s(self) -> float:
        """How fast the vehicle turns, 0 until that is believed."""
        return self.told_rad_s if self.is_believed else 0.0


NO_SPIN = Spin()


def told(spin: Spin, rate_rad_s: float) -> Spin:
    """Return the turn after a yaw rate beyond the curve, 0 where there is none."""
    if rate_rad_s == 0.0:
        return NO_SPIN
    if spin.told_rad_s * rate_rad_s <= 0.0:
        return Spin(told_rad_s=rate_rad_s, left_s=_HOLDS_S)
    is_believed = (spin.is_believed or spin.told_s >= spin.sure_s) and not spin.is_denied
    return replace(spin, told_rad_s=rate_rad_s, left_s=_HOLDS_S, is_believed=is_believed)


def compared(spin: Spin, heading_rad: float, variance_rad2: float) -> Spin:
    """Return the turn after a heading that a unit tells while yaw rates tell it.

    Args:
        spin: so far.
        heading_rad: as told.
        variance_rad2: of the heading.
    """
    shows_rad = _STDS * math.sqrt(2.0 * variance_rad2)
    if spin.heading_rad is None:
        sure_s = _COMPARED_S if abs(spin.told_rad_s) * _COMPARED_S > shows_rad else _SURE_S
        return replace(spin, heading_rad=heading_rad, turned_rad=0.0, sure_s=sure_s)
    if spin.told_s < _COMPARED_S or abs(spin.turned_rad) <= shows_rad:
        return spin
    change_rad = heading_rad - spin.heading_rad
    if abs(wrap_angle(change_rad)) < abs(wrap_angle(change_rad - spin.turned_rad)):
        return replace(spin, is_believed=False, is_denied=True)
    return replace(spin, heading_rad=heading_rad, turned_rad=0.0)


def passed(spin: Spin, dt_s: float) -> Spin:
    """Return the turn `dt_s` later."""
    left_s = spin.left_s - dt_s
    if left_s <= 0.0:
        return NO_SPIN
    turned_rad = spin.turned_rad + spin.told_rad_s * dt_s
    return replace(spin, told_s=spin.told_s + dt_s, left_s=left_s, turned_rad=turned_rad)
