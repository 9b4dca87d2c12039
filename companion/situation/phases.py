"""The phases of a flight and the one table of transitions between them.

An event that the table does not list for a phase leaves the phase as it is. `python -m companion.situation.phases`
prints the table as a Mermaid state diagram.
"""

from enum import Enum


class Phase(Enum):
    """Where in the flight the companion is."""

    __hash__ = object.__hash__  # by identity, as members compare: a name is hashed again at every look-up

    IDLE = "idle"  # flies nothing; the autopilot or its pilot does
    TAKEOFF = "takeoff"  # enters offboard control, arms and climbs to the waiting point
    WAITING = "waiting"  # hovers at the waiting point until the vehicle passes
    CHASE = "chase"  # closes in on the vehicle, above it
    ALIGN = "align"  # flies over the pad until position and velocity match
    DESCEND = "descend"  # sinks onto the pad inside the cone
    TOUCHDOWN = "touchdown"  # stands on the pad, motors being switched off
    SECURED = "secured"  # motors are off
    ABORT = "abort"  # climbs away from the deck
    HOLD = "hold"  # hovers where it is until told what to do
    PILOT = "pilot in command"  # the pilot or a failsafe took over
    ON_DECK = "on deck"  # stands on the vehicle, arms and waits for a quiet moment
    LIFT_OFF = "lift-off"  # climbs clear of the deck, moving with it
    FOLLOW = "follow"  # keeps its station relative to the vehicle
    RETURN = "return"  # flies to above the vehicle, wherever that drives
    RALLY = "rally"  # looks for a vehicle that fell silent where it was to pass, then waits at the rally point


class Event(Enum):
    """What may move the landing from one phase to another."""

    START = "start"  # an operator's command
    START_AGAIN = "start again"  # START while the autopilot's mode is not the companion's or its motors are off
    ABORT = "abort"  # an operator's command
    HOLD = "hold"  # an operator's command
    LAUNCH = "launch"  # an operator's command
    FOLLOW = "follow"  # an operator's command, or the vehicle of one who follows is heard again
    RETURN = "return"  # an operator's command, or a start from too far away or too low
    AT_WAITING_POINT = "at waiting point"
    VEHICLE_PASSES = "vehicle passes"
    OVER_PAD = "over pad"  # close enough to align
    ALIGNED = "aligned"
    OUT_OF_ALIGNMENT = "out of alignment"  # above the commit height, to be aligned again
    CONTACT = "contact"
    CONTACT_LOST = "contact lost"  # bounced or slid off
    MOTORS_OFF = "motors off"
    UNSAFE = "unsafe"  # an abort test fired
    CLEAR = "clear"  # the abort climb is complete and a retry is left
    CLEAR_TO_HOLD = "clear to hold"  # the abort climb is complete, no retry is left or no vehicle is there
    REFUSED = "refused"  # the autopilot did not arm or give control in time
    CALLED_OFF = (
        "called off"  # by an operator, an outage, or as the vehicle drives off: before the arming, or on its deck
    )
    CARRIED_OFF = "carried off"  # the vehicle drives off under a drone that has armed and stands on it
    TIME_LIMIT = "time limit"
    PILOT_TOOK_OVER = "pilot took over"
    DECK_QUIET = "deck quiet"  # with the motors armed
    CLEAR_OF_DECK = "clear of the deck"
    VEHICLE_NEAR = "vehicle near"  # so near that the chase begins
    VEHICLE_LOST = "vehicle lost"  # nothing is heard of it, or nothing that can be believed
    VEHICLE_FOUND = "vehicle found"
    HOME_NOW = "home now"  # the energy that is left is needed for the way home


FLYING_PHASES = frozenset(
    {
        Phase.TAKEOFF,
        Phase.WAITING,
        Phase.CHASE,
        Phase.ALIGN,
        Phase.DESCEND,
        Phase.TOUCHDOWN,
        Phase.ABORT,
        Phase.HOLD,
        Phase.ON_DECK,
        Phase.LIFT_OFF,
        Phase.FOLLOW,
        Phase.RETURN,
        Phase.RALLY,
    }
)
"""Phases in which the companion streams setpoints."""

LANDING_PHASES = frozenset({Phase.CHASE, Phase.ALIGN, Phase.DESCEND})
"""Phases that follow the vehicle and are watched by the abort tests."""

STATION_PHASES = frozenset({Phase.LIFT_OFF, Phase.FOLLOW, Phase.RETURN})
"""Phases that keep a place relative to the vehicle without landing on it."""

FOLLOWING_PHASES = LANDING_PHASES | STATION_PHASES | {Phase.TOUCHDOWN, Phase.ABORT, Phase.ON_DECK}
"""Phases that plan by where the pad will be; all others need to know only where it is."""

OUT_PHASES = frozenset({Phase.WAITING, Phase.FOLLOW, Phase.HOLD, Phase.RALLY})
"""Phases of a sortie from which the way home may be long."""

NEAR_PHASES = frozenset({Phase.ALIGN, Phase.DESCEND})
"""Phases so near to the vehicle that its place must be known; a chase stays above all that it may be."""

TRANSITIONS: dict[tuple[Phase, Event], Phase] = {
    (Phase.IDLE, Event.START): Phase.TAKEOFF,
    (Phase.SECURED, Event.START): Phase.TAKEOFF,
    (Phase.PILOT, Event.START): Phase.TAKEOFF,
    (Phase.HOLD, Event.START): Phase.WAITING,
    (Phase.HOLD, Event.START_AGAIN): Phase.TAKEOFF,
    (Phase.TAKEOFF, Event.AT_WAITING_POINT): Phase.WAITING,
    (Phase.TAKEOFF, Event.TIME_LIMIT): Phase.HOLD,
    (Phase.TAKEOFF, Event.REFUSED): Phase.IDLE,
    (Phase.TAKEOFF, Event.CALLED_OFF): Phase.IDLE,
    (Phase.TAKEOFF, Event.CARRIED_OFF): Phase.TOUCHDOWN,
    (Phase.HOLD, Event.CALLED_OFF): Phase.IDLE,
    (Phase.TOUCHDOWN, Event.CALLED_OFF): Phase.IDLE,
    (Phase.WAITING, Event.VEHICLE_PASSES): Phase.CHASE,
    (Phase.CHASE, Event.OVER_PAD): Phase.ALIGN,
    (Phase.ALIGN, Event.ALIGNED): Phase.DESCEND,
    (Phase.ALIGN, Event.OUT_OF_ALIGNMENT): Phase.CHASE,
    (Phase.DESCEND, Event.OUT_OF_ALIGNMENT): Phase.ALIGN,
    (Phase.DESCEND, Event.CONTACT): Phase.TOUCHDOWN,
    (Phase.TOUCHDOWN, Event.MOTORS_OFF): Phase.SECURED,
    (Phase.TOUCHDOWN, Event.CONTACT_LOST): Phase.ABORT,
    (Phase.ABORT, Event.CLEAR): Phase.CHASE,
    (Phase.ABORT, Event.CLEAR_TO_HOLD): Phase.HOLD,
    **{(phase, Event.HOLD): Phase.HOLD for phase in (Phase.TAKEOFF, Phase.WAITING)},
    **{(phase, Event.ABORT): Phase.ABORT for phase in LANDING_PHASES},
    **{(phase, Event.HOLD): Phase.ABORT for phase in LANDING_PHASES},
    **{(phase, Event.UNSAFE): Phase.ABORT for phase in LANDING_PHASES},
    **{(phase, Event.TIME_LIMIT): Phase.ABORT for phase in LANDING_PHASES},
    **{(phase, Event.ABORT): Phase.HOLD for phase in (Phase.TAKEOFF, Phase.WAITING)},
    **{(phase, Event.PILOT_TOOK_OVER): Phase.PILOT for phase in FLYING_PHASES},
    **{(phase, Event.LAUNCH): Phase.ON_DECK for phase in (Phase.IDLE, Phase.SECURED, Phase.PILOT)},
    (Phase.ON_DECK, Event.DECK_QUIET): Phase.LIFT_OFF,
    (Phase.ON_DECK, Event.REFUSED): Phase.IDLE,
    (Phase.ON_DECK, Event.CALLED_OFF): Phase.TOUCHDOWN,
    (Phase.ON_DECK, Event.TIME_LIMIT): Phase.TOUCHDOWN,
    (Phase.LIFT_OFF, Event.CLEAR_OF_DECK): Phase.FOLLOW,
    **{(phase, Event.FOLLOW): Phase.FOLLOW for phase in (Phase.WAITING, Phase.HOLD, Phase.RETURN, Phase.RALLY)},
    **{(phase, Event.RETURN): Phase.RETURN for phase in (Phase.WAITING, Phase.HOLD, Phase.FOLLOW, Phase.RALLY)},
    **{(phase, Event.HOME_NOW): Phase.RETURN for phase in (Phase.WAITING, Phase.HOLD, Phase.FOLLOW)},
    (Phase.FOLLOW, Event.START): Phase.CHASE,
    (Phase.RETURN, Event.VEHICLE_NEAR): Phase.CHASE,
    (Phase.RALLY, Event.VEHICLE_FOUND): Phase.RETURN,
    **{(phase, Event.VEHICLE_LOST): Phase.RALLY for phase in (Phase.FOLLOW, Phase.RETURN)},
    (Phase.LIFT_OFF, Event.CALLED_OFF): Phase.TOUCHDOWN,
    (Phase.ABORT, Event.CALLED_OFF): Phase.TOUCHDOWN,
    (Phase.LIFT_OFF, Event.TIME_LIMIT): Phase.ABORT,
    **{
        (phase, event): Phase.ABORT
        for phase in (Phase.LIFT_OFF, Phase.FOLLOW)
        for event in (Event.ABORT, Event.HOLD, Event.UNSAFE)
    },
    **{(Phase.RETURN, event): Phase.HOLD for event in (Event.ABORT, Event.HOLD, Event.UNSAFE, Event.TIME_LIMIT)},
    **{(Phase.RALLY, event): Phase.HOLD for event in (Event.ABORT, Event.HOLD)},
}


def next_phase(phase: Phase, event: Event) -> Phase:
    """Return the phase after `event`; the same phase when the table does not list the pair."""
    return TRANSITIONS.get((phase, event), phase)


def mermaid_diagram() -> str:
    """Return the table as a Mermaid state diagram."""
    identifier = {phase: phase.name.lower() for phase in Phase}
    names = [f'    state "{phase.value}" as {identifier[phase]}' for phase in Phase]
    arrows = [f"    {identifier[a]} --> {identifier[b]}: {event.value}" for (a, event), b in TRANSITIONS.items()]
    return "\n".join(["stateDiagram-v2", *names, f"    [*] --> {identifier[Phase.IDLE]}", *arrows])


if __name__ == "__main__":
    print(mermaid_diagram())  # noqa: T201 (this is the command's output)
