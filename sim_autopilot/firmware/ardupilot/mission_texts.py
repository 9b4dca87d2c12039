"""What ArduCopter says about missions: which item begins, and which place is reached.

Names of items: ArduPilot's source (AP_Mission).
"""

from collections.abc import Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.status_texts import status_text
from sim_autopilot.missions.flight import MissionStep, Progress, Stage
from sim_autopilot.missions.items import Item

_NAMES: Mapping[int, str] = MappingProxyType(
    {
        mavlink.MAV_CMD_NAV_WAYPOINT: "WP",
        mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT: "SplineWP",
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: "RTL",
        mavlink.MAV_CMD_NAV_LOITER_UNLIM: "LoitUnlim",
        mavlink.MAV_CMD_NAV_LOITER_TIME: "LoitTime",
        mavlink.MAV_CMD_NAV_LOITER_TURNS: "LoitTurns",
        mavlink.MAV_CMD_NAV_LOITER_TO_ALT: "LoitAltitude",
        mavlink.MAV_CMD_NAV_LAND: "Land",
        mavlink.MAV_CMD_NAV_TAKEOFF: "Takeoff",
        mavlink.MAV_CMD_NAV_VTOL_TAKEOFF: "VTOLTakeoff",
        mavlink.MAV_CMD_NAV_VTOL_LAND: "VTOLLand",
        mavlink.MAV_CMD_NAV_DELAY: "Delay",
        mavlink.MAV_CMD_CONDITION_DELAY: "CondDelay",
        mavlink.MAV_CMD_CONDITION_DISTANCE: "CondDist",
        mavlink.MAV_CMD_CONDITION_YAW: "CondYaw",
        mavlink.MAV_CMD_DO_CHANGE_SPEED: "ChangeSpeed",
        mavlink.MAV_CMD_DO_SET_HOME: "SetHome",
        mavlink.MAV_CMD_DO_SET_SERVO: "SetServo",
        mavlink.MAV_CMD_DO_SET_RELAY: "SetRelay",
        mavlink.MAV_CMD_DO_SET_ROI: "SetROI",
        mavlink.MAV_CMD_DO_JUMP: "Jump",
    }
)
_NONE = -1
_REACHED_TOLD = frozenset({mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT})


def mission_texts(before: Progress, step: MissionStep, items: tuple[Item, ...]) -> tuple[Message, ...]:
    """Return what is said of the items that a step of the flight finished or began."""
    said: list[Message] = []
    goes_on = step.progress.stage is not Stage.FINISHED
    for index in (*step.reached, *([step.progress.index] if goes_on else [])):
        command = items[index].command if index < len(items) else _NONE
        begins = index != before.index or (before.stage is Stage.NEW and step.progress.stage is not Stage.NEW)
        if begins and command in _NAMES:
            said.append(_text(f"Mission: {index} {_NAMES[command]}"))
        if index in step.reached and command in _REACHED_TOLD:
            said.append(_text(f"Reached command #{index}"))
    return tuple(said)


def _text(text: str) -> Message:
    return status_text(mavlink.MAV_SEVERITY_INFO, text)
