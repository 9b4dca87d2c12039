"""The reasons for which a landing can be broken off, from the companion's own tables."""

from companion.landing.conditions import ABORT_TESTS, ALIGNMENT_LOST, NOT_SEEN, STRAYS, TO_BE_SEEN
from companion.situation.phases import TRANSITIONS, Event, Phase

TESTS = (*ABORT_TESTS, STRAYS, ALIGNMENT_LOST, TO_BE_SEEN, NOT_SEEN)
"""What makes an approach unsafe."""


def reasons() -> frozenset[str]:
    """Return each reason that leads into an abort, without its numbers."""
    found: set[str] = set()
    for (phase, event), after in TRANSITIONS.items():
        if after is Phase.ABORT:
            found |= _reasons_of(phase, event)
    return frozenset(found)


def _reasons_of(phase: Phase, event: Event) -> set[str]:
    match event:
        case Event.UNSAFE:
            return {
                test.reason
                for test in (*ABORT_TESTS, STRAYS, ALIGNMENT_LOST, TO_BE_SEEN, NOT_SEEN)
                if phase in test.phases
            }
        case Event.TIME_LIMIT:
            return {f"{phase.value} took longer than # s"}
        case Event.ABORT | Event.HOLD:
            return {f"commanded: {event.value}"}
        case Event.CONTACT_LOST:
            return {"# m above the pad after contact"}
        case _:
            raise ValueError(f"{event.value} leads from {phase.value} into an abort for an unknown reason")
