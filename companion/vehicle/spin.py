"""A turn on the spot, as yaw rates tell it; pure. One reading may be an outlier: a second one makes it believed."""

from msgspec import Struct

from link.records import replace

_SURE_S = 0.09  # from the first reading to one that confirms it: a knock is over, and a gyro of 10 Hz has told it twice
_HOLDS_S = 0.5  # without another reading: several periods of the slowest gyro


class Spin(Struct, frozen=True, kw_only=True):
    """A turn on the spot.

    Attributes:
        told_rad_s: how fast, by the newest yaw rate beyond the curve; 0 of a vehicle that does not turn so.
        told_s: for how long that has been told.
        left_s: for how long it goes on without another yaw rate.
        is_believed: whether a second one has told it.
    """

    told_rad_s: float = 0.0
    told_s: float = 0.0
    left_s: float = 0.0
    is_believed: bool = False

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
    is_believed = spin.is_believed or spin.told_s >= _SURE_S
    return replace(spin, told_rad_s=rate_rad_s, left_s=_HOLDS_S, is_believed=is_believed)


def passed(spin: Spin, dt_s: float) -> Spin:
    """Return the turn `dt_s` later."""
    left_s = spin.left_s - dt_s
    return replace(spin, told_s=spin.told_s + dt_s, left_s=left_s) if left_s > 0.0 else NO_SPIN
