"""PREFLIGHT_CALIBRATION: which calibrations there are, and what PX4 tells of them, as texts that ground stations read.

The simulated sensors have nothing to be calibrated, so no parameter changes. Gyros and level take PX4's time and
succeed; accelerometers and magnetometers wait for a drone that nobody turns, until they are cancelled or give up.

Source: PX4's calibration messages; ArduPilot's answers to the same command.
"""

from math import isfinite

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.requests import ACCEPTED, UNSUPPORTED, Answer, Request
from sim_autopilot.core.links import Later
from sim_autopilot.core.status_texts import status_text
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory, with_later

_REJECTED = int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
_FAILED = int(mavlink.MAV_RESULT_FAILED)
_STEP_NS = 300_000_000
"""Between two tenths: PX4 takes 750 samples at 250 Hz."""
_GIVES_UP_NS = 90_000_000_000
_MARK = "[cal]"
_TURNED = frozenset({"accel", "mag"})
_NAMES = ((1, 1, "gyro"), (2, 1, "mag"), (3, 1, "baro"), (5, 1, "accel"), (5, 2, "level"), (5, 4, "accel"))
"""Number and value of the parameter that asks for a calibration."""
_ARDUPILOTS = ((1, 1), (3, 1), (5, 1), (5, 2), (5, 4), (5, 76), (2, 76))


def accept_calibration(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Accept a calibration that ArduPilot has; nothing is told of it."""
    known = any(_whole(request, number) == value for number, value in _ARDUPILOTS)
    armed = memory.armed_ns is not None
    return Answer(memory=memory, result=_FAILED if armed else ACCEPTED if known else UNSUPPORTED)


def calibrate(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Begin one of PX4's calibrations, or cancel the one under way."""
    if memory.armed_ns is not None:
        return Answer(memory=memory, result=_REJECTED)
    name = next((name for number, value, name in _NAMES if _whole(request, number) == value), None)
    pending = tuple(later for later in memory.outbox.later if _is_about_calibration(later))
    if name is not None and pending:
        return Answer(memory=memory, result=_REJECTED)
    if name is not None:
        return Answer(memory=with_later(memory, *_course(name, memory.now.boot_ns)), result=ACCEPTED)
    if not pending:
        return Answer(memory=memory, result=ACCEPTED)
    others = tuple(later for later in memory.outbox.later if later not in pending)
    memory = replace(memory, outbox=replace(memory.outbox, later=others))
    return Answer(memory=memory, result=ACCEPTED, messages=(_said("calibration cancelled"),))


def _whole(request: Request, number: int) -> int | None:
    value = request.parameters[number - 1]
    return int(value) if isfinite(value) else None


def _course(name: str, now_ns: int) -> list[Later]:
    """What is told, and when, from now on."""
    told = [(0, f"calibration started: 2 {name}")]
    if name in _TURNED:
        told.append((1, "pending: back front left right up down"))
        told.append((1, "hold vehicle still on a pending side"))
        ends_ns, end = _GIVES_UP_NS, _said(f"calibration failed: {name}", mavlink.MAV_SEVERITY_CRITICAL)
    else:
        told += [(tenth, f"progress <{10 * tenth}>") for tenth in range(1, 11)]
        ends_ns, end = 11 * _STEP_NS, _said(f"calibration done: {name}")
    course = [Later(boot_ns=now_ns + step * _STEP_NS, message=_said(text)) for step, text in told]
    return [*course, Later(boot_ns=now_ns + ends_ns, message=end)]


def _said(text: str, severity: int = mavlink.MAV_SEVERITY_INFO) -> Message:
    return status_text(severity, f"{_MARK} {text}")


def _is_about_calibration(later: Later) -> bool:
    return later.message.get_type() == "STATUSTEXT" and str(later.message.text).startswith(_MARK)
