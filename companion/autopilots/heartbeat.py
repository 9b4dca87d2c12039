"""What the autopilot's heartbeat, mode and landed state tell: whether it is armed, in control, in a failsafe; pure.

One heartbeat that says "disarmed" may be anybody's, or a forger's: it counts once it is told again, or at once where a
disarm was asked for and accepted. Until then the motors may turn.

PX4 whose kill switch is on stays armed and in its mode, and tells FLIGHT_TERMINATION. Once the switch is released the
motors turn again, until `COM_KILL_DISARM` has disarmed it. ArduCopter tells of its emergency stop nowhere.
Source: PX4's streams/HEARTBEAT.hpp, actuator_armed; ArduCopter's GCS_MAVLINK_Copter::vehicle_system_status.
"""

from companion.autopilots.driver import AutopilotView, Driver
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import CommandAcknowledged
from link.records import replace

_FAILSAFE_STATES = (mavlink.MAV_STATE_CRITICAL, mavlink.MAV_STATE_EMERGENCY)


def with_heartbeat(view: AutopilotView, message: Message, driver: Driver) -> AutopilotView:
    """Return the view after a HEARTBEAT."""
    is_told_armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
    armed = is_told_armed or (view.armed and not view.disarm_told)
    in_control = driver.is_in_control(message.base_mode, message.custom_mode)
    reports = message.system_status in _FAILSAFE_STATES
    # Nothing follows setpoints in an emergency, whatever its mode.
    warns = reports and message.system_status != mavlink.MAV_STATE_EMERGENCY
    warns = warns and in_control and driver.follows_in_failsafe
    return replace(
        view,
        link_up=True,
        armed=armed,
        disarm_told=not is_told_armed,
        refusal=None if armed else view.refusal,
        in_control=in_control,
        mode=message.custom_mode,
        mode_told=True,
        failsafe=reports and not warns,
        killed=message.system_status == mavlink.MAV_STATE_FLIGHT_TERMINATION,
        warns=warns,
        restarted=view.restarted and not in_control,
    )


def with_acknowledgement(view: AutopilotView, answer: CommandAcknowledged) -> AutopilotView:
    """Return the view after an answer; while it is armed, only a disarm can have been asked for.

    While it is not, it is an arming, mostly: what heartbeats told before that counts no more. Nor does the mode that
    was told before another one was accepted.
    """
    if answer.result != mavlink.MAV_RESULT_ACCEPTED:
        return view
    if answer.command == mavlink.MAV_CMD_DO_SET_MODE:
        return replace(view, mode_told=False)
    switches = answer.command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM
    return replace(view, disarm_told=view.armed) if switches else view


def with_mode(view: AutopilotView, message: Message, driver: Driver) -> AutopilotView:
    """Return the view after a CURRENT_MODE.

    Another mode than was last asked for is a failsafe's, long before the heartbeat says so.
    """
    custom = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    in_control = driver.is_in_control(custom, message.custom_mode)
    overruled = not in_control and driver.is_in_control(custom, message.intended_custom_mode)
    return replace(view, in_control=in_control, mode=message.custom_mode, mode_told=True, overruled=overruled)


def with_landed_state(view: AutopilotView, message: Message) -> AutopilotView:
    """Return the view after an EXTENDED_SYS_STATE."""
    landed_state = message.landed_state
    is_unknown = landed_state == mavlink.MAV_LANDED_STATE_UNDEFINED
    landed = None if is_unknown else bool(landed_state == mavlink.MAV_LANDED_STATE_ON_GROUND)
    return replace(view, landed=landed, taking_off=landed_state == mavlink.MAV_LANDED_STATE_TAKEOFF)
