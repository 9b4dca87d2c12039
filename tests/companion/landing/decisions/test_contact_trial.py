"""A trial of the signs of a contact that the autopilot may not have heard."""

import pytest

from companion.core.reasons import Reason
from companion.landing.decisions.conditions import MISSED, TOUCHED, TOUCHED_BY_DISPUTE
from companion.situation.situation import Situation
from tests.companion.facts import CONFIG, changed, reference_at, situation

(UNHEARD,) = (one for one in MISSED if one.reason is Reason.SETPOINTS_UNHEARD)
RANGE_FINDER = CONFIG.touchdown.range_finder
FEET_M = 0.27


def still(unanswered_s: float, seen_m: float | None = FEET_M) -> Situation:
    """Still above the pad, or on one that is higher than it is told, with a setpoint that sinks without the drone."""
    facts = changed(situation(FEET_M, 0.1), reference=reference_at(FEET_M - 0.3), range_height_m=seen_m)
    return changed(facts, unanswered_s=unanswered_s)


@pytest.mark.parametrize("unanswered_s", [0.3, 1.7])
def test_disputed_contact_is_believed_once_a_question_asked_since_is_answered(unanswered_s: float) -> None:
    facts = still(unanswered_s)
    assert TOUCHED_BY_DISPUTE.is_true(facts, CONFIG)
    assert TOUCHED_BY_DISPUTE.hold_s(facts, CONFIG) == max(RANGE_FINDER.disputed_hold_s, unanswered_s)


@pytest.mark.parametrize("seen_m", [0.01, 0.9 * RANGE_FINDER.contact_height_max_m, None])
def test_contact_that_no_range_finder_disputes_waits_for_no_answer(seen_m: float | None) -> None:
    unanswered, answered = still(1.7, seen_m), still(0.0, seen_m)
    assert TOUCHED.is_true(unanswered, CONFIG)
    assert TOUCHED.hold_s(unanswered, CONFIG) == TOUCHED.hold_s(answered, CONFIG)
    assert not UNHEARD.is_true(unanswered, CONFIG)


@pytest.mark.parametrize(("more_s", "expected"), [(-0.01, False), (0.01, True)])
def test_drone_that_may_hover_breaks_off(more_s: float, *, expected: bool) -> None:
    assert UNHEARD.is_true(still(RANGE_FINDER.disputed_hold_s + more_s), CONFIG) is expected


def test_drone_that_sinks_with_its_setpoint_lands_on() -> None:
    facts = changed(still(1.7), reference=reference_at(FEET_M))
    assert not UNHEARD.is_true(facts, CONFIG)
