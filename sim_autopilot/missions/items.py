"""What is uploaded: items of missions, fences and rally points, and which of them a firmware takes.

Source: MAVLink mission protocol, https://mavlink.io/en/services/mission.html; commands as PX4 and ArduCopter take them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, isinf, isnan, radians
from types import MappingProxyType

from link.frames.geodesy import Datum, enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.core.places import ABOVE_HOME, ABOVE_SEA

_DEGREES_TO_WIRE = 1e7
_FRAMES = ABOVE_SEA | ABOVE_HOME | {mavlink.MAV_FRAME_MISSION}

MISSION, FENCE, RALLY = (
    int(kind)
    for kind in (mavlink.MAV_MISSION_TYPE_MISSION, mavlink.MAV_MISSION_TYPE_FENCE, mavlink.MAV_MISSION_TYPE_RALLY)
)

_FLOWN = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH,
    mavlink.MAV_CMD_NAV_LAND,
    mavlink.MAV_CMD_NAV_TAKEOFF,
    mavlink.MAV_CMD_NAV_DELAY,
)
_DONE_AT_ONCE = (
    mavlink.MAV_CMD_DO_JUMP,
    mavlink.MAV_CMD_DO_CHANGE_SPEED,
    mavlink.MAV_CMD_DO_SET_HOME,
    mavlink.MAV_CMD_DO_SET_SERVO,
    mavlink.MAV_CMD_DO_LAND_START,
    mavlink.MAV_CMD_DO_SET_ROI,
    mavlink.MAV_CMD_DO_DIGICAM_CONTROL,
    mavlink.MAV_CMD_DO_MOUNT_CONFIGURE,
    mavlink.MAV_CMD_DO_MOUNT_CONTROL,
    mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
    mavlink.MAV_CMD_DO_GRIPPER,
    mavlink.MAV_CMD_IMAGE_START_CAPTURE,
    mavlink.MAV_CMD_IMAGE_STOP_CAPTURE,
    mavlink.MAV_CMD_VIDEO_START_CAPTURE,
    mavlink.MAV_CMD_VIDEO_STOP_CAPTURE,
    mavlink.MAV_CMD_SET_CAMERA_ZOOM,
    mavlink.MAV_CMD_SET_CAMERA_FOCUS,
)
_HEADING = 3
_FREE_HEADINGS: Mapping[int, tuple[int, ...]] = MappingProxyType(
    {
        mavlink.MAV_CMD_NAV_WAYPOINT: (_HEADING,),
        mavlink.MAV_CMD_NAV_LOITER_UNLIM: (_HEADING,),
        mavlink.MAV_CMD_NAV_LAND: (_HEADING,),
        mavlink.MAV_CMD_NAV_TAKEOFF: (_HEADING,),
        mavlink.MAV_CMD_NAV_VTOL_TAKEOFF: (_HEADING,),
        mavlink.MAV_CMD_NAV_VTOL_LAND: (_HEADING - 1, _HEADING),
    }
)
"""Parameters, counted from 0, that may be no number in ArduCopter too (AP_Mission): the heading."""
PLACED = frozenset(
    {
        mavlink.MAV_CMD_NAV_WAYPOINT,
        mavlink.MAV_CMD_NAV_LOITER_UNLIM,
        mavlink.MAV_CMD_NAV_LOITER_TURNS,
        mavlink.MAV_CMD_NAV_LOITER_TIME,
        mavlink.MAV_CMD_NAV_LOITER_TO_ALT,
        mavlink.MAV_CMD_NAV_LAND,
        mavlink.MAV_CMD_NAV_TAKEOFF,
        mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
        mavlink.MAV_CMD_NAV_VTOL_TAKEOFF,
        mavlink.MAV_CMD_NAV_VTOL_LAND,
        mavlink.MAV_CMD_DO_SET_HOME,
        mavlink.MAV_CMD_DO_LAND_START,
        mavlink.MAV_CMD_DO_SET_ROI,
    }
)
"""Commands of which ArduCopter keeps a place."""
_FENCE_ITEMS = (
    mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION,
)
_COMMANDS: Mapping[int, frozenset[int]] = MappingProxyType(
    {
        MISSION: frozenset((*_FLOWN, *_DONE_AT_ONCE)),
        FENCE: frozenset(_FENCE_ITEMS),
        RALLY: frozenset({int(mavlink.MAV_CMD_NAV_RALLY_POINT)}),
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Item:
    """One item as it travels; `x` and `y` are the integers of MISSION_ITEM_INT."""

    frame: int
    command: int
    autocontinue: int
    parameters: tuple[float, float, float, float]
    x: int
    y: int
    z: float

    def number(self, position: int, otherwise: float = 0.0) -> float:
        """Return parameter `position` (1 to 4), `otherwise` where it is not finite."""
        value = self.parameters[position - 1]
        return value if isfinite(value) else otherwise

    @property
    def has_place(self) -> bool:
        """Whether it says where."""
        return self.frame != mavlink.MAV_FRAME_MISSION and (self.x, self.y) != (0, 0)


Plans = Mapping[int, tuple[Item, ...]]
NO_PLANS: Plans = MappingProxyType({MISSION: (), FENCE: (), RALLY: ()})


def item_from_message(message: Message) -> Item:
    """Return the item of a MISSION_ITEM_INT, or of the MISSION_ITEM that older clients send.

    Raises:
        ValueError: a place that is not finite.
    """
    x, y = message.x, message.y
    if message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_ITEM:
        if not (isfinite(x) and isfinite(y)):
            raise ValueError(f"the place {x}, {y} is not finite")
        scale = 1.0 if message.frame == mavlink.MAV_FRAME_MISSION else _DEGREES_TO_WIRE
        x, y = round(x * scale), round(y * scale)
    return Item(
        frame=message.frame,
        command=message.command,
        autocontinue=message.autocontinue,
        parameters=(message.param1, message.param2, message.param3, message.param4),
        x=x,
        y=y,
        z=message.z,
    )


def result_of(item: Item, kind: int, more: frozenset[int] = frozenset(), frames: frozenset[int] = frozenset()) -> int:
    """Return the MAV_MISSION_RESULT that an item of a plan of type `kind` deserves.

    `more` are commands, and `frames` MAV_FRAMEs, that it may have besides those that every firmware takes.
    """
    if item.command not in _COMMANDS[kind] and not (kind == MISSION and item.command in more):
        return int(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame not in _FRAMES | frames:
        return int(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    if abs(item.x) > 90 * _DEGREES_TO_WIRE and item.frame != mavlink.MAV_FRAME_MISSION:
        return int(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if abs(item.y) > 180 * _DEGREES_TO_WIRE and item.frame != mavlink.MAV_FRAME_MISSION:
        return int(mavlink.MAV_MISSION_INVALID_PARAM6_Y)
    if not isfinite(item.z) and kind == MISSION and item.frame != mavlink.MAV_FRAME_MISSION:
        return int(mavlink.MAV_MISSION_INVALID_PARAM7)
    return int(mavlink.MAV_MISSION_ACCEPTED)


def item_message(item: Item, index: int, kind: int, target: tuple[int, int], *, current: bool, whole: bool) -> Message:
    """Return the MISSION_ITEM_INT at `index` for `target` (system, component), a MISSION_ITEM where not `whole`."""
    head = (*target, index, item.frame, item.command, int(current), item.autocontinue, *item.parameters)
    if whole:
        return mavlink.MAVLink_mission_item_int_message(*head, item.x, item.y, item.z, kind)
    scale = 1.0 if item.frame == mavlink.MAV_FRAME_MISSION else _DEGREES_TO_WIRE
    return mavlink.MAVLink_mission_item_message(*head, item.x / scale, item.y / scale, item.z, kind)


def unreadable(message: Message) -> int | None:
    """Return the MAV_MISSION_RESULT that names an item's first value that is no number, None where all are numbers.

    The place counts only for an item that needs one.
    """
    if message.mission_type != MISSION:
        return None
    place = (message.x, message.y, message.z) if message.command in PLACED else ()
    values = (message.param1, message.param2, message.param3, message.param4, *place)
    free = _FREE_HEADINGS.get(message.command, ())
    wrong = (index for index, value in enumerate(values) if isinf(value) or (isnan(value) and index not in free))
    first = next(wrong, None)
    return None if first is None else int(mavlink.MAV_MISSION_INVALID_PARAM1) + first


def place_of(item: Item, datum: Datum, home_enu_m: Vector3) -> Vector3:
    """Return where an item that says where is, in W (ENU about `datum`, m)."""
    latitude_rad, longitude_rad = radians(item.x / _DEGREES_TO_WIRE), radians(item.y / _DEGREES_TO_WIRE)
    altitude_m = item.z if isfinite(item.z) else 0.0
    if item.frame in ABOVE_SEA:
        return enu_from_geodetic(datum, latitude_rad, longitude_rad, altitude_m)
    east, north, _ = enu_from_geodetic(datum, latitude_rad, longitude_rad, datum.altitude_m)
    return (east, north, home_enu_m[2] + altitude_m)
