"""Judges what was received of a vehicle; makes the check's lines on it; pure."""

import math

from companion.check.findings import Finding, Level, make_finding, pass_line, pass_or
from companion.check.observation import VehicleFacts
from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig
from companion.integrity.vehicle_data import course_off_max_rad
from companion.vehicle.pad_reach import pad_width_min_m

_FIX_RATE_MIN_HZ = 4.0
_FIX_RATE_ALONE_MIN_HZ = 8.0  # without a velocity: a change of speed has to be seen in places alone
_FIX_AGE_SHARE = 0.5  # of what aborts a landing
_FIX_STD_GOOD_M = 0.3
# At 3 m/s an antenna farther behind leaves the pad unknown by 0.3 m, S2's limit: a heading by sqrt(2 L^3 q / v^5), with
# q = 0.1 m^2/s^5 for how unsteadily a car is steered (docs/notebook.md).
_BEHIND_MAX_M = 2.5


def assess_vehicle(seen: VehicleFacts, config: CompanionConfig, *, is_expected: bool = False) -> list[Finding]:
    """Return the lines on the vehicle.

    Args:
        seen: as received.
        config: the companion's, whose limits are to hold.
        is_expected: it was said where it is met, so that its silence fails.
    """
    if config.silent_vehicle is not None:
        return [pass_line("vehicle", "tells nothing, as the configuration says")]
    if seen.rate_hz <= 0.0 and seen.fix_refused_why is not None:
        advice = f"see what the vehicle publishes on {seen.key}, and whether its receiver has a fix"
        return [make_finding("vehicle", f"refused: {seen.fix_refused_why}", Level.FAIL, advice)]
    if seen.rate_hz <= 0.0:
        advice = "start the ground vehicle, or check --ns, --vehicle, -e and the names in the rules of vehicle.json5"
        level = Level.FAIL if is_expected else Level.WARN
        return [make_finding("vehicle", f"nothing on {seen.key}", level, advice)]
    least_hz = _FIX_RATE_MIN_HZ if seen.has_velocity else _FIX_RATE_ALONE_MIN_HZ
    is_rare = 1.0 / seen.rate_hz + max(seen.age_s or 0.0, 0.0) > config.abort.fix_age_max_s
    level = pass_or(seen.rate_hz >= least_hz, Level.FAIL if is_rare else Level.WARN)
    advice = "set its receiver to 5 Hz or more" + ("" if seen.has_velocity else "; to 10 Hz while it tells no velocity")
    rate = make_finding("vehicle fixes", f"{seen.rate_hz:.1f} Hz", level, advice)
    known = [_age(seen, config), _accuracy(seen, config.abort.position_std_max_m)]
    return [rate, *known, *_brakes(seen), *_heading(seen, config.integrity), _pad(seen, config)]


def _brakes(seen: VehicleFacts) -> list[Finding]:
    """Return the line on how soon a brake shows; none of a vessel, which has none."""
    if seen.is_afloat:
        return []
    if seen.acceleration_refused_why is not None:
        text, advice = (
            f"refused: {seen.acceleration_refused_why}",
            "tell m/s^2 along the vehicle's axes (docs/vehicle.md)",
        )
        return [make_finding("vehicle brakes", text, Level.WARN, advice, "flown as if the vehicle told none")]
    text = "tells its acceleration" if seen.tells_acceleration else "tells no acceleration"
    advice = "let an inertial unit tell it (docs/vehicle.md)"
    # docs/notebook.md, "A brake in the last half second"
    reason = "velocities show a brake late: of contacts as it began 21 % were unsafe, and 4 % with the acceleration"
    level = pass_or(seen.tells_acceleration, Level.WARN)
    return [make_finding("vehicle brakes", text, level, advice, reason)]


def _pad(seen: VehicleFacts, config: CompanionConfig) -> Finding:
    if not seen.describes_pad:
        refused = "not described" if seen.pad_refused_why is None else f"refused: {seen.pad_refused_why}"
        advice = (
            "let the vehicle answer for its pad"
            if seen.pad_refused_why is None
            else "let one program answer, with a description that fits"
        )
        return make_finding("vehicle pad", refused, Level.FAIL, advice)
    if seen.pad_width_m < pad_width_min_m(config):
        advice = f"use one of {pad_width_min_m(config):.2f} m and more"
        return make_finding("vehicle pad", f"{seen.pad_width_m:.2f} m wide", Level.FAIL, advice, "a start is refused")
    return pass_line("vehicle pad", "described")


def _heading(seen: VehicleFacts, config: IntegrityConfig) -> list[Finding]:
    """Return the line on a heading that was compared with the course, or that is missed."""
    if not seen.tells_heading and seen.antenna_behind_pad_m > _BEHIND_MAX_M:
        text = f"none, with the antenna {seen.antenna_behind_pad_m:.1f} m behind the pad"
        advice = "send a heading, or put the antenna ahead of the pad"
        return [make_finding("vehicle heading", text, Level.WARN, advice, "its own course hardly shows how it turns")]
    if seen.heading_off_rad is None:
        return []
    most_rad = course_off_max_rad(seen.compared_speed_m_s, config, is_afloat=seen.is_afloat)
    level = pass_or(most_rad is None or abs(seen.heading_off_rad) <= most_rad, Level.FAIL)
    text = f"{abs(math.degrees(seen.heading_off_rad)):.0f} degrees off its course"
    advice = "see its compass, the IMU's mounting and axes; reversing is 180 degrees, so drive forwards"
    return [make_finding("vehicle heading", text, level, advice, "the pad is not placed by it")]


def _age(seen: VehicleFacts, config: CompanionConfig) -> Finding:
    if seen.age_s is None:
        return make_finding("vehicle age", "unknown", Level.WARN, "needs the autopilot's time of day")
    is_fit = -config.integrity.fix_ahead_max_s <= seen.age_s <= _FIX_AGE_SHARE * config.abort.fix_age_max_s
    advice = "set its clock by GNSS or NTP, or use a faster link"
    return make_finding("vehicle age", f"{1e3 * seen.age_s:.0f} ms", pass_or(is_fit, Level.FAIL), advice)


def _accuracy(seen: VehicleFacts, std_max_m: float) -> Finding:
    if seen.std_m is None:
        return make_finding("vehicle accuracy", "not stated", Level.WARN, "let it publish a covariance")
    level = Level.FAIL if seen.std_m > std_max_m else pass_or(seen.std_m <= _FIX_STD_GOOD_M, Level.WARN)
    text = f"{seen.std_m:.2f} m" + ("" if seen.has_velocity else ", no velocity")
    return make_finding("vehicle accuracy", text, level, "use RTK, or a landing-pattern detector")
