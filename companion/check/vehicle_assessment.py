"""From what was seen of a vehicle to the lines of the check; pure."""

import math

from companion.check.findings import Finding, Level, make_finding, pass_line, pass_or
from companion.check.observation import VehicleFacts
from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig

_FIX_RATE_MIN_HZ = 4.0
_FIX_AGE_SHARE = 0.5  # of what aborts a landing
_FIX_STD_GOOD_M = 0.3


def assess_vehicle(seen: VehicleFacts, config: CompanionConfig) -> list[Finding]:
    """Return the lines on the vehicle.

    Args:
        seen: as received.
        config: the companion's, whose limits are to hold.
    """
    if config.silent_vehicle is not None:
        return [pass_line("vehicle", "tells nothing, as the configuration says")]
    if seen.rate_hz <= 0.0 and seen.fix_refused_why is not None:
        advice = f"see what the vehicle publishes on {seen.key}, and whether its receiver has a fix"
        return [make_finding("vehicle", f"refused: {seen.fix_refused_why}", Level.FAIL, advice)]
    if seen.rate_hz <= 0.0:
        advice = "start the ground vehicle, or check --ns, --vehicle and -e"
        return [make_finding("vehicle", f"nothing on {seen.key}", Level.WARN, advice)]
    refused = "not described" if seen.pad_refused_why is None else f"refused: {seen.pad_refused_why}"
    pad = make_finding(
        "vehicle pad",
        "described" if seen.describes_pad else refused,
        pass_or(seen.describes_pad, Level.FAIL),
        "let the vehicle answer for its pad" if seen.pad_refused_why is None else "mend the vehicle's description",
    )
    level = pass_or(seen.rate_hz >= _FIX_RATE_MIN_HZ, Level.WARN)
    rate = make_finding("vehicle fixes", f"{seen.rate_hz:.1f} Hz", level, "set its receiver to 5 Hz or more")
    known = [_age(seen, config), _accuracy(seen, config.abort.position_std_max_m)]
    return [rate, *known, *_heading(seen, config.integrity), pad]


def _heading(seen: VehicleFacts, config: IntegrityConfig) -> list[Finding]:
    """Return the line on a heading that was compared with the course: of a vehicle that drove meanwhile."""
    if seen.heading_off_rad is None:
        return []
    level = pass_or(abs(seen.heading_off_rad) <= config.heading_off_max_rad, Level.FAIL)
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
