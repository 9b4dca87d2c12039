"""The tests of the phases: each fires after its hold time and not before, and in the order of their weight."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.reasons import Cause, Reason, sentence
from companion.landing.decisions.aborts import ABORTS
from companion.landing.decisions.conditions import Condition
from companion.landing.decisions.entries import ENTRIES, update_held
from companion.situation.phases import Event, Phase
from companion.vehicle.pad import NOT_DESCRIBED, TURNS_ON_SPOT, PadPath
from companion.vehicle.pad_reach import cone_radius_m
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    LONG_HEARD,
    NOW_NS,
    TICK_NS,
    changed,
    decided,
    first_decision,
    pad_at,
    progress,
    reference_at,
    situation,
)
from tests.companion.landing.decisions.unsafe_facts import HALF_M, HIGH_M, UNSAFE, jolted
from tests.companion.world import FLYING


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
        case Event.OUT_OF_ALIGNMENT if test.reason is Reason.HEADING_LOST:
            facts = situation(HIGH_M, pad=pad_at(placed=False))
        case Event.OUT_OF_ALIGNMENT:
            facts = situation(pad=replace(pad_at(std_m=CONFIG.descent.unseen.std_max_m + 0.01), is_coarse=True))
        case _:
            facts = changed(situation(0.0), reference=reference_at(-CONFIG.touchdown.blocked_depth_m - 0.01))
    if test.reason is Reason.DISPUTED_CONTACT:
        facts = changed(facts, range_height_m=2.0)
    if test.reason is Reason.HARD_CONTACT:
        facts = jolted(facts)
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
    in_time = decided(progress(phase, limit_s - 0.01), facts, {})
    assert in_time is None or in_time[0] is not Event.TIME_LIMIT
    late = decided(progress(phase, limit_s + 0.01), facts, {})
    assert late is not None
    assert late[0] is Event.TIME_LIMIT


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN, Phase.DESCEND])
def test_a_drone_that_may_not_lean_as_the_turn_takes_says_so(phase: Phase) -> None:
    limits = replace(CONFIG.limits.flight_limits(), tilt_acceleration_m_s2=4.81)
    late = progress(phase, 61.0)
    for takes_m_s2, tells in ((4.9, phase is not Phase.DESCEND), (4.3, False)):
        facts = replace(changed(situation(HIGH_M, 0.3), takes_m_s2=takes_m_s2), limits=limits)
        decision = decided(late, facts, {})
        assert decision is not None
        assert decision[0] is Event.TIME_LIMIT
        assert (decision[1].reason is Reason.TILT_TOO_SMALL) is tells


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


@pytest.mark.parametrize("phase", FLYING)
def test_motors_that_are_killed_are_the_pilots_but_on_the_pad(phase: Phase) -> None:
    facts = situation(HIGH_M)
    facts = replace(facts, autopilot=replace(facts.autopilot, killed=True))
    killed = (Event.PILOT_TOOK_OVER, Cause(Reason.MOTORS_KILLED))
    assert (decided(progress(phase), facts, {}) == killed) is (phase is not Phase.TOUCHDOWN)


def test_restart_is_not_said_to_be_the_pilots() -> None:
    facts = situation(HIGH_M)
    facts = replace(facts, autopilot=replace(facts.autopilot, in_control=False, armed=False, restarted=True))
    assert decided(progress(Phase.ALIGN), facts, {}) == (Event.PILOT_TOOK_OVER, Cause(Reason.AUTOPILOT_RESTARTED))


def test_retries_are_counted_down_to_a_hold() -> None:
    high = situation(CONFIG.abort.height_m)
    for retries in range(CONFIG.abort.retries_max):
        decision = decided(replace(progress(Phase.ABORT), retries=retries), high, LONG_HEARD)
        assert decision == (Event.CLEAR, Cause(Reason.RETRY, (retries + 1, CONFIG.abort.retries_max)))
    last = replace(progress(Phase.ABORT), retries=CONFIG.abort.retries_max, cause=Cause(Reason.PAD_TO_BE_SEEN))
    given_up = Cause(Reason.NO_RETRY_LEFT, ("pad to be seen again",))
    assert decided(last, high, LONG_HEARD) == (Event.CLEAR_TO_HOLD, given_up)


def test_climb_over_a_deck_goes_on_until_the_drone_is_clear_of_the_waves_crest() -> None:
    facts = situation(CONFIG.abort.height_m)
    assert facts.pad is not None
    in_a_trough = replace(facts, pad=replace(facts.pad, crest_above_m=4.6))
    assert decided(progress(Phase.ABORT), in_a_trough, LONG_HEARD) is None
    clear = situation(CONFIG.abort.height_m + 4.6)
    clear = replace(clear, pad=in_a_trough.pad)
    decision = decided(progress(Phase.ABORT), clear, LONG_HEARD)
    assert decision is not None
    assert decision[0] is Event.CLEAR


VAGUE = pad_at(placed=False)


@pytest.mark.parametrize(
    ("pad", "reason"),
    [
        (pad_at((0.0, 0.0, 0.0), placed=False), Reason.HEADING_UNKNOWN),
        (replace(VAGUE, yaw_rad=None), Reason.HEADING_UNKNOWN),
        (replace(VAGUE, unplaced=NOT_DESCRIBED), Reason.PAD_NOT_DESCRIBED),
    ],
    ids=["stands", "unknown", "not described"],
)
def test_descent_onto_a_pad_that_no_drive_will_place_is_broken_off(pad: PadPath, reason: Reason) -> None:
    assert first_decision(Phase.DESCEND, situation(pad=pad), 1.0)[0] == (Event.UNSAFE, Cause(reason))


def test_heading_that_is_lost_below_the_commit_height_breaks_the_descent_off() -> None:
    low = situation(CONFIG.descent.commit_height_m - 0.01, pad=VAGUE)
    assert first_decision(Phase.DESCEND, low, 1.0)[0] == (Event.UNSAFE, Cause(Reason.HEADING_LOST))


@pytest.mark.parametrize(
    ("broke_off", "expected"),
    [
        (Reason.CONTACT_RISKY, (Event.CLEAR, Cause(Reason.RETRY, (1, CONFIG.abort.retries_max)))),
        (Reason.HEADING_LOST, (Event.CLEAR, Cause(Reason.RETRY, (1, CONFIG.abort.retries_max)))),
        (Reason.HEADING_UNKNOWN, (Event.CLEAR_TO_HOLD, Cause(Reason.HEADING_UNKNOWN))),
    ],
)
def test_climb_above_a_vague_heading_ends_in_a_hold_only_where_it_was_waited_for_in_vain(
    broke_off: Reason, expected: tuple[Event, Cause]
) -> None:
    climb = replace(progress(Phase.ABORT), cause=Cause(broke_off))
    assert decided(climb, situation(CONFIG.abort.height_m, pad=VAGUE), LONG_HEARD) == expected


TURNS = replace(pad_at((0.0, 0.0, 0.0)), yaw_rad=None, unplaced=TURNS_ON_SPOT)
TURNED_AWAY = Cause(Reason.TURNS_ON_SPOT)


def test_vehicle_that_turns_on_the_spot_is_waited_for_as_one_that_loses_its_heading_is() -> None:
    """Once it stands again, all is known."""
    commit_m = CONFIG.descent.commit_height_m
    high, low = situation(commit_m + 0.1, pad=TURNS), situation(commit_m - 0.01, pad=TURNS)
    aligns = (Event.OUT_OF_ALIGNMENT, Cause(Reason.HEADING_LOST))
    assert first_decision(Phase.DESCEND, high, 1.0)[0] == aligns
    assert first_decision(Phase.DESCEND, low, 1.0)[0] == (Event.UNSAFE, TURNED_AWAY)
    climb = replace(progress(Phase.ABORT), cause=TURNED_AWAY)
    again = (Event.CLEAR, Cause(Reason.RETRY, (1, CONFIG.abort.retries_max)))
    assert decided(climb, situation(CONFIG.abort.height_m, pad=TURNS), LONG_HEARD) == again
    late = decided(progress(Phase.ALIGN, CONFIG.descent.alignment.time_limit_s + 0.01), situation(pad=TURNS), {})
    assert late == (Event.TIME_LIMIT, TURNED_AWAY)


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
