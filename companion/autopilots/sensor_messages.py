"""What the autopilot's sensors beside its estimator say: range finder and battery, from their messages."""

from companion.autopilots.driver import AutopilotView
from companion.core.data import RangeReading
from link.mavlink.clock_map import ClockMap
from link.mavlink.dialect import Message, mavlink
from link.records import replace

_CM = 0.01
_INVALID = 1  # of a signal's quality in percent; 0 is unknown


def with_sensor(view: AutopilotView, message: Message, clock: ClockMap, up_m: float | None) -> AutopilotView:
    """Return the view after a DISTANCE_SENSOR, with the drone at `up_m`, or a BATTERY_STATUS, only the first of all."""
    if message.get_type() == "DISTANCE_SENSOR":
        return replace(view, range_down=_range_reading(message, clock, up_m) or view.range_down)
    return replace(view, battery_share=battery_share(message)) if is_of_first_battery(message) else view


def is_of_first_battery(message: Message) -> bool:
    """Return whether a BATTERY_STATUS is of the battery that flies the drone; others feed a payload."""
    return bool(message.id == 0)


def battery_share(message: Message) -> float | None:
    """Return what a BATTERY_STATUS says is left, 0 to 1, None when it is not told."""
    percent: int = message.battery_remaining
    return percent / 100.0 if percent >= 0 else None


def looks_down(message: Message) -> bool:
    """Return whether a DISTANCE_SENSOR is of a range finder downwards; others are sectors around the drone."""
    return bool(message.orientation == mavlink.MAV_SENSOR_ROTATION_PITCH_270)


def _range_reading(message: Message, clock: ClockMap, up_m: float | None) -> RangeReading | None:
    """Return what a range finder that looks down sees; at or beyond its range's ends it sees nothing."""
    t_ns = clock.boot_to_utc_ns(message.time_boot_ms * 1_000_000)
    is_within = message.min_distance < message.current_distance < message.max_distance
    if t_ns is None or not (is_within and looks_down(message)) or message.signal_quality == _INVALID:
        return None
    return RangeReading(t_ns=t_ns, distance_m=message.current_distance * _CM, up_m=up_m)
