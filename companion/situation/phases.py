"""The phases of a landing and the one table of transitions between them.

An event that the table does not list for a phase leaves the phase as it is. `python -m companion.situation.phases`
prints the table as a Mermaid state diagram.
"""

from enum import Enum


class Phase(Enum):
    """Where in the landing the companion is."""

    __hash__ = object.__hash__  # by identity, as members compare: a name is hashed anew at every look-up

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


class Event(Enum):
    """What may move the landing from one phase to another."""

    START = "start"  # an operator's command
    START_AGAIN = "start again"  # likewise, while the autopilot's mode is not the companion's or its motors are off
    ABORT = "abort"  # an operator's command
    HOLD = "hold"  # an operator's command
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
    CALLED_OFF = "called off"  # an operator's hold or abort before the motors were armed
    TIME_LIMIT = "time limit"
    PILOT_TOOK_OVER = "pilot took over"


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
    }
)
"""Phases in which the companion streams setpoints."""

LANDING_PHASES = frozenset({Phase.CHASE, Phase.ALIGN, Phase.DESCEND})
"""Phases that follow the vehicle and are watched by the abort tests."""

FOLLOWING_PHASES = LANDING_PHASES | {Phase.TOUCHDOWN, Phase.ABORT}
"""Phases that plan by where the pad will be; all others need to know only where it is."""

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
