"""Judges what was observed of an autopilot, a vehicle and both links; makes the check's lines; pure."""

from collections.abc import Sequence

from companion.autopilots.choice import MULTIROTORS
from companion.check.findings import Finding, Level, make_finding, pass_line, pass_or
from companion.check.firmwares import FIRMWARES
from companion.check.observation import AutopilotFacts, VehicleFacts
from companion.check.rules import judge
from companion.check.vehicle_assessment import assess_vehicle
from companion.config.autopilot import AutopilotKind
from companion.config.companion import CompanionConfig
from companion.config.touchdown import RangeFinderConfig

MOTION = ("LOCAL_POSITION_NED", "ATTITUDE_QUATERNION")
_MOTION_RATE_MIN_HZ = 40.0
_LATENCY_MAX_S = 0.1
_CLOCK_STD_MAX_S = 0.02
_UTC_OFF_MAX_S = 0.02  # what NTP keeps a computer to on a network
_BATTERY_SPARE = 0.1  # beyond what no landing is begun below
_BATTERY_GOOD = 0.3  # beyond what no landing is begun below


def assess(
    autopilot: AutopilotFacts,
    vehicle: VehicleFacts | None,
    speed_m_s: float,
    config: CompanionConfig,
    *,
    launches: bool = False,
    expects_vehicle: bool = False,
) -> list[Finding]:
    """Return the lines of the check.

    Args:
        autopilot: as read.
        vehicle: as received, None when it was not to be looked at.
        speed_m_s: of the vehicle, for which the parameters are judged.
        config: the companion's, whose limits are to hold.
        launches: the drone is to leave a vehicle that drives, too.
        expects_vehicle: it was said where the vehicle is met, so that its silence fails.
    """
    found = [_firmware(autopilot, config.autopilot.kind), *_shared_id(autopilot)]
    found += [_readiness(autopilot), _origin(autopilot)]
    found += [_heights(autopilot, config.autopilot.geoid_height_m), _clock(autopilot), *_utc(autopilot, speed_m_s)]
    found += [_rate(autopilot, name) for name in MOTION]
    found += [_latency(autopilot), _battery(autopilot, config.limits.battery_min_share)]
    found += [_range_finder(autopilot), *_range_at_rest(autopilot, config.touchdown.range_finder)]
    if autopilot.autopilot_id in FIRMWARES:
        rules = FIRMWARES[autopilot.autopilot_id].rules_for(config.descent.sink.rate_max_m_s, launches=launches)
        found += judge(rules, autopilot.parameters, speed_m_s)
    return found if vehicle is None else [*found, *assess_vehicle(vehicle, config, is_expected=expects_vehicle)]


def _firmware(seen: AutopilotFacts, wanted: AutopilotKind) -> Finding:
    if seen.vehicle_type not in MULTIROTORS:
        text = f"MAV_TYPE {seen.vehicle_type}, which is no multirotor"
        return make_finding(
            "firmware", text, Level.FAIL, "connect to a multirotor, or set the autopilot's airframe to one"
        )
    if seen.autopilot_id not in FIRMWARES:
        return make_finding("firmware", f"MAV_AUTOPILOT {seen.autopilot_id}", Level.FAIL, "connect PX4 or ArduPilot")
    firmware = FIRMWARES[seen.autopilot_id]
    name, oldest = firmware.name, firmware.oldest
    if wanted not in {AutopilotKind.AUTO, firmware.kind}:
        text = f"{name}, and the configuration says {wanted.value}"
        return make_finding("firmware", text, Level.FAIL, 'connect the other, or set autopilot.kind = "auto"')
    if seen.version is None:
        return make_finding("firmware", f"{name}, version not told", Level.WARN, "check that it is a current release")
    text = f"{name} {'.'.join(map(str, seen.version))}"
    level = pass_or(seen.version[:2] >= oldest, Level.WARN)
    return make_finding("firmware", text, level, f"update it: {name} from {oldest[0]}.{oldest[1]} on is known to work")


def _shared_id(seen: AutopilotFacts) -> list[Finding]:
    """Return the line for a second autopilot under the same system id, none where there is no such one."""
    if not seen.is_id_shared:
        return []
    names = "MAV_SYS_ID (PX4), SYSID_THISMAV or MAV_SYSID (ArduPilot)"
    advice = f"give each drone its own {names}, and companion its --system-id"
    return [make_finding("system id", "two autopilots answer under it", Level.FAIL, advice, "both would arm")]


def _readiness(seen: AutopilotFacts) -> Finding:
    if seen.can_arm is None:
        return make_finding("arming checks", "not told", Level.WARN, "look at them in a ground station")
    text = "ready to arm" if seen.can_arm else "not ready to arm"
    return make_finding(
        "arming checks", text, pass_or(seen.can_arm, Level.WARN), "wait, or see a ground station for the cause"
    )


def _origin(seen: AutopilotFacts) -> Finding:
    missing = [
        text for text, there in (("origin", seen.has_origin), ("local position", seen.has_position)) if not there
    ]
    text = "origin and local position known" if not missing else f"no {' and no '.join(missing)}"
    return make_finding("estimator", text, pass_or(not missing, Level.FAIL), "wait for a GNSS fix under an open sky")


def _heights(seen: AutopilotFacts, configured_m: float | None) -> Finding:
    height_m = configured_m if seen.geoid_height_m is None else seen.geoid_height_m
    if height_m is None:
        advice = "let its receiver tell alt_ellipsoid, or set autopilot.geoid_height_m in the companion's configuration"
        reason = "the vehicle's heights are above the ellipsoid, the autopilot's above the sea; without it no start"
        return make_finding("heights", "geoid not told", Level.FAIL, advice, reason)
    source = "by the configuration" if seen.geoid_height_m is None else "by its receiver"
    return pass_line("heights", f"the sea is {height_m:.1f} m above the ellipsoid, {source}")


def _clock(seen: AutopilotFacts) -> Finding:
    if not seen.round_trips:
        return make_finding(
            "clock", "TIMESYNC not answered", Level.FAIL, "let the autopilot answer TIMESYNC on this link"
        )
    std_s = seen.clock_std_s
    text = f"{seen.round_trips} round trips" + ("" if std_s is None else f", offset known to {1e3 * std_s:.1f} ms")
    if not seen.utc_known:
        return make_finding("clock", f"{text}, no time of day", Level.FAIL, "wait for its GNSS to tell SYSTEM_TIME")
    level = pass_or(std_s is None or std_s <= _CLOCK_STD_MAX_S, Level.WARN)
    return make_finding(
        "clock", text, level, "use a faster link: the vehicle's place is off by speed times clock error"
    )


def _utc(seen: AutopilotFacts, speed_m_s: float) -> list[Finding]:
    """Return the line on the autopilot's time of day, none while that is unknown.

    Neither autopilot keeps its clock to GNSS. PX4 sets it only where it is 5 s off or more, late by as long as the fix
    was under way; ArduPilot leaves it to its quartz, before the arming but for steps forwards. What compares with it
    is the computer's date alone.
    Source: PX4's GPS::callback, GPSCallbackType::setClock; ArduPilot's AP_RTC::set_utc_usec.
    """
    if seen.utc_ahead_s is None:
        return []
    off_s = abs(seen.utc_ahead_s)
    text = f"{off_s:.3g} s {'ahead of' if seen.utc_ahead_s > 0.0 else 'behind'} this computer's"
    advice = (
        "set this computer's date by NTP or GNSS and check again; if it is the autopilot's that is off, set "
        'autopilot.utc = "computer", or power it up anew, PX4 after `system_time set 1` in its shell'
    )
    reason = f"at {speed_m_s:g} m/s the vehicle is placed {speed_m_s * off_s:.3g} m off where no detector shows it"
    return [make_finding("time of day", text, pass_or(off_s <= _UTC_OFF_MAX_S, Level.WARN), advice, reason)]


def _rate(seen: AutopilotFacts, name: str) -> Finding:
    rate_hz = seen.rates_hz.get(name, 0.0)
    level = Level.FAIL if rate_hz <= 0.0 else pass_or(rate_hz >= _MOTION_RATE_MIN_HZ, Level.WARN)
    advice = "raise the link's baud rate; 50 Hz are asked for"
    if rate_hz <= 0.0 and any(other_hz > 0.0 for other_hz in seen.rates_hz.values()):
        advice = "wait for a GNSS fix: it is not sent before the estimator has a position"
    return make_finding(name, f"{rate_hz:.0f} Hz", level, advice)


def _latency(seen: AutopilotFacts) -> Finding:
    if seen.latency_s is None:
        return make_finding("latency", "unknown", Level.WARN, "needs clock and position")
    unsure_s = _CLOCK_STD_MAX_S if seen.clock_std_s is None else 2.0 * seen.clock_std_s
    if seen.latency_s < -unsure_s:
        text = f"{1e3 * seen.latency_s:.0f} ms: positions come before they are taken"
        return make_finding("latency", text, Level.WARN, "let it settle and check again, or use a link without a queue")
    level = pass_or(seen.latency_s <= _LATENCY_MAX_S, Level.WARN)
    return make_finding("latency", f"{1e3 * max(seen.latency_s, 0.0):.0f} ms", level, "use a wire instead of a radio")


def _battery(seen: AutopilotFacts, share_min: float) -> Finding:
    share = seen.battery_share
    if share is None:
        return make_finding("battery", "not told", Level.WARN, "set up the autopilot's battery monitor")
    needed, good = round(share_min + _BATTERY_SPARE, 6), min(round(share_min + _BATTERY_GOOD, 6), 1.0)
    level = Level.FAIL if share < needed else pass_or(share >= good, Level.WARN)
    return make_finding("battery", f"{100.0 * share:.0f} %", level, "charge it: aborts and retries take minutes")


def _range_finder(seen: AutopilotFacts) -> Finding:
    text = "tells what is below" if seen.has_range_finder else "no DISTANCE_SENSOR that looks down"
    advice = "fit one, or compare drone and pad at rest before each day's first landing (docs/vehicle.md)"
    reason = "nothing else tells that own or vehicle's height is wrong by less than 2 m: PX4's moved by 0.5 m in 8 s"
    return make_finding("range finder", text, pass_or(seen.has_range_finder, Level.WARN), advice, reason)


def _range_at_rest(seen: AutopilotFacts, config: RangeFinderConfig) -> list[Finding]:
    """Return whether what is seen where the drone stands is as far away as the feet are."""
    if seen.range_at_rest_m is None:
        return []
    is_at_feet = abs(seen.range_at_rest_m - config.height_m) <= config.contact_height_max_m
    text = f"{seen.range_at_rest_m:.2f} m, {config.height_m:g} are set"
    advice = f"if it stands on level ground, set touchdown.range_finder.height_m to {seen.range_at_rest_m:.2f}"
    reason = "the feet's height above the pad is told by it less this: with 0.5 m too much no contact is believed"
    return [make_finding("range at rest", text, pass_or(is_at_feet, Level.WARN), advice, reason)]


def assess_links(open_to_strangers: Sequence[str]) -> list[Finding]:
    """Return a line for each link that is open to somebody without a key, or one that none is."""
    if not open_to_strangers:
        return [pass_line("links", "open to nobody without a key, or to this machine only")]
    advice = "use keys (companion keys, --zenoh-config, --signing-key), or a network on which nobody else is"
    reason = "whoever reaches it can end the landing, or fly the drone"
    return [
        Finding(name="links", level=Level.WARN, found=text, advice=advice, reason=reason) for text in open_to_strangers
    ]
