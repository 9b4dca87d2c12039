"""Heartbeats: ours as a companion, and how to know an autopilot's."""

from link.mavlink.dialect import Message, mavlink

AUTOPILOT_COMPONENT_ID: int = mavlink.MAV_COMP_ID_AUTOPILOT1
_MAVLINK_VERSION = 3  # of the messages' definitions, the same for all of MAVLink 1 and 2


def companion_heartbeat() -> Message:
    """The heartbeat of an onboard computer, which flies nothing itself."""
    return mavlink.MAVLink_heartbeat_message(
        type=mavlink.MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot=mavlink.MAV_AUTOPILOT_INVALID,
        base_mode=0,
        custom_mode=0,
        system_status=mavlink.MAV_STATE_ACTIVE,
        mavlink_version=_MAVLINK_VERSION,
    )


def is_autopilot_heartbeat(message: Message) -> bool:
    """Whether a message is the heartbeat of an autopilot, not of a ground station, gimbal or companion."""
    return bool(
        message.get_msgId() == mavlink.MAVLINK_MSG_ID_HEARTBEAT
        and message.get_srcComponent() == AUTOPILOT_COMPONENT_ID
        and message.autopilot != mavlink.MAV_AUTOPILOT_INVALID
    )
