"""The drone's own reports: how they change over a second, how accurate they are, and what its sensors tell; pure.

An estimator's velocity can be wrong for seconds (PX4's, simulated, by 0.3 m/s on average and 0.9 at worst) while its
receiver keeps the position right. The autopilot flies so that *its* velocity is the one asked for: the drone leaves
its place until the position loop makes up for it, 0.3 m for 0.3 m/s at 1 rad/s. So the bias is added to what is asked.

Model: the bias is v - dp/dt through a low-pass of first order, in W, horizontally. Summed over the reports, so that the
rounding of their stamps cancels.
"""

from collections.abc import Callable, Sequence
from math import hypot, radians

from companion.autopilots.driver import AutopilotView
from companion.core.data import OwnState, RangeReading, Setpoint
from link.frames.geodesy import Datum
from link.frames.rotations import multiply, normalized
from link.mavlink.clock_map import ClockMap
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from link.records import replace

HISTORY_NS = 1_000_000_000  # sightings of the pad arrive less late than this
_POSITION_MAX_M = 1e6  # farther from the origin no local frame is meant
_SPEED_MAX_M_S = 1e3
_JUMP_MIN_M = 1.5  # of the drone's own position between two reports: its local frame has moved
_MANOEUVRE_M_S2 = 10.0  # what flying can add to it
_JUMP_GAP_MAX_S = 0.5  # a drone that was silent for longer may have braked or turned meanwhile
_ACCELERATION_OVER_NS = (40_000_000, 120_000_000)  # between two reports that an acceleration is taken from
_JOLT_OVER_NS = 45_000_000  # a stop within one report is seen in two more at 50 Hz
# With 0.5 to 1 s about half of PX4's error is left (0.15 of 0.33 m/s); shorter, the steps of its fixes come through.
_BIAS_TIME_CONSTANT_S = 0.7
_BIAS_GAP_MAX_S = 0.2  # over a longer one nothing is learnt
_BIAS_STEP_MAX_M = 0.1  # a larger one between two reports is a correction of the place, not a motion
_BIAS_MAX_M_S = 1.0
_NO_BIAS: Vector3 = (0.0, 0.0, 0.0)


def carry(own: OwnState, t_ns: int) -> OwnState:
    """Return the drone at `t_ns`, carried from a report at its velocity and angular velocity.

    The orientation is carried from when it was so, which is before the report: at 2 rad/s half a period of 50 Hz turns
    by 0.02 rad, and what is seen 8 m away is 0.16 m off.
    """
    dt_s = (t_ns - own.t_ns) * 1e-9
    turned_s = dt_s + own.attitude_age_s
    p, q, r = own.angular_velocity_flu_rad_s
    turn = normalized((1.0, 0.5 * p * turned_s, 0.5 * q * turned_s, 0.5 * r * turned_s))
    return replace(
        own,
        t_ns=t_ns,
        position_enu_m=_move(own, dt_s),
        orientation_wxyz=multiply(own.orientation_wxyz, turn),
    )


def _move(own: OwnState, dt_s: float) -> Vector3:
    """Where the drone is `dt_s` after a report at its velocity."""
    (x, y, z), (vx, vy, vz) = own.position_enu_m, own.velocity_enu_m_s
    return (x + vx * dt_s, y + vy * dt_s, z + vz * dt_s)


def with_report(history: tuple[OwnState, ...], own: OwnState) -> tuple[tuple[OwnState, ...], Vector3 | None]:
    """Add the newest report to the last second's, oldest first.

    Returns:
        them, and by how much the local frame has moved under the drone, where flying cannot explain the report: then it
        begins a new history.
    """
    kept = history
    while kept and own.t_ns - kept[0].t_ns > HISTORY_NS:
        kept = kept[1:]
    jump = _jump(kept[-1], own) if kept else None
    if jump is not None:
        return (own,), jump
    up_m_s2, jolt_m_s2 = _acceleration_up_m_s2(kept, own), _jolt_m_s2(kept, own)
    return (*kept, replace(own, acceleration_up_m_s2=up_m_s2, jolt_m_s2=jolt_m_s2)), None


def is_plausible(position_m: Sequence[float], velocity_m_s: Sequence[float]) -> bool:
    """Whether all are numbers that a flight can have; NaN is none."""
    return all(abs(p) < _POSITION_MAX_M for p in position_m) and all(abs(v) < _SPEED_MAX_M_S for v in velocity_m_s)


def _acceleration_up_m_s2(earlier: Sequence[OwnState], own: OwnState) -> float | None:
    """Return the vertical acceleration between the newest report and one shortly before it."""
    shortest_ns, longest_ns = _ACCELERATION_OVER_NS
    before = None
    for old in reversed(earlier):
        if own.t_ns - old.t_ns > longest_ns:
            break
        before = old
    if before is None or own.t_ns - before.t_ns < shortest_ns:
        return None
    return (own.velocity_enu_m_s[2] - before.velocity_enu_m_s[2]) / ((own.t_ns - before.t_ns) * 1e-9)


def _jolt_m_s2(earlier: Sequence[OwnState], own: OwnState) -> float | None:
    """Return the horizontal acceleration between the newest report and the last one clearly before it."""
    for old in reversed(earlier):
        if own.t_ns - old.t_ns >= _JOLT_OVER_NS:
            (vx, vy, _), (before_x, before_y, _) = own.velocity_enu_m_s, old.velocity_enu_m_s
            return hypot(vx - before_x, vy - before_y) / ((own.t_ns - old.t_ns) * 1e-9)
    return None


def _jump(before: OwnState, own: OwnState) -> Vector3 | None:
    """Return by how much the local frame moved under the drone, None when flying explains the difference."""
    duration_s = (own.t_ns - before.t_ns) * 1e-9
    if duration_s > _JUMP_GAP_MAX_S:
        return None
    expected = _move(before, duration_s)
    dx, dy, dz = (now - then for now, then in zip(own.position_enu_m, expected, strict=True))
    return (dx, dy, dz) if hypot(dx, dy, dz) > _JUMP_MIN_M + 0.5 * _MANOEUVRE_M_S2 * duration_s**2 else None


def velocity_bias(before: OwnState | None, t_ns: int, position_enu_m: Vector3, reported_enu_m_s: Vector3) -> Vector3:
    """Return the bias at a report in W, m/s.

    Args:
        before: the report before, its velocity without its bias; None when there is none to compare with.
        t_ns: of the report.
        position_enu_m: in W.
        reported_enu_m_s: the velocity as it was reported, in W.
    """
    if before is None:
        return _NO_BIAS
    dt_s = (t_ns - before.t_ns) * 1e-9
    if not 0.0 < dt_s <= _BIAS_GAP_MAX_S:
        return before.velocity_bias_enu_m_s
    x_m, y_m = (
        0.5 * (reported + corrected + bias) * dt_s - (now - then)
        for reported, corrected, bias, now, then in zip(
            reported_enu_m_s[:2],
            before.velocity_enu_m_s,
            before.velocity_bias_enu_m_s,
            position_enu_m,
            before.position_enu_m,
            strict=False,
        )
    )
    bias_x, bias_y, _ = before.velocity_bias_enu_m_s
    if hypot(x_m, y_m) > _BIAS_STEP_MAX_M:
        return before.velocity_bias_enu_m_s
    bias_x += (x_m - bias_x * dt_s) / _BIAS_TIME_CONSTANT_S
    bias_y += (y_m - bias_y * dt_s) / _BIAS_TIME_CONSTANT_S
    share = min(1.0, _BIAS_MAX_M_S / max(hypot(bias_x, bias_y), _BIAS_MAX_M_S))
    return (bias_x * share, bias_y * share, 0.0)


def as_seen_with(setpoint: Setpoint, bias_enu_m_s: Vector3) -> Setpoint:
    """Return the setpoint with the velocity that the autopilot will report when it flies as asked."""
    if setpoint.velocity_enu_m_s is None:
        return setpoint
    (vx, vy, vz), (bias_x, bias_y, bias_z) = setpoint.velocity_enu_m_s, bias_enu_m_s
    return replace(setpoint, velocity_enu_m_s=(vx + bias_x, vy + bias_y, vz + bias_z))


def without_bias(velocity_enu_m_s: Vector3, bias_enu_m_s: Vector3) -> Vector3:
    """Return a reported velocity without its bias."""
    (vx, vy, vz), (bias_x, bias_y, bias_z) = velocity_enu_m_s, bias_enu_m_s
    return (vx - bias_x, vy - bias_y, vz - bias_z)


OwnAt = Callable[[int], OwnState | None]
"""The drone at a time in ns, None where its reports do not tell."""

_CM = 0.01
_INVALID = 1  # of a signal's quality in percent; 0 is unknown


def with_sensor(view: AutopilotView, message: Message, clock: ClockMap, own_at: OwnAt) -> AutopilotView:
    """Return the view after a DISTANCE_SENSOR, with the drone as `own_at` has it, or the first battery's status."""
    if message.get_type() == "DISTANCE_SENSOR":
        return replace(view, range_down=_range_reading(message, clock, own_at) or view.range_down)
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


def _range_reading(message: Message, clock: ClockMap, own_at: OwnAt) -> RangeReading | None:
    """Return what a range finder that looks down sees; at or beyond its range's ends it sees nothing."""
    t_ns = clock.boot_to_utc_ns(message.time_boot_ms * 1_000_000)
    is_within = message.min_distance < message.current_distance < message.max_distance
    if t_ns is None or not (is_within and looks_down(message)) or message.signal_quality == _INVALID:
        return None
    return RangeReading(t_ns=t_ns, distance_m=message.current_distance * _CM, own=own_at(t_ns))


_MOVED_RAD = 1e-8  # 6 cm; the field's resolution is 1e-7 degrees, 1 cm
_MOVED_M = 0.05
_GEOID_MAX_M = 120.0  # it lies between -107 and 86 m (EGM96)
_GEOID_STEP_M = 1.0  # a smaller change of the geoid's height along a flight is left alone
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


def geoid_height_m(known_m: float | None, message: Message) -> float | None:
    """Return the height of mean sea level above the ellipsoid, which the vehicle's fixes refer to.

    Args:
        known_m: so far; None before the first that was told, which is taken whatever it is.
        message: GPS_RAW_INT, which says 0 where the receiver does not know its height above the ellipsoid.
    """
    if message.fix_type < mavlink.GPS_FIX_TYPE_3D_FIX or message.alt_ellipsoid == 0:
        return known_m
    told_m: float = (message.alt_ellipsoid - message.alt) * 1e-3
    if abs(told_m) > _GEOID_MAX_M or (known_m is not None and abs(told_m - known_m) < _GEOID_STEP_M):
        return known_m
    return told_m


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
