"""The flight modes and the one table of what leads from each to which."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType


class Mode(Enum):
    """What the autopilot does with the drone."""

    OFFBOARD = "offboard"  # follows a companion's setpoints
    HOLD = "hold"
    LAND = "land"
    TAKEOFF = "takeoff"
    RTL = "rtl"  # returns to launch, and lands
    POSITION = "position"  # the pilot's sticks, which nobody touches here


class Event(Enum):
    """What can change the mode."""

    ASK_OFFBOARD = "ask_offboard"
    ASK_HOLD = "ask_hold"
    ASK_LAND = "ask_land"
    ASK_TAKEOFF = "ask_takeoff"
    ASK_RTL = "ask_rtl"
    ASK_POSITION = "ask_position"
    LOST_TO_POSITION = "lost_to_position"  # setpoints lost, and where the parameters send it then
    LOST_TO_HOLD = "lost_to_hold"
    LOST_TO_LAND = "lost_to_land"
    LOST_TO_RTL = "lost_to_rtl"
    SETPOINTS_BACK = "setpoints_back"
    TAKEOFF_COMPLETE = "takeoff_complete"


ASK_FOR: Mapping[Mode, Event] = MappingProxyType(
    {
        Mode.OFFBOARD: Event.ASK_OFFBOARD,
        Mode.HOLD: Event.ASK_HOLD,
        Mode.LAND: Event.ASK_LAND,
        Mode.TAKEOFF: Event.ASK_TAKEOFF,
        Mode.RTL: Event.ASK_RTL,
        Mode.POSITION: Event.ASK_POSITION,
    }
)
"""The event by which an operator asks for a mode."""

FAILSAFES: Mapping[Event, Mode] = MappingProxyType(
    {
        Event.LOST_TO_POSITION: Mode.POSITION,
        Event.LOST_TO_HOLD: Mode.HOLD,
        Event.LOST_TO_LAND: Mode.LAND,
        Event.LOST_TO_RTL: Mode.RTL,
    }
)
"""Events after which the mode is not what was asked for, and the mode they lead to."""

TRANSITIONS: Mapping[tuple[Mode, Event], Mode] = MappingProxyType(
    {(mode, ask): wanted for mode in Mode for wanted, ask in ASK_FOR.items()}
    | {(Mode.OFFBOARD, lost): fallback for lost, fallback in FAILSAFES.items()}
    | {(fallback, Event.SETPOINTS_BACK): Mode.OFFBOARD for fallback in FAILSAFES.values()}
    | {(Mode.TAKEOFF, Event.TAKEOFF_COMPLETE): Mode.HOLD}
)
"""Where an event leads from a mode; a pair that is not here changes nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """The mode flown and the mode asked for; they differ in a failsafe."""

    mode: Mode
    intended: Mode

    @property
    def failsafe(self) -> bool:
        """Whether another mode than the one asked for is flown."""
        return self.mode is not self.intended


def react(modes: Modes, event: Event) -> Modes:
    """Return the modes after `event`.

    Setpoints that come back end a failsafe only while OFFBOARD is still what was asked for.
    """
    target = TRANSITIONS.get((modes.mode, event))
    if target is None or (event is Event.SETPOINTS_BACK and modes.intended is not Mode.OFFBOARD):
        return modes
    return Modes(mode=target, intended=modes.intended if event in FAILSAFES else target)
