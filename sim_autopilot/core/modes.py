"""The flight modes and the one table of what leads from each to which."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

from link.records import replace


class Mode(Enum):
    """What the autopilot does with the drone."""

    __hash__ = object.__hash__  # by identity, as members compare: a name is hashed again at every look-up

    OFFBOARD = "offboard"  # follows a companion's setpoints
    HOLD = "hold"
    LAND = "land"
    TAKEOFF = "takeoff"
    RTL = "rtl"  # returns to launch, and lands
    MISSION = "mission"  # flies the uploaded items
    POSITION = "position"  # the pilot's sticks ask for velocity
    ALTITUDE = "altitude"  # for tilt and climb rate
    STABILIZED = "stabilized"  # for tilt and thrust
    MANUAL = "manual"  # the same, on a multirotor
    ACRO = "acro"  # for turn rates and thrust
    BRAKE = "brake"  # stops, and takes no sticks
    POSHOLD = "poshold"  # ArduCopter's second position mode
    SMART_RTL = "smart_rtl"  # returns the way it came
    ORBIT = "orbit"  # flies round a place
    DRIFT = "drift"  # flown as stabilized
    ZIGZAG = "zigzag"  # and this as the position mode, without lines
    THROW = "throw"  # these hold their place
    AVOID = "avoid"
    GUIDED_NOGPS = "guided_nogps"
    FOLLOW = "follow"  # keeps near somebody who tells where he is
    PRECISION_LAND = "precision_land"  # lands on a target that it is told of; ArduCopter's is part of LAND


class Event(Enum):
    """What can change the mode."""

    ASK_OFFBOARD = "ask_offboard"
    ASK_HOLD = "ask_hold"
    ASK_LAND = "ask_land"
    ASK_TAKEOFF = "ask_takeoff"
    ASK_RTL = "ask_rtl"
    ASK_MISSION = "ask_mission"
    ASK_POSITION = "ask_position"
    ASK_ALTITUDE = "ask_altitude"
    ASK_STABILIZED = "ask_stabilized"
    ASK_MANUAL = "ask_manual"
    ASK_ACRO = "ask_acro"
    ASK_BRAKE = "ask_brake"
    ASK_POSHOLD = "ask_poshold"
    ASK_SMART_RTL = "ask_smart_rtl"
    ASK_ORBIT = "ask_orbit"
    ASK_DRIFT = "ask_drift"
    ASK_ZIGZAG = "ask_zigzag"
    ASK_THROW = "ask_throw"
    ASK_AVOID = "ask_avoid"
    ASK_GUIDED_NOGPS = "ask_guided_nogps"
    ASK_FOLLOW = "ask_follow"
    ASK_PRECISION_LAND = "ask_precision_land"
    LOST_TO_POSITION = "lost_to_position"  # setpoints lost, and where the parameters send it then
    LOST_TO_HOLD = "lost_to_hold"
    LOST_TO_LAND = "lost_to_land"
    LOST_TO_RTL = "lost_to_rtl"
    FAILSAFE_HOLD = "failsafe_hold"  # battery, ground station, fence; setpoints that come back do not end it
    FAILSAFE_RTL = "failsafe_rtl"
    FAILSAFE_LAND = "failsafe_land"
    FAILSAFE_BRAKE = "failsafe_brake"
    FAILSAFE_SMART_RTL = "failsafe_smart_rtl"
    FAILSAFE_TERMINATE = "failsafe_terminate"  # the motors stop; no mode does that
    SETPOINTS_BACK = "setpoints_back"
    TAKEOFF_COMPLETE = "takeoff_complete"


ASK_FOR: Mapping[Mode, Event] = MappingProxyType({mode: Event(f"ask_{mode.value}") for mode in Mode})
"""The event by which an operator asks for a mode."""

FAILSAFES: Mapping[Event, Mode] = MappingProxyType(
    {
        Event.LOST_TO_POSITION: Mode.POSITION,
        Event.LOST_TO_HOLD: Mode.HOLD,
        Event.LOST_TO_LAND: Mode.LAND,
        Event.LOST_TO_RTL: Mode.RTL,
    }
)
"""What lost setpoints lead to, until they come back."""

LATCHED: Mapping[Event, Mode] = MappingProxyType(
    {
        Event.FAILSAFE_HOLD: Mode.HOLD,
        Event.FAILSAFE_BRAKE: Mode.BRAKE,
        Event.FAILSAFE_SMART_RTL: Mode.SMART_RTL,
        Event.FAILSAFE_RTL: Mode.RTL,
        Event.FAILSAFE_LAND: Mode.LAND,
    }
)
"""What the other failsafes lead to, until an operator asks for a mode."""

_SAFER: Mapping[Event, frozenset[Mode]] = MappingProxyType(
    {
        Event.FAILSAFE_HOLD: frozenset({Mode.BRAKE, Mode.SMART_RTL, Mode.RTL, Mode.LAND}),
        Event.FAILSAFE_BRAKE: frozenset({Mode.SMART_RTL, Mode.RTL, Mode.LAND}),
        Event.FAILSAFE_SMART_RTL: frozenset({Mode.RTL, Mode.LAND, Mode.PRECISION_LAND}),
        Event.FAILSAFE_RTL: frozenset({Mode.LAND, Mode.PRECISION_LAND}),
        Event.FAILSAFE_LAND: frozenset({Mode.PRECISION_LAND}),
    }
)
"""The modes that a failsafe leaves alone, since they end the flight sooner than its own."""

TRANSITIONS: Mapping[tuple[Mode, Event], Mode] = MappingProxyType(
    {(mode, ask): wanted for mode in Mode for wanted, ask in ASK_FOR.items()}
    | {(Mode.OFFBOARD, lost): fallback for lost, fallback in FAILSAFES.items()}
    | {(mode, event): LATCHED[event] for event, safer in _SAFER.items() for mode in Mode if mode not in safer}
    | {(fallback, Event.SETPOINTS_BACK): Mode.OFFBOARD for fallback in FAILSAFES.values()}
    | {(Mode.TAKEOFF, Event.TAKEOFF_COMPLETE): Mode.HOLD}
)
"""Where an event leads from a mode; a pair that is not here changes nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """The mode flown and the mode asked for; they differ in a failsafe, which is `latched` until the operator acts.

    `resting` is the one that it goes back to when the motors stop; None stays.
    """

    mode: Mode
    intended: Mode
    latched: bool = False
    resting: Mode | None = None

    @property
    def failsafe(self) -> bool:
        """Whether another mode than the one asked for is flown."""
        return self.latched or self.mode is not self.intended


def react(modes: Modes, event: Event) -> Modes:
    """Return the modes after `event`.

    Setpoints that come back end a failsafe only while OFFBOARD is still what was asked for.
    """
    target = TRANSITIONS.get((modes.mode, event))
    if target is None:
        return modes
    if event is Event.SETPOINTS_BACK and (modes.latched or modes.intended is not Mode.OFFBOARD):
        return modes
    if event in LATCHED:
        return replace(modes, mode=target, latched=True)
    return replace(modes, mode=target, intended=modes.intended if event in FAILSAFES else target, latched=False)


def rest(modes: Modes) -> Modes:
    """Return the modes once the motors have stopped."""
    if modes.resting is None:
        return modes
    return replace(modes, mode=modes.resting, intended=modes.resting, latched=False)
