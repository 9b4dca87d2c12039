"""A trial of the signs of a contact that the autopilot may not have heard."""

import pytest

from companion.core.reasons import Reason
from companion.landing.decisions.conditions import MISSED, TOUCHED, TOUCHED_BY_DISPUTE, Condition
from companion.situation.situation import Situation
from tests.companion.facts import CONFIG, changed, reference_at, situation

(UNHEARD,) = (one for one in MISSED if one.reason is Reason.SETPOINTS_UNHEARD)
RANGE_FINDER = CONFIG.touchdown.range_finder
FEET_M = 0.27


def still(unanswered_s: float, seen_m: float | None = FEET_M) -> Situation:
    """Still above the pad, or on one that is higher than it is told, with a setpoint that sinks without the drone."""
    facts = changed(situation(FEET_M, 0.1), reference=reference_at(FEET_M - 0.3), range_height_m=seen_m)
    return changed(facts, unanswered_s=unanswered_s)


@pytest.mark.parametrize("seen_m", [0.01, 0.9 * RANGE_FINDER.contact_height_max_m, FEET_M, None])
@pytest.mark.parametrize("trial", [TOUCHED, TOUCHED_BY_DISPUTE])
def test_no_trial_of_a_contact_goes_on_while_nothing_is_answered(trial: Condition, seen_m: float | None) -> None:
    assert trial.is_true(still(0.15, seen_m), CONFIG) is (trial is TOUCHED_BY_DISPUTE or seen_m != FEET_M)
    assert not trial.is_true(still(0.25, seen_m), CONFIG)


@pytest.mark.parametrize("trial", [TOUCHED, TOUCHED_BY_DISPUTE])
def test_drone_has_a_second_to_follow_again_before_a_contact_is_tried(trial: Condition) -> None:
    assert trial.is_true(changed(still(0.1, None), answering_s=1.01), CONFIG)
    assert not trial.is_true(changed(still(0.1, None), answering_s=0.99), CONFIG)


def test_slow_link_is_given_the_time_that_its_answers_take() -> None:
    slow = changed(still(0.7, None), late_s=0.3)
    assert TOUCHED.is_true(slow, CONFIG)
    assert not TOUCHED.is_true(changed(slow, unanswered_s=0.85), CONFIG)


@pytest.mark.parametrize("seen_m", [0.01, FEET_M, None])
@pytest.mark.parametrize(("more_s", "expected"), [(-0.01, False), (0.01, True)])
def test_drone_that_may_hover_breaks_off(seen_m: float | None, more_s: float, *, expected: bool) -> None:
    assert UNHEARD.is_true(still(0.2 + more_s, seen_m), CONFIG) is expected


@pytest.mark.parametrize(("more_s", "expected"), [(-0.01, False), (0.01, True)])
def test_drone_that_does_not_seem_to_stand_breaks_off_later(more_s: float, *, expected: bool) -> None:
    facts = changed(still(RANGE_FINDER.disputed_hold_s + more_s), reference=reference_at(FEET_M))
    assert UNHEARD.is_true(facts, CONFIG) is expected
