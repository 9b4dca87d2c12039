"""Mission items that belong to no mission: a place to fly to at once, as DroneKit's `simple_goto` asks.

An item with `current` 2 is flown to where setpoints are, and refused in any other mode. One with `current` 3 changes
the height of planes: ArduCopter accepts it and flies on. Source: ArduPilot's GCS_MAVLINK::handle_mission_item.
"""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.commands.addressees import is_ours
from sim_autopilot.commands.requests import ACCEPTED, Request
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.missions.items import item_from_message, result_of

GOES_THERE, _CHANGES_HEIGHT = 2, 3
"""Of `current`."""

_ITEMS = (mavlink.MAVLINK_MSG_ID_MISSION_ITEM, mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT)
_DEGREES = 1e-7
_GOOD, _ERROR = int(mavlink.MAV_MISSION_ACCEPTED), int(mavlink.MAV_MISSION_ERROR)
_NO_PARAMETERS = (-1.0, 0.0, 0.0, 0.0)  # of a DO_REPOSITION that does not change the mode


def is_single_item(message: Message, config: AutopilotConfig) -> bool:
    """Return whether a message is such an item, for a firmware that knows them."""
    if not config.firmware.missions.flies_single_items or message.get_msgId() not in _ITEMS:
        return False
    single = message.current in (GOES_THERE, _CHANGES_HEIGHT)
    return single and message.mission_type == mavlink.MAV_MISSION_TYPE_MISSION and is_ours(message, config)


def take_single_item(
    memory: AutopilotMemory, message: Message, config: AutopilotConfig
) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Return the memory after a single item, and its acknowledgement."""
    memory, result = _fly(memory, message, config)
    partner = (message.get_srcSystem(), message.get_srcComponent())
    return memory, (mavlink.MAVLink_mission_ack_message(*partner, result, mavlink.MAV_MISSION_TYPE_MISSION),)


def _fly(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> tuple[AutopilotMemory, int]:
    try:
        item = item_from_message(message)
    except ValueError:
        return memory, _ERROR
    result = result_of(item, mavlink.MAV_MISSION_TYPE_MISSION)
    if result != _GOOD or message.current == _CHANGES_HEIGHT:
        return memory, result
    handler = config.firmware.commands.handlers.get(mavlink.MAV_CMD_DO_REPOSITION)
    if handler is None or item.command != mavlink.MAV_CMD_NAV_WAYPOINT:
        return memory, _ERROR
    request = Request(
        command=mavlink.MAV_CMD_DO_REPOSITION,
        parameters=(*_NO_PARAMETERS, float(item.x), float(item.y), item.z),
        system=message.get_srcSystem(),
        component=message.get_srcComponent(),
        frame=item.frame,
        scale=_DEGREES,
    )
    answer = handler(memory, request, config)
    return answer.memory, _GOOD if answer.result == ACCEPTED else _ERROR
