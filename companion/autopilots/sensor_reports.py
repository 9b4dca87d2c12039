"""What the autopilot's messages tell of its sensors: what is below it, its battery, and its receiver's frame; pure."""

from collections.abc import Callable
from math import radians

from companion.autopilots.driver import AutopilotView, Receiver
from companion.autopilots.own_reports import HISTORY_NS
from companion.core.data import OwnState, RangeReading
from link.frames.geodesy import Datum
from link.mavlink.clock_map import ClockMap
from link.mavlink.dialect import Message, mavlink
from link.records import replace

OwnAt = Callable[[int], OwnState | None]
"""The drone at a time in ns, None where its reports do not tell."""

_CM = 0.01
_INVALID = 1  # of a signal's quality in percent; 0 is unknown


def with_sensor(view: AutopilotView, message: Message, clock: ClockMap, own_at: OwnAt) -> AutopilotView:
    """Return the view after a DISTANCE_SENSOR, with the drone as `own_at` has it, or the first battery's status."""
    if message.get_type() == "DISTANCE_SENSOR":
        told = _range_reading(message, clock, own_at)
        return view if told is None or _is_late(told, view.range_down) else replace(view, range_down=told)
    return _with_battery(view, battery_share(message)) if is_of_first_battery(message) else view


def _is_late(told: RangeReading, known: RangeReading | None) -> bool:
    """Return whether a reading is older than the known one; much older ones say that the clock was set back."""
    return known is not None and 0 <= known.t_ns - told.t_ns <= HISTORY_NS


def _with_battery(view: AutopilotView, told: float | None) -> AutopilotView:
    """Return the view after what is told of the battery; a single report that has less may be anybody's."""
    share = told if told is None or view.battery_told is None else max(told, view.battery_told)
    return replace(view, battery_share=share, battery_told=told)


def is_of_first_battery(message: Message) -> bool:
    """Return whether a BATTERY_STATUS is of the battery that flies the drone; others feed a payload."""
    return bool(message.id == 0)


def battery_share(message: Message) -> float | None:
    """Return what a BATTERY_STATUS says is left, 0 to 1, None when it is not told or no share."""
    percent: int = message.battery_remaining
    return percent / 100.0 if 0 <= percent <= 100 else None


def looks_down(message: Message) -> bool:
    """Return whether a DISTANCE_SENSOR is of a range finder downwards; others are sectors around the drone."""
    return bool(message.orientation == mavlink.MAV_SENSOR_ROTATION_PITCH_270)


def distance_below_m(message: Message) -> float | None:
    """Return what a range finder that looks down sees, m; at or beyond its range's ends it sees nothing."""
    is_within = message.min_distance < message.current_distance < message.max_distance
    if not (is_within and looks_down(message)) or message.signal_quality == _INVALID:
        return None
    return float(message.current_distance) * _CM


def _range_reading(message: Message, clock: ClockMap, own_at: OwnAt) -> RangeReading | None:
    t_ns, distance_m = clock.boot_to_utc_ns(message.time_boot_ms * 1_000_000), distance_below_m(message)
    return (
        None if t_ns is None or distance_m is None else RangeReading(t_ns=t_ns, distance_m=distance_m, own=own_at(t_ns))
    )


def with_fix(receiver: Receiver, message: Message) -> Receiver:
    """Return what the receiver tells after a GPS_RAW_INT.

    "No GPS" before anything else is an autopilot's word for having no receiver: something else places that drone.
    Later it is a receiver that has fallen silent. A single report that says otherwise may be anybody's, or of one bad
    epoch, over which the autopilot's estimate goes on.
    """
    told: int = message.fix_type
    if receiver.has_fix is None and told == mavlink.GPS_FIX_TYPE_NO_GPS:
        return receiver
    has_fix, is_fixed = _kind_of_fix(told)
    had_fix, was_fixed = _kind_of_fix(told if receiver.fix_told is None else receiver.fix_told)
    return replace(
        receiver,
        has_fix=has_fix if has_fix is had_fix else receiver.has_fix,
        is_fixed=is_fixed if is_fixed is was_fixed else receiver.is_fixed,
        fix_told=told,
    )


def _kind_of_fix(told: int) -> tuple[bool, bool]:
    """Return whether a GPS_FIX_TYPE is a fix of three dimensions, and whether its carrier phases are fixed."""
    return told >= mavlink.GPS_FIX_TYPE_3D_FIX, told == mavlink.GPS_FIX_TYPE_RTK_FIXED


_MOVED_RAD = 1e-8  # 6 cm; the field's resolution is 1e-7 degrees, 1 cm
_MOVED_M = 0.05
_LATITUDE_MAX_1E7 = 90 * 10**7
_LONGITUDE_MAX_1E7 = 180 * 10**7


def origin_above_sea(message: Message) -> Datum | None:
    """Return the origin, its altitude above mean sea level, of a GPS_GLOBAL_ORIGIN; None of one off the earth."""
    if abs(message.latitude) > _LATITUDE_MAX_1E7 or abs(message.longitude) > _LONGITUDE_MAX_1E7:
        return None
    return Datum(
        latitude_rad=radians(message.latitude * 1e-7),
        longitude_rad=radians(message.longitude * 1e-7),
        altitude_m=message.altitude * 1e-3,
    )


def above_ellipsoid(above_sea: Datum, geoid_m: float | None) -> Datum:
    """Return the origin above the ellipsoid; where nobody knows the geoid, its place is right and its height is not."""
    return replace(above_sea, altitude_m=above_sea.altitude_m + (geoid_m or 0.0))


def is_same(origin: Datum, other: Datum) -> bool:
    """Return whether two origins are one, as exactly as they are sent."""
    return (
        abs(origin.latitude_rad - other.latitude_rad) < _MOVED_RAD
        and abs(origin.longitude_rad - other.longitude_rad) < _MOVED_RAD
        and abs(origin.altitude_m - other.altitude_m) < _MOVED_M
    )
