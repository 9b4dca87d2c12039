"""The reasons for which a landing can be broken off, from the companion's own tables."""

from companion.core.reasons import Reason
from companion.landing.decisions.aborts import ABORTS
from companion.landing.decisions.entries import ALIGNMENT_LOST, NOT_SEEN, STRAYS, TO_BE_SEEN
from companion.landing.decisions.events import TOO_LONG
from companion.situation.phases import TRANSITIONS, Event, Phase

CONDITIONS = (*ABORTS, STRAYS, ALIGNMENT_LOST, TO_BE_SEEN, NOT_SEEN)
"""What makes an approach unsafe."""


def reasons() -> frozenset[Reason]:
    """Return each reason that leads into an abort."""
    found: set[Reason] = set()
    for (phase, event), after in TRANSITIONS.items():
        if after is Phase.ABORT:
            found |= _reasons_of(phase, event)
    return frozenset(found)


def _reasons_of(phase: Phase, event: Event) -> set[Reason]:
    match event:
        case Event.UNSAFE:
            return {one.reason for one in CONDITIONS if phase in one.phases}
        case Event.TIME_LIMIT:
            return {TOO_LONG[phase]}
        case Event.ABORT:
            return {Reason.OPERATOR_ABORTS}
        case Event.HOLD:
            return {Reason.OPERATOR_HOLDS}
        case Event.CONTACT_LOST:
            return {Reason.ABOVE_AFTER_CONTACT}
        case _:
            raise ValueError(f"{event.value} leads from {phase.value} into an abort for an unknown reason")
