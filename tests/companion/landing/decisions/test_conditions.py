"""Each condition at its boundary: what makes it true, and for how long it has to hold."""

import pytest

from companion.core.data import Rival
from companion.core.reasons import Reason
from companion.landing.decisions.conditions import (
    AUTOPILOT_SILENT,
    HEARD,
    HELD_UP,
    LIFTED,
    MISSED,
    SILENCES,
    STOPPED_BY_PAD,
    TOUCHED,
    TOUCHED_BY_DISPUTE,
    VEHICLE_SILENT,
    Condition,
    cause_of,
    first_cause,
    holds,
    is_below_pad,
    is_drone_unknown,
    is_fix_old,
    is_vehicle_taken,
    tell_taken,
)
from companion.landing.decisions.contact_trial import trial_press
from companion.situation.phases import LANDING_PHASES, Phase
from companion.situation.situation import Situation
from link.records import replace
from tests.companion.facts import CONFIG, NOW_NS, changed, drone_at, pad_at, reference_at, situation
from tests.companion.world import configured

TOUCHDOWN = CONFIG.touchdown
SINK = CONFIG.descent.sink
UNSEEN = configured({"silent_vehicle": {}})
MS = 1_000_000


def on_pad() -> Situation:
    """Standing on the pad, the setpoint sunk into it."""
    return changed(situation(0.0, 0.1), reference=reference_at(-0.3), range_height_m=0.01)


def jolted(jolt_m_s2: float | None, height_m: float = 0.1) -> Situation:
    return replace(situation(), drone=replace(drone_at(height_m, pad=pad_at()), jolt_m_s2=jolt_m_s2))


@pytest.mark.parametrize(
    ("facts", "expected"),
    [
        (changed(situation(), fix_age_s=CONFIG.abort.fix_age_max_s - 0.01), False),
        (changed(situation(), fix_age_s=CONFIG.abort.fix_age_max_s + 0.01), True),
        (changed(situation(), fix_age_s=None), True),
        (replace(situation(), pad=None), True),
    ],
    ids=["fresh", "old", "never heard", "pad unknown"],
)
def test_vehicle_that_has_told_nothing_for_too_long_is_silent(facts: Situation, *, expected: bool) -> None:
    assert is_fix_old(facts, CONFIG) is expected
    assert VEHICLE_SILENT.is_true(facts, CONFIG) is expected
    assert HEARD.is_true(facts, CONFIG) is (not expected)
    assert not VEHICLE_SILENT.is_true(facts, UNSEEN)  # one that never tells anything has to be seen instead


def test_autopilot_is_silent_of_the_place_or_of_the_attitude() -> None:
    drone = drone_at(1.5, pad=pad_at())
    for facts, silent in (
        (situation(), []),
        (replace(situation(), drone=None), [Reason.OWN_POSITION_OLD]),
        (replace(situation(), drone=replace(drone, attitude_known=False)), [Reason.OWN_ATTITUDE_OLD]),
    ):
        assert [one.reason for one in AUTOPILOT_SILENT if one.is_true(facts, CONFIG)] == silent
        assert is_drone_unknown(facts, CONFIG) is (facts.drone is None)
        assert HEARD.is_true(facts, CONFIG) is (not silent)


@pytest.mark.parametrize("silence", SILENCES, ids=lambda one: one.reason.name)
def test_approach_goes_on_after_a_silence(silence: Condition) -> None:
    assert silence.is_outage
    assert silence.phases == LANDING_PHASES
    assert silence.hold_s(situation(), CONFIG) == 0.0


def test_vehicle_is_taken_by_another_drone_and_not_by_this_ones_second_companion() -> None:
    assert not is_vehicle_taken(situation(), CONFIG)
    assert not is_vehicle_taken(changed(situation(), rival=Rival(drone="drone", is_this_drone=True)), CONFIG)
    taken = changed(situation(), rival=Rival(drone="drone2", is_this_drone=False))
    assert is_vehicle_taken(taken, CONFIG)
    assert tell_taken(taken, CONFIG).values == ("drone2",)


@pytest.mark.parametrize(
    ("facts", "expected"),
    [
        (jolted(TOUCHDOWN.jolt_m_s2 + 0.1), True),
        (jolted(TOUCHDOWN.jolt_m_s2 - 0.1), False),
        (jolted(None), False),
        (jolted(2.0 * TOUCHDOWN.jolt_m_s2, height_m=1.0), False),
        (replace(situation(), drone=None), False),
    ],
    ids=["jolt", "weaker", "none told", "in the air", "unknown"],
)
def test_jolt_at_the_pads_place_is_a_hard_contact(facts: Situation, *, expected: bool) -> None:
    assert STOPPED_BY_PAD.is_true(facts, CONFIG) is expected
    assert STOPPED_BY_PAD.hold_s(facts, CONFIG) == 0.0


def test_contact_that_the_range_finder_disputes_is_none_for_so_long() -> None:
    disputed = changed(on_pad(), range_height_m=TOUCHDOWN.range_finder.contact_height_max_m + 0.01)
    for facts, is_contact, is_disputed in (
        (on_pad(), True, True),
        (disputed, False, True),
        (situation(), False, False),
    ):
        assert TOUCHED.is_true(facts, CONFIG) is is_contact
        assert TOUCHED_BY_DISPUTE.is_true(facts, CONFIG) is is_disputed
    assert TOUCHED_BY_DISPUTE.hold_s(disputed, CONFIG) == TOUCHDOWN.range_finder.disputed_hold_s
    for condition in (TOUCHED, TOUCHED_BY_DISPUTE, STOPPED_BY_PAD):
        assert "m above the setpoint" in str(cause_of(condition, on_pad(), CONFIG).values)


@pytest.mark.parametrize(
    ("below_m", "is_below", "is_sunk"),
    [
        (TOUCHDOWN.lost.missed_depth_m - 0.01, False, False),
        (TOUCHDOWN.lost.missed_depth_m + 0.01, False, True),
        (SINK.press_depth_m + TOUCHDOWN.height_max_m - 0.01, False, True),
        (SINK.press_depth_m + TOUCHDOWN.height_max_m + 0.01, True, True),
    ],
)
def test_drone_below_its_pad_has_missed_it(below_m: float, *, is_below: bool, is_sunk: bool) -> None:
    below, sunk, *_ = MISSED
    facts = situation(-below_m)
    assert (below.is_true(facts, CONFIG), sunk.is_true(facts, CONFIG)) == (is_below, is_sunk)
    assert is_below_pad(facts, CONFIG) is is_below
    assert below.hold_s(facts, CONFIG) == 0.0
    assert sunk.hold_s(facts, CONFIG) == TOUCHDOWN.lost.missed_hold_s


def test_nothing_is_missed_or_left_where_the_drone_is_not_known() -> None:
    unknown = replace(situation(-2.0), drone=None)
    assert not any(one.is_true(unknown, CONFIG) for one in (*MISSED, LIFTED, HELD_UP))


@pytest.mark.parametrize(("height_m", "expected"), [(-0.01, False), (0.01, True)])
def test_drone_above_what_a_contact_is_believed_at_has_lifted(height_m: float, *, expected: bool) -> None:
    facts = situation(TOUCHDOWN.height_max_m + height_m)
    assert LIFTED.is_true(facts, CONFIG) is expected
    assert LIFTED.hold_s(facts, CONFIG) == TOUCHDOWN.lost.hold_s
    assert LIFTED.phases == HELD_UP.phases == {Phase.TOUCHDOWN}


@pytest.mark.parametrize(("more_m_s2", "expected"), [(-0.01, False), (0.01, True)])
def test_drone_that_is_pressed_down_and_falls_is_not_held_up(more_m_s2: float, *, expected: bool) -> None:
    up_m_s2 = more_m_s2 - TOUCHDOWN.falling_acceleration_m_s2
    facts = replace(situation(), drone=replace(drone_at(0.0, pad=pad_at()), acceleration_up_m_s2=up_m_s2))
    assert HELD_UP.is_true(facts, CONFIG) is expected
    assert HELD_UP.hold_s(facts, CONFIG) == TOUCHDOWN.stopped_hold_s


@pytest.mark.parametrize(("late_s", "age_s", "later_s"), [(0.0, 0.0, 0.0), (0.1, 0.05, 0.15), (0.1, -0.05, 0.1)])
def test_trial_waits_for_the_link_and_for_the_report(late_s: float, age_s: float, later_s: float) -> None:
    """Where the range finder sees nothing that the drone would fall onto softly."""
    still = changed(on_pad(), range_height_m=None, late_s=late_s)
    facts = replace(still, drone=replace(drone_at(0.0, 0.1, pad=pad_at()), age_s=age_s))
    pressed_s = TOUCHDOWN.pressed_speed_m_s / trial_press(facts, CONFIG)
    assert TOUCHED.hold_s(facts, CONFIG) == pytest.approx(pressed_s + later_s)


def test_press_is_weaker_over_a_link_that_is_later() -> None:
    high = changed(on_pad(), range_height_m=1.0)
    presses = [trial_press(changed(high, late_s=late_s), CONFIG) for late_s in (0.0, 0.2, 0.4)]
    assert presses == sorted(presses, reverse=True)
    assert len(set(presses)) == 3
    gone = replace(high, drone=None)
    assert trial_press(gone, CONFIG) == trial_press(replace(gone, pad=None), CONFIG)


def test_condition_holds_from_its_time_on() -> None:
    facts, hold_ns = situation(), round(LIFTED.hold_s(situation(), CONFIG) * 1e9)
    for since_ns, expected in ((NOW_NS - hold_ns, True), (NOW_NS - hold_ns + MS, False)):
        assert holds(LIFTED, {LIFTED.reason: since_ns}, facts, CONFIG) is expected
    assert not holds(LIFTED, {}, facts, CONFIG)


def test_first_of_those_that_hold_is_told() -> None:
    facts = replace(situation(), drone=None)
    held = {one.reason: NOW_NS for one in SILENCES}
    told = first_cause(SILENCES, held, facts, CONFIG)
    assert told is not None
    assert told.reason is SILENCES[0].reason
    held.pop(SILENCES[0].reason)
    assert first_cause(SILENCES, held, facts, CONFIG) == cause_of(SILENCES[1], facts, CONFIG)
    assert first_cause(SILENCES, {}, facts, CONFIG) is None


def test_road_below_a_drone_that_sinks_onto_its_pad_ends_the_landing_though_nothing_holds_it_up() -> None:
    (condition,) = (one for one in MISSED if one.reason is Reason.ROAD_BELOW)
    facts = changed(situation(0.3, 0.1, pad=replace(pad_at(), height_m=1.5)), range_height_m=1.8)
    assert condition.is_true(facts, CONFIG)
    assert condition.hold_s(facts, CONFIG) == TOUCHDOWN.range_finder.off_hold_s
    assert not condition.is_true(changed(facts, range_height_m=0.3), CONFIG)
