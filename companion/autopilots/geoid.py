"""The geoid's height, by which the autopilot's heights above the sea become those above the ellipsoid; pure.

The vehicle's fixes are above the ellipsoid. A geoid's height that is wrong puts the pad as much too high or too low.
"""

from msgspec import Struct

from link.mavlink.dialect import Message, mavlink
from link.records import replace

_MAX_M = 120.0  # it lies between -107 and 86 m (EGM96)
_STEP_M = 1.0  # a smaller change along a flight is left alone


class Geoid(Struct, frozen=True, kw_only=True):
    """What the autopilot's receiver has told of the geoid.

    Attributes:
        height_m: of mean sea level above the ellipsoid, None until the receiver tells it.
        is_sure: it was told again.
        doubted_m: another one, told once; a single message may be anybody's.
    """

    height_m: float | None = None
    is_sure: bool = False
    doubted_m: float | None = None

    def above(self, other: "Geoid") -> float:
        """Return by how much it is above another one, m; 0 where one of them is not known."""
        return 0.0 if self.height_m is None or other.height_m is None else self.height_m - other.height_m


def geoid_height_m(known_m: float | None, message: Message) -> float | None:
    """Return the height of mean sea level above the ellipsoid, which the vehicle's fixes refer to.

    Args:
        known_m: so far; None before the first that was told, which is taken whatever it is.
        message: GPS_RAW_INT, which says 0 where the receiver does not know its height above the ellipsoid.
    """
    if message.fix_type < mavlink.GPS_FIX_TYPE_3D_FIX or message.alt_ellipsoid == 0:
        return known_m
    told_m: float = (message.alt_ellipsoid - message.alt) * 1e-3
    if abs(told_m) > _MAX_M or (known_m is not None and abs(told_m - known_m) < _STEP_M):
        return known_m
    return told_m


def hear_geoid(known: Geoid, message: Message) -> tuple[Geoid, Geoid | None]:
    """Take the first height, and doubt another one.

    Args:
        known: so far.
        message: GPS_RAW_INT.

    Returns:
        what is known now, and another one that has been told twice in a row; None without one.
    """
    told_m = geoid_height_m(known.height_m, message)
    if told_m is None or known.height_m is None:
        return replace(known, height_m=told_m, doubted_m=None), None
    if told_m == known.height_m:
        is_sure = known.is_sure or geoid_height_m(None, message) is not None
        return replace(known, is_sure=is_sure, doubted_m=None), None
    if known.doubted_m is None or geoid_height_m(known.doubted_m, message) != known.doubted_m:
        return replace(known, doubted_m=told_m), None
    return known, Geoid(height_m=told_m)
