"""Commands that more than one autopilot understands, and how often each is asked for; shared by the drivers."""

from companion.autopilots.driver import AutopilotCommand, Desire, DriverMemory
from link.mavlink.dialect import mavlink
from link.records import replace

ASK_AGAIN_S = 1.0  # the heartbeat that confirms a mode may be a second late
_DISARM_AGAIN_S = 0.2
_CUSTOM_MODE_FLAG = 1.0  # MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
_FORCE_DISARM = 21196.0  # MAVLink common, MAV_CMD_COMPONENT_ARM_DISARM, parameter 2

Asked = tuple[DriverMemory, tuple[AutopilotCommand, ...]]


def ask(memory: DriverMemory, command: AutopilotCommand, monotonic_ns: int, again_s: float = ASK_AGAIN_S) -> Asked:
    """Return `command`, unless the same one, parameters included, was sent less than `again_s` ago."""
    asked = dict(memory.asked_ns or {})
    last_ns = asked.get(command)
    if last_ns is not None and (monotonic_ns - last_ns) * 1e-9 < again_s:
        return memory, ()
    asked[command] = monotonic_ns
    return replace(memory, asked_ns=asked), (command,)


def ask_to_disarm(memory: DriverMemory, desire: Desire, monotonic_ns: int) -> Asked:
    """Ask plainly; once that was refused, and only with the evidence complete, force it."""
    force = desire.force_disarm and memory.disarm_refusals > 0
    return ask(replace(memory, disarm_asked=True), arm(armed=False, force=force), monotonic_ns, _DISARM_AGAIN_S)


def without_disarm(memory: DriverMemory) -> DriverMemory:
    """Return the memory once no disarm is wanted any more."""
    if not (memory.disarm_asked or memory.disarm_refusals):
        return memory
    return replace(memory, disarm_asked=False, disarm_refusals=0)


def with_disarm_answer(memory: DriverMemory, command: int, result: int) -> DriverMemory:
    """Count refused disarms; an answer to an earlier arming is none."""
    refused = result not in (mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_IN_PROGRESS)
    if command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM and refused and memory.disarm_asked:
        return replace(memory, disarm_refusals=memory.disarm_refusals + 1)
    return memory


def arm(*, armed: bool, force: bool = False) -> AutopilotCommand:
    """Return the command that switches the motors on or off."""
    parameters = (float(armed), _FORCE_DISARM if force else 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return AutopilotCommand(command=mavlink.MAV_CMD_COMPONENT_ARM_DISARM, parameters=parameters)


def set_mode(main: int, sub: int = 0) -> AutopilotCommand:
    """Return the command that enters a mode, by the autopilot's own numbers."""
    parameters = (_CUSTOM_MODE_FLAG, float(main), float(sub), 0.0, 0.0, 0.0, 0.0)
    return AutopilotCommand(command=mavlink.MAV_CMD_DO_SET_MODE, parameters=parameters)


def take_off(height_above_home_m: float) -> AutopilotCommand:
    """Return the command that climbs from the ground."""
    parameters = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height_above_home_m)
    return AutopilotCommand(command=mavlink.MAV_CMD_NAV_TAKEOFF, parameters=parameters)
