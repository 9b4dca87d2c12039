"""In what the firmwares' missions differ: uploads: how many items, which, and how they are asked for.

As PX4 and ArduCopter were seen to do it; commands and frames: both, item by item.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.core.places import ABOVE_TERRAIN
from sim_autopilot.missions.items import FENCE, MISSION, RALLY


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemRules:
    """Which items are taken, and how they are kept and told.

    Attributes:
        commands: of missions, besides those that both take.
        frames: of places, besides those that both take.
        told_frames: in which MISSION_ITEM_INT tells a place, by the frame it was sent in.
        told_fence_frame: in which MISSION_ITEM_INT tells every place of a fence; 0 is its own.
        needs_numbers: whether an item with a value that is no number is refused.
        keeps_little: whether of an item only what flies it is stored, and plans that make no sense are refused.
    """

    commands: frozenset[int] = frozenset()
    frames: frozenset[int] = frozenset()
    told_frames: Mapping[int, int] = field(default_factory=dict)
    told_fence_frame: int = 0
    needs_numbers: bool = False
    keeps_little: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferRules:
    """In what the firmwares differ.

    Attributes:
        items: that are taken.
        counts_max: most items, by MAV_MISSION_TYPE; a type that is not here is not supported.
        one_at_a_time: whether a transfer that is not finished keeps others out until it times out.
        retry_s: after which a missing item is asked for again.
        timeout_s: of silence after which a transfer is given up.
        timeout_answered: whether the end by time-out is told, as cancelled.
        wrong_sequence: MAV_MISSION_RESULT of an item out of turn; None asks for the right one again.
        asks_whole: whether items are asked for by MISSION_REQUEST_INT, until a MISSION_ITEM comes.
        takes_parts: whether a part of a plan can be written again.
        stores_at_once: plans of which each item takes the old one's place as it comes, whatever follows.
        clears_all: whether MAV_MISSION_TYPE_ALL can be cleared.
        received_text: what is said when a mission has come; empty says nothing.
    """

    items: ItemRules
    counts_max: Mapping[int, int] = field(
        default_factory=lambda: MappingProxyType({MISSION: 500, FENCE: 64, RALLY: 64})
    )
    one_at_a_time: bool = True
    retry_s: float = 0.25
    timeout_s: float = 5.0
    timeout_answered: bool = False
    wrong_sequence: int | None = None
    asks_whole: bool = True
    takes_parts: bool = False
    stores_at_once: frozenset[int] = frozenset()
    clears_all: bool = True
    received_text: str = ""


_ALL_FLY = (mavlink.MAV_CMD_NAV_LOITER_TO_ALT, mavlink.MAV_CMD_NAV_VTOL_TAKEOFF, mavlink.MAV_CMD_NAV_VTOL_LAND)
PX4_MISSIONS = TransferRules(
    items=ItemRules(
        told_fence_frame=int(mavlink.MAV_FRAME_GLOBAL_INT),
        commands=frozenset(
            (
                *_ALL_FLY,
                mavlink.MAV_CMD_NAV_ROI,
                mavlink.MAV_CMD_CONDITION_DELAY,
                mavlink.MAV_CMD_CONDITION_DISTANCE,
                mavlink.MAV_CMD_CONDITION_GATE,
                mavlink.MAV_CMD_COMPONENT_ARM_DISARM,
                mavlink.MAV_CMD_DO_CONTROL_VIDEO,
                mavlink.MAV_CMD_DO_SET_ACTUATOR,
                mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL,
                mavlink.MAV_CMD_DO_SET_ROI_LOCATION,
                mavlink.MAV_CMD_DO_SET_ROI_NONE,
                mavlink.MAV_CMD_DO_SET_ROI_WPNEXT_OFFSET,
                mavlink.MAV_CMD_DO_VTOL_TRANSITION,
                mavlink.MAV_CMD_DO_WINCH,
                mavlink.MAV_CMD_SET_CAMERA_MODE,
            )
        ),
        told_frames=MappingProxyType(
            {
                mavlink.MAV_FRAME_GLOBAL: mavlink.MAV_FRAME_GLOBAL_INT,
                mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT: mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
            }
        ),
    ),
)
ARDUCOPTER_MISSIONS = TransferRules(
    counts_max=MappingProxyType({MISSION: 724, FENCE: 84, RALLY: 26}),
    one_at_a_time=False,
    retry_s=1.0,
    timeout_s=8.0,
    timeout_answered=True,
    wrong_sequence=int(mavlink.MAV_MISSION_INVALID_SEQUENCE),
    asks_whole=False,
    takes_parts=True,
    stores_at_once=frozenset({MISSION, RALLY}),
    clears_all=False,
    received_text="Flight plan received",
    items=ItemRules(
        needs_numbers=True,
        commands=frozenset(
            (
                *_ALL_FLY,
                mavlink.MAV_CMD_NAV_LOITER_TURNS,
                mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
                mavlink.MAV_CMD_NAV_ALTITUDE_WAIT,
                mavlink.MAV_CMD_NAV_GUIDED_ENABLE,
                mavlink.MAV_CMD_NAV_PAYLOAD_PLACE,
                mavlink.MAV_CMD_NAV_ATTITUDE_TIME,
                mavlink.MAV_CMD_DO_GO_AROUND,
                mavlink.MAV_CMD_DO_INVERTED_FLIGHT,
                mavlink.MAV_CMD_DO_AUTOTUNE_ENABLE,
                mavlink.MAV_CMD_DO_SET_RESUME_REPEAT_DIST,
                mavlink.MAV_CMD_DO_SEND_SCRIPT_MESSAGE,
                mavlink.MAV_CMD_DO_GUIDED_LIMITS,
                mavlink.MAV_CMD_DO_ENGINE_CONTROL,
                mavlink.MAV_CMD_DO_VTOL_TRANSITION,
                mavlink.MAV_CMD_CONDITION_DELAY,
                mavlink.MAV_CMD_CONDITION_DISTANCE,
                mavlink.MAV_CMD_CONDITION_YAW,
                mavlink.MAV_CMD_DO_SET_RELAY,
                mavlink.MAV_CMD_DO_REPEAT_RELAY,
                mavlink.MAV_CMD_DO_REPEAT_SERVO,
                mavlink.MAV_CMD_DO_FENCE_ENABLE,
                mavlink.MAV_CMD_DO_PARACHUTE,
                mavlink.MAV_CMD_DO_AUX_FUNCTION,
                mavlink.MAV_CMD_DO_SPRAYER,
                mavlink.MAV_CMD_DO_WINCH,
            )
        ),
        told_frames=MappingProxyType(
            {
                mavlink.MAV_FRAME_GLOBAL_INT: mavlink.MAV_FRAME_GLOBAL,
                mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT: mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
                mavlink.MAV_FRAME_MISSION: mavlink.MAV_FRAME_GLOBAL,
                mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT: mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT,
            }
        ),
        frames=ABOVE_TERRAIN,
        keeps_little=True,
    ),
)
