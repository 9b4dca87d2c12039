"""The tests that end an approach: each fires after its hold time and not before; what is committed lands."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.data import GRAVITY_M_S2
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.aborts import ABORTS, is_not_followed, is_out_of_range, strays
from companion.landing.decisions.conditions import Condition, cause_of
from companion.landing.decisions.entries import update_held
from companion.landing.decisions.standing import FASTER_ON_ROOF
from companion.landing.state.memory import Held
from companion.situation.phases import LANDING_PHASES, Event, Phase
from companion.situation.situation import Following, Situation
from companion.vehicle.pad_reach import cone_radius_m
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    TICK_NS,
    changed,
    decided,
    drone_at,
    first_decision,
    later,
    pad_at,
    progress,
    reference_at,
    situation,
)
from tests.companion.landing.decisions.unsafe_facts import HALF_M, HIGH_M, LOW_M, UNSAFE, risky
from tests.companion.world import LANDING

BLIND = (
    Reason.OWN_POSITION_OLD,
    Reason.HEADING_UNKNOWN,
    Reason.BELOW_PAD,
    Reason.NOTHING_TOUCHED,
    Reason.ROAD_BELOW,
    Reason.SETPOINTS_UNHEARD,
)
# These cannot be true of a drone that is committed: it is over the pad and hardly moves against it.
UNFIT = {Reason.OUTSIDE_CONE, Reason.TOO_FAST_NEAR_PAD}
# This ends a commitment.
TURNS_BACK = {Reason.CONTACT_RISKY}


def _moving(speed_m_s: float) -> Situation:
    return replace(situation(), drone=drone_at(HIGH_M, 0.0, (0.0, speed_m_s, 0.0), pad=pad_at()))


CASES = [(test, phase) for test in ABORTS for phase in Phase if phase in test.phases]


def _before_the_next_phase(facts: Situation, phase: Phase) -> Situation:
    """The same with the drone beside the pad, so that an approach goes on from `phase` by nothing but an abort."""
    beside_m = {Phase.CHASE: 2.0, Phase.ALIGN: 1.0}.get(phase, 0.0) * CONFIG.descent.alignment.begin_distance_m
    if facts.drone is None:
        return facts
    place = facts.drone.position_enu_m + np.array([beside_m, 0.0, 0.0])
    return replace(facts, drone=replace(facts.drone, position_enu_m=place))


def test_every_abort_test_is_tried_here() -> None:
    assert {test.reason for test in ABORTS} == set(UNSAFE)


@pytest.mark.parametrize(("test", "phase"), CASES)
def test_abort_fires_exactly_after_its_hold_time(test: Condition, phase: Phase) -> None:
    facts = _before_the_next_phase(UNSAFE[test.reason], phase)
    hold_s = test.hold_s(facts, CONFIG)
    decision, ticks = first_decision(phase, facts, hold_s + 1.0)
    assert decision == (Event.UNSAFE, cause_of(test, facts, CONFIG))
    assert ticks == math.ceil(hold_s * 1e9 / TICK_NS - 1e-9)


@pytest.mark.parametrize("phase", sorted(LANDING_PHASES, key=str))
def test_lost_token_ends_no_approach_while_fixes_are_fresh(phase: Phase) -> None:
    facts = _before_the_next_phase(changed(situation(), is_alive=False, fix_age_s=0.0), phase)
    assert first_decision(phase, facts, 1.0)[0] is None


@given(north_m=st.floats(-2.0, 2.0), up_m=st.floats(-90.0, 90.0))
def test_range_from_the_start_is_horizontal(north_m: float, up_m: float) -> None:
    facts = situation()
    assert facts.drone is not None
    place = facts.drone.position_enu_m
    for beyond_m in (-1.0, 1.0):
        east_m = math.sqrt((CONFIG.limits.range_max_m + beyond_m) ** 2 - north_m**2)
        away = replace(facts, waiting_point_enu_m=place + np.array([east_m, north_m, up_m]))
        assert is_out_of_range(away, CONFIG) is (beyond_m > 0.0)


@pytest.mark.parametrize("phase", sorted(LANDING_PHASES, key=str))
def test_pad_that_has_stepped_ends_an_approach_at_once(phase: Phase) -> None:
    facts = _before_the_next_phase(changed(situation(), has_pad_stepped=True), phase)
    assert first_decision(phase, facts, 1.0) == ((Event.UNSAFE, Cause(Reason.SIGHTINGS_DISAGREE)), 0)


@pytest.mark.parametrize("reason", [Reason.SEEN_ELSEWHERE, Reason.SIGHTINGS_DISAGREE])
@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN])
def test_heading_that_is_off_is_blamed_before_a_detector(phase: Phase, reason: Reason) -> None:
    facts = UNSAFE[reason]
    assert facts.pad is not None
    off = Cause(Reason.HEADING_OFF_COURSE, (28.0,))
    unplaced = replace(facts, pad=replace(facts.pad, unplaced=off))
    decision, _ = first_decision(phase, _before_the_next_phase(unplaced, phase), 3.0)
    assert decision == (Event.UNSAFE, off)


@pytest.mark.parametrize(
    ("test", "phase"), [(test, phase) for test, phase in CASES if test.hold_s(situation(), CONFIG) > 0.0]
)
def test_condition_that_breaks_off_for_one_step_begins_anew(test: Condition, phase: Phase) -> None:
    hold_ticks = math.ceil(test.hold_s(situation(), CONFIG) * 1e9 / TICK_NS - 1e-9)
    held: Held = {}
    for ticks in range(4 * hold_ticks):
        is_break = ticks % hold_ticks == hold_ticks - 1
        now = later(situation() if is_break else UNSAFE[test.reason], ticks * TICK_NS)
        held = update_held(held, phase, now, CONFIG)
        decision = decided(progress(phase, 0.0), now, held)
        assert decision is None or decision[0] is not Event.UNSAFE


@pytest.mark.parametrize("phase", LANDING)
def test_nothing_aborts_while_all_is_well(phase: Phase) -> None:
    decision, _ = first_decision(phase, situation(), 3.0)
    assert decision is None or decision[0] not in {Event.UNSAFE, Event.TIME_LIMIT}


@pytest.mark.parametrize("reason", [one for one in UNSAFE if one not in {*BLIND, *UNFIT, *TURNS_BACK}])
def test_below_the_commit_height_it_lands_rather_than_aborts(reason: Reason) -> None:
    unsafe = UNSAFE[reason]
    assert unsafe.pad is not None
    speed: Vector3 = (0.9 * CONFIG.abort.near_speed_max_m_s, 0.0, -0.4)
    assert unsafe.drone is not None
    drone = replace(drone_at(LOW_M, 0.1, speed, pad=unsafe.pad), attitude_known=unsafe.drone.attitude_known)
    low = changed(unsafe, drone=drone, reference=reference_at(LOW_M))
    decision, _ = first_decision(Phase.DESCEND, low, 3.0)
    assert decision is None


@pytest.mark.parametrize("reason", BLIND)
def test_below_the_commit_height_it_does_not_land_blind_or_unheard(reason: Reason) -> None:
    blind = UNSAFE[reason]
    relative = blind.approach
    if blind.pad is not None and relative is not None and relative.height_m > LOW_M:
        blind = replace(blind, drone=drone_at(LOW_M, 0.1, (0.0, 0.0, -0.4), pad=blind.pad))
    decision, _ = first_decision(Phase.DESCEND, blind, 3.0)
    assert decision == (Event.UNSAFE, Cause(reason))


MOST = CONFIG.descent.risk.turns_back_min
STANDS = changed(risky(0.12, 0.1), reference=reference_at(-0.2), range_height_m=0.01)
"""On what the range finder sees, higher than the pad is said to be."""


@pytest.mark.parametrize(
    ("facts", "turns_back"),
    [
        (risky(LOW_M, 0.45), True),
        (risky(LOW_M, 0.45, unsafe=MOST - 0.01), False),
        (risky(LOW_M, 0.45, unsafe=MOST + 0.01), True),
        (risky(LOW_M, 0.45, unsafe=0.0, broken_off=0.45), False),
        (risky(LOW_M, 0.45, unsafe=0.0, broken_off=0.55), True),
        (risky(CONFIG.descent.commit_height_m + 0.01, 0.45), False),  # it may wait
        (risky(0.02, 0.45), True),  # what it touches as it tries, it would touch anyway
        (risky(CONFIG.abort.may_stand_below_m - 0.01, 0.1), False),  # it may stand already
        (risky(CONFIG.abort.may_stand_below_m + 0.01, 0.1), True),
        (STANDS, False),
    ],
)
def test_a_committed_descent_turns_back_from_a_risky_contact_or_tries(facts: Situation, turns_back: bool) -> None:
    decision, ticks = first_decision(Phase.DESCEND, facts, 0.1)
    assert (decision is not None and decision[1].reason is Reason.CONTACT_RISKY) is turns_back
    assert not turns_back or ticks == 0


@pytest.mark.parametrize(
    ("height_m", "more_m_s2", "breaks_off"),
    [
        (CONFIG.descent.wait.height_m + 0.01, 0.01, False),  # it may still catch up with the vehicle
        (CONFIG.descent.wait.height_m, 0.01, True),
        (CONFIG.descent.wait.height_m, -0.01, False),
        (CONFIG.descent.commit_height_m + 0.01, 0.01, True),
        (LOW_M, 0.01, False),
    ],
)
def test_descent_breaks_off_where_the_air_pushes_harder_than_the_gear_holds(
    height_m: float, more_m_s2: float, breaks_off: bool
) -> None:
    held_m_s2 = CONFIG.touchdown.gear_friction * GRAVITY_M_S2
    facts = changed(situation(height_m), pushed_m_s2=(held_m_s2 + more_m_s2) / FASTER_ON_ROOF)
    decision, _ = first_decision(Phase.DESCEND, facts, 0.1)
    assert (decision is not None and decision[1].reason is Reason.WOULD_BLOW_OFF) is breaks_off


def test_drone_that_slides_on_the_pad_is_not_judged_by_what_pushes_it() -> None:
    drone = drone_at(0.0, 0.0, (0.0, 1.5 * CONFIG.abort.near_speed_max_m_s, 0.0), pad=pad_at())
    sliding = changed(replace(situation(), drone=drone), pushed_m_s2=2.0 * GRAVITY_M_S2)
    decision, _ = first_decision(Phase.DESCEND, sliding, 1.0)
    assert decision is not None
    assert decision[1].reason is Reason.TOO_FAST_NEAR_PAD


@pytest.mark.parametrize(
    ("drifting", "wanted"),
    [
        (situation(HIGH_M, cone_radius_m(HIGH_M, HALF_M, CONFIG) - 0.01), False),
        (situation(HIGH_M, cone_radius_m(HIGH_M, HALF_M, CONFIG) + 0.01), True),
        (_moving(CONFIG.abort.near_speed_max_m_s - 0.01), False),
        (_moving(CONFIG.abort.near_speed_max_m_s + 0.01), True),
    ],
)
def test_descent_waits_for_what_passes(drifting: Situation, wanted: bool) -> None:
    assert strays(drifting, CONFIG) is wanted


@pytest.mark.parametrize(("lost_for_s", "not_followed"), [(0.0, False), (1.9, False), (2.1, True)])
def test_drone_that_is_near_setpoints_that_begin_where_it_is_may_not_follow_them(
    lost_for_s: float, not_followed: bool
) -> None:
    facts = replace(situation(), following=Following(error_m=0.1, error_max_m=1.0, lost_for_s=lost_for_s))
    assert is_not_followed(facts, CONFIG) is not_followed
