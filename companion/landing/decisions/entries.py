"""Conditions that lead from one phase of an approach to the next, and what each phase waits for; pure."""

from functools import cache

from companion.config.companion import CompanionConfig
from companion.config.planning import LandingStyle
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.aborts import ABORTS, is_pad_unplaced, must_be_seen, strays
from companion.landing.decisions.conditions import (
    HEARD,
    HELD_UP,
    LIFTED,
    STOPPED_BY_PAD,
    TOUCHED,
    TOUCHED_BY_DISPUTE,
    Condition,
    has_lost_heading,
    holds,
    is_above_commitment,
    is_fix_old,
)
from companion.landing.decisions.passing import distance_m, is_too_low
from companion.landing.state.memory import Held
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation, driving_hold_s, vehicle_stands

Decision = tuple[Event, Cause]
"""What happens, and why."""

_DESCENT = frozenset({Phase.DESCEND})
_ALIGNMENT = frozenset({Phase.ALIGN})
_WAITING = frozenset({Phase.WAITING})


def _must_be_seen_above(s: Situation, c: CompanionConfig) -> bool:
    return must_be_seen(s, c) and is_above_commitment(s, c)


def _strays_above(s: Situation, c: CompanionConfig) -> bool:
    return is_above_commitment(s, c) and strays(s, c)


def _is_aligned(s: Situation, c: CompanionConfig) -> bool:
    return s.approach is not None and not (is_pad_unplaced(s, c) or must_be_seen(s, c) or strays(s, c))


def _is_far_off(s: Situation, c: CompanionConfig) -> bool:
    if s.approach is None or c.guidance.style is LandingStyle.DIRECT:
        return False
    return s.approach.distance_m > 2.0 * c.descent.alignment.begin_distance_m


def _is_nearby(s: Situation, c: CompanionConfig) -> bool:
    if s.drone is None or s.pad is None or is_pad_unplaced(s, c) or is_fix_old(s, c) or is_too_low(s, c):
        return False
    return distance_m(s.drone, s.pad) < c.chase.passing_distance_m


def _stands_nearby(s: Situation, c: CompanionConfig) -> bool:
    return _is_nearby(s, c) and vehicle_stands(s, c.chase)


def _still_stands(held: Held, s: Situation, c: CompanionConfig) -> bool:
    return _is_nearby(s, c) and not holds(DRIVES, held, s, c)


def _drives(s: Situation, c: CompanionConfig) -> bool:
    return s.pad is not None and not vehicle_stands(s, c.chase)


STRAYS = Condition(
    reason=Reason.STRAYS,
    phases=_DESCENT,
    is_true=_strays_above,
    hold_s=lambda _, c: c.descent.stray_hold_s,
    anew_max=lambda c: c.descent.strays_max,
)
"""Costs no approach at first, for nothing was near."""

ALIGNMENT_LOST = Condition(
    reason=Reason.ALIGNMENT_LOST,
    phases=_ALIGNMENT,
    is_true=_is_far_off,
    anew_max=lambda c: c.descent.strays_max,
)

TO_BE_SEEN = Condition(
    reason=Reason.PAD_TO_BE_SEEN,
    phases=_DESCENT,
    is_true=_must_be_seen_above,
    anew_max=lambda c: c.descent.unseen.anew_max,
)
"""Without a hold time, or it slips below."""

HEADING_LOST = Condition(
    reason=Reason.HEADING_LOST,
    phases=_DESCENT,
    is_true=has_lost_heading,
    anew_max=lambda c: c.descent.unseen.anew_max,
)
"""Without a hold time, or it slips below. A bend, or the next straight, shows the heading again."""

NOT_SEEN = Condition(
    reason=Reason.PAD_NOT_SEEN,
    phases=_ALIGNMENT,
    is_true=must_be_seen,
    hold_s=lambda _, c: c.descent.unseen.hold_s,
    anew_max=lambda c: c.descent.unseen.anew_max,
)

DRIVES = Condition(reason=Reason.VEHICLE_DRIVES, phases=_WAITING, is_true=_drives, hold_s=driving_hold_s)
"""Without this no vehicle is taken to pass."""

VEHICLE_STANDS = Condition(
    reason=Reason.VEHICLE_STANDS,
    phases=_WAITING,
    is_true=_stands_nearby,
    hold_s=lambda _, c: c.chase.parked_wait_s,
    goes_on=_still_stands,
)
"""A vehicle that stands may be about to depart, so it is landed on only after it has stood for a while.

What is too short to be driving ends no standing: one that creeps about as fast as the limit would do neither for ever.
"""

ALIGNED = Condition(reason=Reason.ALIGNED, phases=_ALIGNMENT, is_true=_is_aligned)

ENTRIES = (
    (Event.VEHICLE_PASSES, VEHICLE_STANDS),
    (Event.ALIGNED, ALIGNED),
    (Event.OUT_OF_ALIGNMENT, TO_BE_SEEN),
    (Event.OUT_OF_ALIGNMENT, HEADING_LOST),
    (Event.OUT_OF_ALIGNMENT, STRAYS),
    (Event.OUT_OF_ALIGNMENT, ALIGNMENT_LOST),
    (Event.OUT_OF_ALIGNMENT, NOT_SEEN),
    (Event.CONTACT, TOUCHED),
    (Event.CONTACT, STOPPED_BY_PAD),
    (Event.CONTACT, TOUCHED_BY_DISPUTE),
)
"""What leads to another phase of the approach."""


def update_held(
    held: Held, phase: Phase, s: Situation, config: CompanionConfig, *, others: tuple[Condition, ...] = ()
) -> Held:
    """Return since when each condition of this phase has been true, or has gone on."""
    return {
        one.reason: held.get(one.reason, s.monotonic_ns)
        for one in _conditions_in(phase, others)
        if one.is_true(s, config) or _goes_on(one, held, s, config)
    }


def _goes_on(one: Condition, held: Held, s: Situation, config: CompanionConfig) -> bool:
    return one.goes_on is not None and one.reason in held and one.goes_on(held, s, config)


@cache
def _conditions_in(phase: Phase, others: tuple[Condition, ...]) -> tuple[Condition, ...]:
    entries = (condition for _, condition in ENTRIES)
    return tuple(one for one in (*others, *ABORTS, *entries, HEARD, HELD_UP, LIFTED, DRIVES) if phase in one.phases)
