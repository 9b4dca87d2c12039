"""What ArduCopter is asked about itself: motors, outputs, a reset of parameters, its storage, version and banner.

Source: ArduCopter's motor test, and ArduPilot's handling of MAV_CMD_PREFLIGHT_STORAGE and MAV_CMD_STORAGE_FORMAT.
"""

from math import isfinite

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.addressees import is_ours
from sim_autopilot.commands.incoming_parameters import banner
from sim_autopilot.commands.requests import ACCEPTED, DENIED, UNSUPPORTED, Answer, Request
from sim_autopilot.core.links import Later
from sim_autopilot.core.status_texts import status_text
from sim_autopilot.interfaces import AutopilotConfig, Result
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.versions import autopilot_version

_FAILED = int(mavlink.MAV_RESULT_FAILED)
_LONGEST_TEST_S = 600.0
_STARTING, _FINISHED = "starting motor test", "finished motor test"
_RESET = 2
_YES = 1
_MOTORS, _OUTPUTS = range(1, 5), range(5, 17)


def spin_motor(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Test a motor on the ground: it is told when that begins and ends, and nothing turns; another one extends it."""
    if not memory.course.landing.landed:
        return Answer(memory=memory, result=_FAILED, text="Motor Test: vehicle not landed")
    asked_s = request.parameters[3]
    duration_s = min(asked_s, _LONGEST_TEST_S) if isfinite(asked_s) and asked_s > 0.0 else 0.0
    end = Later(
        boot_ns=memory.now.boot_ns + round(duration_s * 1e9),
        message=status_text(mavlink.MAV_SEVERITY_INFO, _FINISHED),
    )
    others = tuple(later for later in memory.outbox.later if not _ends_test(later))
    begins = len(others) == len(memory.outbox.later)
    told = (status_text(mavlink.MAV_SEVERITY_INFO, _STARTING),) if begins else ()
    return Answer(
        memory=replace(memory, outbox=replace(memory.outbox, later=(*others, end))), result=ACCEPTED, messages=told
    )


def set_servo(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Take an order for an output that no motor is at; nothing is moved by those here."""
    output = request.number(1)
    if output is not None and output in _MOTORS:
        refused = config.firmware.commands.results.mode_refused
        return Answer(memory=memory, result=refused, text=f"ServoRelayEvent: Channel {output} is already in use")
    free = output is not None and output in _OUTPUTS
    return Answer(memory=memory, result=ACCEPTED if free else config.firmware.commands.results.mode_refused)


def reset_parameters(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Forget all parameters with the next boot; to load or to save them is denied, they always are."""
    if request.number(1) != _RESET:
        return Answer(memory=memory, result=DENIED)
    boot = replace(memory.boot, forgets=True)
    text = "All parameters reset, reboot board"
    return Answer(memory=replace(memory, boot=boot), result=ACCEPTED, text=text)


def format_storage(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Fail to format the card, as its simulation does."""
    asked = (request.number(1), request.number(2)) == (_YES, _YES)
    return Answer(memory=memory, result=_FAILED if asked else UNSUPPORTED)


def send_banner(memory: AutopilotMemory, _request: Request, config: AutopilotConfig) -> Answer:
    """Tell the build, the board and the frame on the link at hand, as before a list of parameters."""
    return Answer(memory=memory, result=ACCEPTED, messages=banner(config))


def send_version(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Answer the older message that asks for AUTOPILOT_VERSION; PX4 does not know it."""
    return memory, (autopilot_version(memory, config),) if is_ours(message, config) else ()


def _ends_test(later: Later) -> bool:
    return later.message.get_type() == "STATUSTEXT" and bool(later.message.text == _FINISHED)
