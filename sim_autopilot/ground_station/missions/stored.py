"""What ArduCopter keeps of an item, and which plans it refuses as a whole.

Its storage has room for a few bytes of each item: parameters that no flight of a copter uses are lost, and so is the
place of an item that needs none.

Source: ArduPilot's AP_Mission and AC_PolyFence_loader.
"""

from collections.abc import Mapping
from math import isfinite, nan
from types import MappingProxyType

from link.mavlink.dialect import mavlink
from link.records import replace
from sim_autopilot.missions.items import FENCE, MISSION, PLACED, Item

_CORNERS_MIN = 3
_ALL = (1, 2, 3, 4)
_KEPT: Mapping[int, tuple[int, ...]] = MappingProxyType(
    {
        mavlink.MAV_CMD_NAV_WAYPOINT: (1,),
        mavlink.MAV_CMD_NAV_LOITER_UNLIM: (3,),
        mavlink.MAV_CMD_NAV_LOITER_TURNS: (1, 3, 4),
        mavlink.MAV_CMD_NAV_LOITER_TIME: (1, 3, 4),
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: (),
        mavlink.MAV_CMD_NAV_LAND: (1,),
        mavlink.MAV_CMD_NAV_TAKEOFF: (1,),
        mavlink.MAV_CMD_NAV_LOITER_TO_ALT: (2, 4),
        mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT: (1,),
        mavlink.MAV_CMD_NAV_VTOL_TAKEOFF: (),
        mavlink.MAV_CMD_NAV_VTOL_LAND: (1,),
        mavlink.MAV_CMD_CONDITION_DELAY: (1,),
        mavlink.MAV_CMD_CONDITION_DISTANCE: (1,),
        mavlink.MAV_CMD_DO_JUMP: (1, 2),
        mavlink.MAV_CMD_DO_CHANGE_SPEED: (1, 2, 3),
        mavlink.MAV_CMD_DO_SET_HOME: (1,),
        mavlink.MAV_CMD_DO_SET_RELAY: (1, 2),
        mavlink.MAV_CMD_DO_REPEAT_RELAY: (1, 2, 3),
        mavlink.MAV_CMD_DO_SET_SERVO: (1, 2),
        mavlink.MAV_CMD_DO_LAND_START: (),
        mavlink.MAV_CMD_DO_SET_ROI: (1,),
        mavlink.MAV_CMD_DO_FENCE_ENABLE: (1,),
        mavlink.MAV_CMD_DO_PARACHUTE: (1,),
        mavlink.MAV_CMD_DO_GRIPPER: (1, 2),
        mavlink.MAV_CMD_DO_SPRAYER: (1,),
    }
)
_WHOLE = frozenset({mavlink.MAV_CMD_DO_DIGICAM_CONTROL, mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW})
"""Without a place, but with parameters where others have it."""
_CORNERS = frozenset(
    {mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION}
)
_CIRCLES = frozenset({mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION})
_GLOBAL = int(mavlink.MAV_FRAME_GLOBAL)


def store_item(item: Item, kind: int) -> Item:
    """Return what is kept of an item of a plan of type `kind`; a parameter that is lost is no number."""
    if kind == FENCE:
        return replace(item, frame=_GLOBAL, autocontinue=0, parameters=(item.number(1), 0.0, 0.0, 0.0), z=0.0)
    if kind != MISSION:
        return replace(item, autocontinue=0, parameters=(0.0, 0.0, 0.0, 0.0))
    kept = _KEPT.get(item.command, _ALL)
    one, two, three, four = (value if place in kept else nan for place, value in enumerate(item.parameters, 1))
    item = replace(item, autocontinue=1, parameters=(one, two, three, four))
    if item.command in PLACED or item.command in _WHOLE:
        return item
    return replace(item, frame=_GLOBAL, x=0, y=0, z=0.0)


def restore_item(item: Item) -> Item:
    """Return how an item is sent that was stored: what was lost as zero."""
    one, two, three, four = (value if isfinite(value) else 0.0 for value in item.parameters)
    return replace(item, parameters=(one, two, three, four))


def leads_nowhere(item: Item, count: int) -> bool:
    """Return whether an item is a jump out of a mission of `count` items, or to home."""
    return item.command == mavlink.MAV_CMD_DO_JUMP and not 0 < round(item.number(1)) < count


def encloses_nothing(items: tuple[Item, ...]) -> bool:
    """Return whether a fence has a circle without a radius, or corners that are not as many as they say."""
    index = 0
    while index < len(items):
        first = items[index]
        if first.command in _CIRCLES and first.number(1) <= 0.0:
            return True
        if first.command not in _CORNERS:
            index += 1
            continue
        count = round(first.number(1))
        corners = items[index : index + count]
        alike = all((one.command, one.number(1)) == (first.command, first.number(1)) for one in corners)
        if count < _CORNERS_MIN or len(corners) < count or not alike:
            return True
        index += count
    return False
