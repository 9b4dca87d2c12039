"""What every driver sends: a setpoint as SET_POSITION_TARGET_LOCAL_NED, and commands with their retries."""

from companion.autopilots.driver import AutopilotCommand, AutopilotView, Desire, DriverMemory
from companion.core.data import Setpoint
from link.frames.rotations import ned_from_enu, yaw_ned_from_enu
from link.mavlink.dialect import Message, mavlink
from link.mavlink.requests import ONCE, Retries
from link.records import replace

ASK_AGAIN_S = 1.0  # the heartbeat that confirms a mode may be a second late
TOLD_S = 2.0  # what came of an order, after it, at the latest: a heartbeat a second, and the link's way there and back
_DISARM_AGAIN_S = 0.2  # even without an answer: a lost command lets the drone slide for as long
_CUSTOM_MODE_FLAG = 1.0  # MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
_FORCE_DISARM = 21196.0  # MAVLink common, MAV_CMD_COMPONENT_ARM_DISARM, parameter 2
_IGNORE_VELOCITY = 0b0000_0000_0011_1000
_IGNORE_ACCELERATION = 0b0000_0001_1100_0000
_IGNORE_YAW_RATE = 0b0000_1000_0000_0000
_ZERO = (0.0, 0.0, 0.0)
_ALIKE = 1e-3  # 16 km from the origin single precision has millimetres
_VALUE_MAX = 1e7  # more than any place or motion; single precision holds it

Requested = tuple[DriverMemory, tuple[AutopilotCommand, ...]]


def local_ned_setpoint(setpoint: Setpoint, boot_ms: int, target_system: int) -> Message:
    """Return the message that asks for `setpoint` in the autopilot's local frame.

    Args:
        setpoint: position, velocity and acceleration in ENU; a None group is masked out.
        boot_ms: the autopilot's boot time at which it is sent; no autopilot goes by it.
        target_system: the autopilot's system id.

    Raises:
        ValueError: a value is not finite, or absurd.

    Source: MAVLink common, POSITION_TARGET_TYPEMASK.
    """
    mask = _IGNORE_YAW_RATE
    mask |= _IGNORE_VELOCITY if setpoint.velocity_enu_m_s is None else 0
    mask |= _IGNORE_ACCELERATION if setpoint.acceleration_enu_m_s2 is None else 0
    position = ned_from_enu(setpoint.position_enu_m)
    velocity = ned_from_enu(setpoint.velocity_enu_m_s or _ZERO)
    acceleration = ned_from_enu(setpoint.acceleration_enu_m_s2 or _ZERO)
    yaw_rad = yaw_ned_from_enu(setpoint.yaw_rad)
    values = (*position, *velocity, *acceleration, yaw_rad)
    if not all(abs(value) < _VALUE_MAX for value in values):
        raise ValueError(f"setpoint is not finite or absurd: {setpoint}")
    return mavlink.MAVLink_set_position_target_local_ned_message(
        boot_ms & 0xFFFFFFFF,
        target_system,
        mavlink.MAV_COMP_ID_AUTOPILOT1,
        mavlink.MAV_FRAME_LOCAL_NED,
        mask,
        *values,
        0.0,
    )


def have_same_place(sent: Message, told: Message) -> bool:
    """Return whether two setpoints name one place, but for what single precision makes of it."""
    return all(abs(getattr(told, name) - getattr(sent, name)) < _ALIKE for name in ("x", "y", "z"))


def is_carried_on(sent: Message, told: Message, carried_s: float) -> bool:
    """Return whether `told` is a setpoint that its own acceleration has carried on for at most `carried_s`."""
    for axis in "xyz":
        asked_m_s2, told_m_s2 = getattr(sent, f"af{axis}"), getattr(told, f"af{axis}")
        gained_m_s = getattr(told, f"v{axis}") - getattr(sent, f"v{axis}")
        if abs(told_m_s2 - asked_m_s2) > _ALIKE or abs(gained_m_s) > abs(asked_m_s2) * carried_s + _ALIKE:
            return False
    return True


def ask(memory: DriverMemory, command: AutopilotCommand, monotonic_ns: int, again_s: float = ASK_AGAIN_S) -> Requested:
    """Return `command`, unless the same one, parameters included, was sent less than `again_s` ago."""
    asked_ns = dict(memory.asked_ns or {})
    last_ns = asked_ns.get(command)
    if last_ns is not None and (monotonic_ns - last_ns) * 1e-9 < again_s:
        return memory, ()
    asked_ns[command] = monotonic_ns
    return replace(memory, asked_ns=asked_ns), (command,)


def was_asked_to_arm(memory: DriverMemory, since_ns: int) -> bool:
    """Return whether an order to arm was sent since then, monotonic."""
    last_ns = (memory.asked_ns or {}).get(arm(armed=True))
    return last_ns is not None and last_ns >= since_ns


def ask_to_disarm(memory: DriverMemory, desire: Desire, monotonic_ns: int) -> Requested:
    """Ask plainly; once that was refused, and only with the evidence complete, force it.

    Motors that are asked to stop were told to turn, so no order to arm is under way.
    """
    force = desire.force_disarm and memory.disarm_refusals > 0
    asked_ns = {order: at_ns for order, at_ns in (memory.asked_ns or {}).items() if order != arm(armed=True)}
    memory = replace(memory, disarm_asked=True, arm_asked=False, arm_accepted=False, asked_ns=asked_ns)
    return ask(memory, arm(armed=False, force=force), monotonic_ns, _DISARM_AGAIN_S)


def without_past_orders(memory: DriverMemory, desire: Desire) -> DriverMemory:
    """Return the memory of a step that wants no disarm, without that order, and without others no longer wanted."""
    if memory.control_asked_ns is not None and not desire.control:
        memory = replace(memory, control_asked_ns=None, control_accepted=False)
    if memory.arm_asked and not desire.armed:
        memory = replace(memory, arm_asked=False, arm_accepted=False)
    if not (memory.disarm_asked or memory.disarm_refusals):
        return memory
    return replace(memory, disarm_asked=False, disarm_refusals=0)


def with_answer(memory: DriverMemory, command: int, result: int) -> DriverMemory:
    """Count refused disarms, remember an accepted arming, an answer to one being none to the other, and a mode."""
    is_accepted = result == mavlink.MAV_RESULT_ACCEPTED
    if command == mavlink.MAV_CMD_DO_SET_MODE and memory.control_asked_ns is not None:
        return replace(memory, control_accepted=is_accepted)
    if command != mavlink.MAV_CMD_COMPONENT_ARM_DISARM or result == mavlink.MAV_RESULT_IN_PROGRESS:
        return memory
    if memory.arm_asked:
        return replace(memory, arm_accepted=is_accepted)
    is_refused = memory.disarm_asked and not is_accepted
    return replace(memory, disarm_refusals=memory.disarm_refusals + 1) if is_refused else memory


def ask_for_control(memory: DriverMemory, mode: AutopilotCommand, monotonic_ns: int) -> Requested:
    """Ask for a mode until that is accepted."""
    if memory.control_accepted:
        return memory, ()
    memory, commands = ask(memory, mode, monotonic_ns)
    return (replace(memory, control_asked_ns=monotonic_ns) if commands else memory), commands


def was_control_undone(memory: DriverMemory, view: AutopilotView, monotonic_ns: int) -> bool:
    """Return whether another mode is flown than the companion's, which was accepted: somebody has changed it since.

    It counts some time after the order, as with the motors.
    """
    if not memory.control_accepted or memory.control_asked_ns is None or view.in_control:
        return False
    return view.mode_told and (monotonic_ns - memory.control_asked_ns) * 1e-9 >= TOLD_S


def ask_to_arm(memory: DriverMemory, monotonic_ns: int) -> Requested:
    """Ask for motors until that is accepted."""
    if memory.arm_accepted:
        return memory, ()
    return ask(memory if memory.arm_asked else replace(memory, arm_asked=True), arm(armed=True), monotonic_ns)


def was_arming_undone(memory: DriverMemory, view: AutopilotView, monotonic_ns: int) -> bool:
    """Return whether motors that were accepted to be switched on are off, by the newest heartbeat.

    It counts some time after the order: one of right after the answer may have been made before the motors turned.
    """
    return memory.arm_accepted and view.disarm_told and not view.armed and not is_arming(memory, monotonic_ns)


def arm(*, armed: bool, force: bool = False) -> AutopilotCommand:
    """Return the command that switches the motors on or off."""
    parameters = (float(armed), _FORCE_DISARM if force else 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    retries = ONCE if armed else Retries(attempts=1, patience_ns=round(_DISARM_AGAIN_S * 1e9))
    return AutopilotCommand(command=mavlink.MAV_CMD_COMPONENT_ARM_DISARM, parameters=parameters, retries=retries)


def is_arming(memory: DriverMemory, monotonic_ns: int) -> bool:
    """Return whether motors were asked for so lately that they may turn before anything has told so."""
    asked_ns = (memory.asked_ns or {}).get(arm(armed=True))
    return asked_ns is not None and (monotonic_ns - asked_ns) * 1e-9 < TOLD_S


def may_turn(view: AutopilotView, memory: DriverMemory, monotonic_ns: int) -> bool:
    """Return whether motors turn, or may although nothing has told so yet."""
    return view.armed or is_arming(memory, monotonic_ns)


def set_mode(main: int, sub: int = 0) -> AutopilotCommand:
    """Return the command that enters a mode, by the autopilot's own numbers."""
    parameters = (_CUSTOM_MODE_FLAG, float(main), float(sub), 0.0, 0.0, 0.0, 0.0)
    return AutopilotCommand(command=mavlink.MAV_CMD_DO_SET_MODE, parameters=parameters)


def take_off(height_above_home_m: float) -> AutopilotCommand:
    """Return the command that climbs from the ground."""
    parameters = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height_above_home_m)
    return AutopilotCommand(command=mavlink.MAV_CMD_NAV_TAKEOFF, parameters=parameters)
