"""The tests of the phases: each fires after its hold time and not before, and in the order of their weight."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.response import ATTITUDE_LAG_S
from companion.core.data import Rival
from companion.core.reasons import Cause, Reason, sentence
from companion.landing.decisions.aborts import ABORTS, is_out_of_range, must_wait
from companion.landing.decisions.conditions import Condition, cause_of
from companion.landing.decisions.entries import ENTRIES, update_held
from companion.landing.state.memory import Held
from companion.situation.phases import LANDING_PHASES, Event, Phase
from companion.situation.situation import Following, Situation
from companion.vehicle.pad import NOT_DESCRIBED, FrameOffset
from companion.vehicle.pad_reach import cone_radius_m
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    LONG_HEARD,
    NOW_NS,
    TICK_NS,
    braking_pad,
    changed,
    decided,
    drone_at,
    first_decision,
    forecast_of,
    later,
    pad_at,
    progress,
    reference_at,
    situation,
)
from tests.companion.world import FLYING, LANDING

HALF_M = pad_at().half_width_m
OVER_PAD_M = 2.0 * CONFIG.descent.cone.radius_at_pad_m
HIGH_M = CONFIG.descent.alignment.height_m
NEAR_M = 0.9 * CONFIG.abort.near_height_m
LOW_M = 0.5 * CONFIG.descent.commit_height_m

LIMITS = CONFIG.limits.flight_limits()


def _risky(height_m: float, sinks_m_s: float = 0.0, unsafe: float = 0.9, broken_off: float = 0.0) -> Situation:
    """The same over the pad with a forecast that a contact would be unsafe, or is broken off."""
    drone = drone_at(height_m, 0.0, (0.0, 0.0, -sinks_m_s), pad=pad_at())
    return changed(situation(height_m), drone=drone, limits=LIMITS, contact=forecast_of(unsafe, broken_off=broken_off))


# What makes each abort test true, everything else being in order; in the descent, above the commit height but for one.
UNSAFE: dict[Reason, Situation] = {
    Reason.VEHICLE_DATA_OLD: changed(situation(), fix_age_s=CONFIG.abort.fix_age_max_s + 0.01),
    Reason.VEHICLE_UNCERTAIN: situation(pad=pad_at(std_m=CONFIG.abort.position_std_max_m + 0.01)),
    Reason.OFFSET_UNKNOWN: situation(pad=replace(pad_at(std_m=1.0), has_one_frame=False)),
    Reason.VEHICLE_LINK_LOST: changed(
        situation(), is_alive=False, fix_age_s=CONFIG.abort.alive_lost_fix_age_max_s + 0.01
    ),
    Reason.VEHICLE_CLOCK_AHEAD: changed(situation(), fix_age_on_arrival_s=-CONFIG.integrity.fix_ahead_max_s - 0.01),
    Reason.OWN_POSITION_OLD: replace(situation(), drone=None),
    Reason.OWN_ATTITUDE_OLD: replace(situation(), drone=replace(drone_at(1.5, pad=pad_at()), attitude_known=False)),
    Reason.HEADING_UNKNOWN: situation(pad=pad_at(placed=False)),
    Reason.SETPOINT_NOT_FOLLOWED: replace(situation(), following=Following(error_m=1.01, error_max_m=1.0)),
    Reason.OUTSIDE_CONE: situation(NEAR_M, cone_radius_m(NEAR_M, HALF_M, CONFIG) + 0.01),
    Reason.TOO_FAST_NEAR_PAD: replace(
        situation(),
        drone=drone_at(NEAR_M, 0.0, (CONFIG.abort.near_speed_max_m_s + 0.01, 0.0, 0.0), pad=pad_at()),
    ),
    Reason.CONTACT_RISKY: _risky(LOW_M),
    Reason.TOO_FAR_FROM_START: replace(
        situation(), waiting_point_enu_m=np.array([CONFIG.limits.range_max_m + 10.0, 0.0, 5.0])
    ),
    Reason.VEHICLE_OUTRUNS: replace(situation(), limits=replace(CONFIG.limits.flight_limits(), speed_max_m_s=4.1)),
    Reason.VEHICLE_CONTRADICTS_ITSELF: changed(situation(), rejected_share=CONFIG.integrity.rejected_share_max + 0.01),
    Reason.SEEN_ELSEWHERE: situation(pad=replace(pad_at(), frame_offset=FrameOffset(distance_m=1.0, std_m=0.01))),
    Reason.VEHICLE_TAKEN: changed(situation(), rival=Rival(drone="drone2", is_this_drone=False)),
    Reason.SIGHTINGS_DISAGREE: changed(situation(), are_sightings_mixed=True),
    Reason.SEEN_TOO_NEAR: changed(situation(), range_height_m=0.5),
    Reason.BELOW_PAD: situation(-CONFIG.descent.sink.press_depth_m - CONFIG.touchdown.height_max_m - 0.01),
    Reason.NOTHING_TOUCHED: situation(-CONFIG.touchdown.lost.missed_depth_m - 0.01),
}
# Below the commit height these still count: without them nobody knows where the pad is.
BLIND = (Reason.OWN_POSITION_OLD, Reason.HEADING_UNKNOWN, Reason.BELOW_PAD, Reason.NOTHING_TOUCHED)
# These cannot be true of a drone that is committed: it is over the pad and hardly moves against it.
UNFIT = {Reason.OUTSIDE_CONE, Reason.TOO_FAST_NEAR_PAD}
# This ends a commitment.
TURNS_BACK = {Reason.CONTACT_RISKY}


def _moving(speed_m_s: float) -> Situation:
    return replace(situation(), drone=drone_at(HIGH_M, 0.0, (0.0, speed_m_s, 0.0), pad=pad_at()))


CASES = [(test, phase) for test in ABORTS for phase in Phase if phase in test.phases]


def _before_the_next_phase(facts: Situation, phase: Phase) -> Situation:
    """The same with the drone beside the pad, so that an approach goes on from `phase` by nothing but an abort."""
    beside_m = {Phase.CHASE: 2.0, Phase.ALIGN: 0.5}.get(phase, 0.0) * CONFIG.descent.alignment.begin_distance_m
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
def test_below_the_commit_height_it_does_not_land_where_nobody_knows_the_pad_to_be(reason: Reason) -> None:
    blind = UNSAFE[reason]
    relative = blind.approach
    if blind.pad is not None and relative is not None and relative.height_m > LOW_M:
        blind = replace(blind, drone=drone_at(LOW_M, 0.1, (0.0, 0.0, -0.4), pad=blind.pad))
    decision, _ = first_decision(Phase.DESCEND, blind, 3.0)
    assert decision == (Event.UNSAFE, Cause(reason))


LAG_M = 0.45 * ATTITUDE_LAG_S
STOPPING_M = LAG_M + 0.5 * 0.45**2 / LIMITS.vertical_acceleration_max_m_s2
MOST = CONFIG.descent.risk.turns_back_min


@pytest.mark.parametrize(
    ("facts", "turns_back"),
    [
        (_risky(LOW_M, 0.45), True),
        (_risky(LOW_M, 0.45, unsafe=MOST - 0.01), False),
        (_risky(LOW_M, 0.45, unsafe=MOST + 0.01), True),
        (_risky(LOW_M, 0.45, unsafe=0.0, broken_off=0.45), False),
        (_risky(LOW_M, 0.45, unsafe=0.0, broken_off=0.55), True),
        (_risky(CONFIG.descent.commit_height_m + 0.01, 0.45), False),  # it may wait
        (_risky(max(STOPPING_M, CONFIG.descent.sway.height_min_m) + 0.01, 0.45), True),
        (_risky(CONFIG.descent.sway.height_min_m - 0.01), False),  # it may stand already
        (_risky(0.2, 1.0), False),
        (_risky(0.3, 1.0), True),
        (changed(_risky(0.3, 1.0), late_s=0.1), False),  # the command would come too late
    ],
)
def test_a_committed_descent_turns_back_from_a_risky_contact_while_it_can(facts: Situation, turns_back: bool) -> None:
    decision, ticks = first_decision(Phase.DESCEND, facts, 0.1)
    assert (decision is not None and decision[1].reason is Reason.CONTACT_RISKY) is turns_back
    assert not turns_back or ticks == 0


@pytest.mark.parametrize(
    ("drifting", "wanted"),
    [
        (situation(HIGH_M, cone_radius_m(HIGH_M, HALF_M, CONFIG) - 0.01), False),
        (situation(HIGH_M, cone_radius_m(HIGH_M, HALF_M, CONFIG) + 0.01), True),
        (_moving(CONFIG.abort.near_speed_max_m_s - 0.01), False),
        (_moving(CONFIG.abort.near_speed_max_m_s + 0.01), True),
        (situation(pad=braking_pad(CONFIG.descent.wait.speed_change_max_m_s2 - 0.01)), False),
        (situation(pad=braking_pad(CONFIG.descent.wait.speed_change_max_m_s2 + 0.01)), True),
    ],
)
def test_descent_waits_for_what_passes(drifting: Situation, wanted: bool) -> None:
    assert must_wait(drifting, CONFIG) is wanted


def test_drone_beside_the_pad_below_the_commit_height_aborts_and_is_not_taken_for_landed() -> None:
    beside = situation(0.0, OVER_PAD_M + 0.05)
    beside = changed(beside, autopilot=replace(beside.autopilot, landed=True), reference=reference_at(-0.4))
    decision, _ = first_decision(Phase.DESCEND, beside, 3.0)
    assert decision == (Event.UNSAFE, Cause(Reason.OUTSIDE_CONE))


def _jolted(facts: Situation) -> Situation:
    """The same with a drone whose velocity has just changed faster than flying can."""
    assert facts.drone is not None
    return replace(facts, drone=replace(facts.drone, jolt_m_s2=CONFIG.touchdown.jolt_m_s2 + 0.1))


def test_drone_that_is_stopped_while_the_pad_drives_on_has_landed_and_does_not_climb_away() -> None:
    stopped = changed(
        situation(0.0),
        drone=drone_at(0.0, 0.3, (-4.0, -1.0, 0.0), pad=pad_at((4.0, 1.0, 0.0))),
        reference=reference_at(-CONFIG.touchdown.blocked_depth_m - 0.01),
    )
    decision, ticks = first_decision(Phase.DESCEND, _jolted(stopped), 1.0)
    assert decision is not None
    assert (decision[0], ticks) == (Event.CONTACT, 0)
    unexplained, _ = first_decision(Phase.DESCEND, stopped, CONFIG.abort.near_speed_hold_s + 0.02)
    assert unexplained == (Event.UNSAFE, Cause(Reason.TOO_FAST_NEAR_PAD))


def test_jolt_with_the_pad_in_the_range_finders_sight_needs_no_sunken_setpoint() -> None:
    stopped = _jolted(changed(situation(0.0), reference=reference_at(0.05), range_height_m=0.03))
    decision, _ = first_decision(Phase.DESCEND, stopped, 0.0)
    assert decision is not None
    assert decision[0] is Event.CONTACT
    far = changed(stopped, range_height_m=CONFIG.touchdown.range_finder.contact_height_max_m + 0.01)
    assert first_decision(Phase.DESCEND, far, 0.0)[0] is None


@pytest.mark.parametrize(("seen_last_m", "wanted"), [(0.0, Event.CONTACT), (0.15, Event.CONTACT), (0.16, Event.UNSAFE)])
def test_drone_that_is_stopped_after_its_range_finder_fell_blind_has_landed_where_it_was_sinking_to(
    seen_last_m: float, wanted: Event
) -> None:
    pad = pad_at((4.0, 1.0, 0.0))
    stopped = changed(
        situation(-0.3),
        drone=drone_at(-0.3, 0.2, (-4.0, -1.0, -0.25), pad=pad),
        pad=pad,
        reference=reference_at(-0.2),  # it follows its setpoint: no other sign speaks for a contact
        range_carried_m=seen_last_m,
    )
    decision, _ = first_decision(Phase.DESCEND, _jolted(stopped), 1.0)
    assert decision is not None
    assert decision[0] is wanted
    in_sight = changed(stopped, range_height_m=2.0)
    assert first_decision(Phase.DESCEND, _jolted(in_sight), 1.0)[0] == (Event.UNSAFE, Cause(Reason.TOO_FAST_NEAR_PAD))


@pytest.mark.parametrize(("driven_s", "wanted"), [(0.0, Event.CONTACT), (0.055, Event.CONTACT), (0.16, Event.UNSAFE)])
def test_what_has_stopped_the_drone_was_the_pad_where_it_was_before_it_drove_on(driven_s: float, wanted: Event) -> None:
    pad = pad_at((8.0, 0.0, 0.0))
    before = drone_at(0.02, 0.0, (-8.0, 0.0, 0.0), pad=pad)
    # Beside the pad's centre at the contact; the pad drives on eastwards, and the drone falls behind.
    place = before.position_enu_m + np.array([-0.3 - 8.0 * driven_s, 0.45, 0.0])
    stopped = changed(
        situation(0.02),
        drone=replace(before, position_enu_m=place, age_s=0.0),
        pad=pad,
        reference=reference_at(0.0),
        range_height_m=0.02,
    )
    decision, _ = first_decision(Phase.DESCEND, _jolted(stopped), 1.0)
    assert decision is not None
    assert decision[0] is wanted


def test_drone_that_the_pad_stops_beside_the_cone_has_landed_though_the_stop_ends_its_commitment() -> None:
    beside_m = cone_radius_m(0.05, HALF_M, CONFIG) + 0.1
    assert beside_m < OVER_PAD_M
    pad = pad_at((4.0, 1.0, 0.0))
    sinking = changed(
        situation(0.05),
        drone=drone_at(0.05, beside_m, (0.0, 0.0, -0.4), pad=pad),
        pad=pad,
        reference=reference_at(0.0),
        range_height_m=0.05,
    )
    stopped = _jolted(replace(sinking, drone=drone_at(0.05, beside_m, (-4.0, -1.0, -0.3), pad=pad)))
    held: Held = {}
    ticks = 2 * math.ceil(CONFIG.abort.cone_hold_s * 1e9 / TICK_NS)
    for tick in range(ticks):
        now = later(sinking, tick * TICK_NS)
        held = update_held(held, Phase.DESCEND, now, CONFIG)
        assert decided(progress(Phase.DESCEND, 0.0), now, held) is None
    now = later(stopped, ticks * TICK_NS)
    held = update_held(held, Phase.DESCEND, now, CONFIG)
    decision = decided(progress(Phase.DESCEND, 0.0), now, held)
    assert decision is not None
    assert decision[0] is Event.CONTACT


@pytest.mark.parametrize(
    ("beside_m", "speed_m_s", "stays"),
    [(0.1, CONFIG.abort.near_speed_max_m_s + 0.1, True), (0.55, 0.1, True), (0.1, 4.0, False)],
    ids=["slides to rest on the pad", "stands beside the cone", "slides off"],
)
def test_drone_that_stands_on_the_pad_does_not_lift_off_for_where_it_stands(
    beside_m: float, speed_m_s: float, *, stays: bool
) -> None:
    standing = changed(
        situation(0.0),
        drone=drone_at(0.0, beside_m, (0.0, speed_m_s, 0.0), pad=pad_at()),
        reference=reference_at(-CONFIG.touchdown.blocked_depth_m - 0.01),
    )
    decision, _ = first_decision(Phase.DESCEND, standing, 1.0)
    assert decision is not None
    assert decision[0] is (Event.CONTACT if stays else Event.UNSAFE)


def test_jolt_in_the_air_is_no_contact() -> None:
    sinking = replace(situation(LOW_M), drone=drone_at(LOW_M, 0.1, (0.0, 0.0, -0.4), pad=pad_at()))
    decision, _ = first_decision(Phase.DESCEND, _jolted(changed(sinking, reference=reference_at(LOW_M))), 1.0)
    assert decision is None


@pytest.mark.parametrize(("event", "test"), ENTRIES)
def test_landing_goes_on_exactly_after_the_hold_time(event: Event, test: Condition) -> None:
    (phase,) = test.phases
    match event:
        case Event.VEHICLE_PASSES:
            facts = situation(3.0, 2.0, pad=pad_at((0.0, 0.0, 0.0)))
        case Event.ALIGNED:
            facts = situation()
        case Event.OUT_OF_ALIGNMENT if test.reason is Reason.STRAYS:
            facts = situation(HIGH_M, cone_radius_m(HIGH_M, HALF_M, CONFIG) + 0.01)
        case Event.OUT_OF_ALIGNMENT if test.reason is Reason.ALIGNMENT_LOST:
            facts = situation(HIGH_M, 2.0 * CONFIG.descent.alignment.begin_distance_m + 0.01)
        case Event.OUT_OF_ALIGNMENT:
            facts = situation(pad=replace(pad_at(std_m=CONFIG.descent.unseen.std_max_m + 0.01), is_coarse=True))
        case _:
            facts = changed(situation(0.0), reference=reference_at(-CONFIG.touchdown.blocked_depth_m - 0.01))
    if test.reason is Reason.DISPUTED_CONTACT:
        facts = changed(facts, range_height_m=2.0)
    if test.reason is Reason.HARD_CONTACT:
        facts = _jolted(facts)
    hold_s = test.hold_s(facts, CONFIG)
    decision, ticks = first_decision(phase, facts, hold_s + 1.0)
    assert decision is not None
    assert decision[0] is event
    assert decision[1].reason is test.reason
    assert ticks == math.ceil(hold_s * 1e9 / TICK_NS - 1e-9)


@pytest.mark.parametrize(
    ("phase", "limit_s"),
    [
        (Phase.CHASE, CONFIG.chase.time_limit_s),
        (Phase.ALIGN, CONFIG.descent.alignment.time_limit_s),
        (Phase.DESCEND, CONFIG.descent.time_limit_s),
        (Phase.TAKEOFF, CONFIG.takeoff.time_limit_s),
    ],
)
def test_time_limit_is_kept(phase: Phase, limit_s: float) -> None:
    facts = situation(HIGH_M, 0.3)
    assert decided(progress(phase, limit_s - 0.01), facts, {}) is None or phase is Phase.CHASE
    late = decided(progress(phase, limit_s + 0.01), facts, {})
    assert late is not None
    assert late[0] is Event.TIME_LIMIT


def test_time_limit_does_not_end_a_landing_that_is_committed() -> None:
    late = progress(Phase.DESCEND, CONFIG.descent.time_limit_s + 1.0)
    low_m, high_m = 0.5 * CONFIG.descent.commit_height_m, 1.1 * CONFIG.descent.commit_height_m
    assert decided(late, situation(low_m), {}) is None
    assert decided(late, situation(high_m), {}) == (Event.TIME_LIMIT, Cause(Reason.DESCENT_TOO_LONG, (30.0,)))


@given(
    phase=st.sampled_from(FLYING),
    reason=st.sampled_from(list(UNSAFE)),
    in_phase_s=st.floats(0.0, 100.0),
)
def test_pilot_comes_before_everything(phase: Phase, reason: Reason, in_phase_s: float) -> None:
    facts = UNSAFE[reason]
    facts = replace(facts, autopilot=replace(facts.autopilot, in_control=False))
    held = {test.reason: NOW_NS - 10**12 for test in ABORTS}
    decision = decided(progress(phase, in_phase_s), facts, held)
    assert decision == (Event.PILOT_TOOK_OVER, Cause(Reason.MODE_CHANGED))


def test_mode_that_the_autopilot_changed_by_itself_is_not_said_to_be_the_pilots() -> None:
    facts = situation(HIGH_M)
    facts = replace(facts, autopilot=replace(facts.autopilot, in_control=False, overruled=True))
    assert decided(progress(Phase.ALIGN), facts, {}) == (Event.PILOT_TOOK_OVER, Cause(Reason.AUTOPILOT_FAILSAFE))


def test_restart_is_not_said_to_be_the_pilots() -> None:
    facts = situation(HIGH_M)
    facts = replace(facts, autopilot=replace(facts.autopilot, in_control=False, armed=False, restarted=True))
    assert decided(progress(Phase.ALIGN), facts, {}) == (Event.PILOT_TOOK_OVER, Cause(Reason.AUTOPILOT_RESTARTED))


def test_retries_are_counted_down_to_a_hold() -> None:
    high = situation(CONFIG.abort.height_m)
    for retries in range(CONFIG.abort.retries_max):
        decision = decided(replace(progress(Phase.ABORT), retries=retries), high, LONG_HEARD)
        assert decision == (Event.CLEAR, Cause(Reason.RETRY, (retries + 1, CONFIG.abort.retries_max)))
    last = replace(progress(Phase.ABORT), retries=CONFIG.abort.retries_max)
    assert decided(last, high, LONG_HEARD) == (Event.CLEAR_TO_HOLD, Cause(Reason.NO_RETRY_LEFT))


def test_bounce_is_seen_above_its_height_only() -> None:
    facts = situation(CONFIG.touchdown.lost.height_m - 0.01)
    assert decided(progress(Phase.TOUCHDOWN), facts, {}) is None
    decision = decided(progress(Phase.TOUCHDOWN), situation(CONFIG.touchdown.lost.height_m + 0.01), {})
    assert decision is not None
    assert decision[0] is Event.CONTACT_LOST


def test_drone_that_stays_above_the_pad_after_contact_has_left_it() -> None:
    height_m = CONFIG.touchdown.height_max_m + 0.01
    decision, ticks = first_decision(Phase.TOUCHDOWN, situation(height_m), CONFIG.touchdown.lost.hold_s + 1.0)
    assert decision is not None
    assert decision[1].reason is Reason.ABOVE_AFTER_CONTACT
    assert sentence(decision[1]) == "0.4 m above the pad after contact"
    assert ticks == math.ceil(CONFIG.touchdown.lost.hold_s * 1e9 / TICK_NS - 1e-9)


def test_drone_that_slid_off_the_pad_is_not_pressed_down_any_longer() -> None:
    lowest_m = -CONFIG.descent.sink.press_depth_m - CONFIG.touchdown.height_max_m
    assert decided(progress(Phase.TOUCHDOWN), situation(lowest_m + 0.01), {}) is None
    decision = decided(progress(Phase.TOUCHDOWN), situation(lowest_m - 0.01, 2.0), {})
    assert decision == (Event.CONTACT_LOST, Cause(Reason.BELOW_AFTER_CONTACT))


def test_pad_that_was_not_described_is_not_landed_on_and_it_is_said_why() -> None:
    facts = situation(pad=replace(pad_at(), unplaced=NOT_DESCRIBED))
    late = progress(Phase.ALIGN, CONFIG.descent.alignment.time_limit_s + 1.0)
    aligned = {Reason.ALIGNED: NOW_NS - 10**12}
    held = update_held(aligned, Phase.ALIGN, facts, CONFIG)
    assert Reason.ALIGNED not in held
    assert decided(late, facts, held) == (Event.TIME_LIMIT, NOT_DESCRIBED)
