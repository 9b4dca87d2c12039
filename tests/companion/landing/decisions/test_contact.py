"""The signs of a contact: what agrees on the pad, and that nothing faulty alone cuts the motors in the air."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.landing.decisions.contact import Verdict, is_over_road, may_force_motors_off, verdict
from companion.landing.decisions.contact_signs import signs_of, signs_text
from companion.situation.situation import Situation
from companion.vehicle.pad_reach import over_pad_radius_m
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import CONFIG, GEAR_M, changed, drone_at, pad_at, reference_at, situation
from tests.companion.world import configured

TOUCHDOWN, DESCENT = CONFIG.touchdown, CONFIG.descent
ABSURD = st.one_of(st.floats(-1e6, 1e6), st.sampled_from([float("nan"), float("inf"), -float("inf"), 0.0, 1e30, -1e30]))
LONG_S = 1e3
OFF_M = TOUCHDOWN.range_finder.off_max_m
COMMIT_M = DESCENT.commit_height_m

# Everything that a step's facts are made of, each as one source that may fail.
SOURCES = (
    "own height",
    "own velocity",
    "own acceleration",
    "own place",
    "pad height",
    "pad velocity",
    "range finder",
    "autopilot's word",
    "setpoint",
)


@st.composite
def airborne(draw: st.DrawFn) -> Situation:
    """A drone in the air that follows its setpoint: what the setpoint has sunk ahead, the drone sinks towards."""
    height_m = draw(st.floats(TOUCHDOWN.height_max_m + 0.05, 30.0))
    beside_m = draw(st.floats(-5.0, 5.0))
    climb_m_s = draw(st.floats(-1.5, 1.5))
    follows = climb_m_s < -TOUCHDOWN.blocked_speed_m_s
    sunk_m = draw(st.floats(-1.0, 0.5 if follows else 0.9 * TOUCHDOWN.blocked_depth_m))
    relative: Vector3 = (0.0, 0.0, climb_m_s)
    drone = replace(
        drone_at(height_m, beside_m, relative, pad=pad_at()), acceleration_up_m_s2=draw(st.floats(-3.0, 3.0))
    )
    return changed(
        situation(),
        drone=drone,
        reference=reference_at(height_m - sunk_m),
        range_height_m=draw(st.one_of(st.none(), st.just(height_m))),
    )


def with_fault(facts: Situation, source: str, value: float) -> Situation:
    """The same with one source that says `value`."""
    drone, pad, reference = facts.drone, facts.pad, facts.following.reference
    assert drone is not None
    assert pad is not None
    assert reference is not None
    flat, up = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, value])
    aside = np.array([value, value, drone.position_enu_m[2]])
    faulty: dict[str, dict[str, Any]] = {
        "own height": {"drone": replace(drone, position_enu_m=drone.position_enu_m * flat + up)},
        "own velocity": {"drone": replace(drone, velocity_enu_m_s=drone.velocity_enu_m_s * flat + up)},
        "own acceleration": {"drone": replace(drone, acceleration_up_m_s2=value)},
        "own place": {"drone": replace(drone, position_enu_m=aside)},
        "pad height": {"pad": replace(pad, position_enu_m=pad.position_enu_m * flat + up)},
        "pad velocity": {"pad": replace(pad, velocity_enu_m_s=pad.velocity_enu_m_s * flat + up)},
        "range finder": {"range_height_m": value},
        "autopilot's word": {"autopilot": replace(facts.autopilot, landed=value > 0.0)},
        "setpoint": {"reference": replace(reference, position_enu_m=reference.position_enu_m * flat + up)},
    }
    return changed(facts, **faulty[source])


def on_pad() -> Situation:
    """Standing on the pad, the setpoint half sunk into it, the autopilot not believing it."""
    return changed(situation(0.0, 0.1), reference=reference_at(-0.5 * DESCENT.sink.press_depth_m), range_height_m=0.01)


@pytest.mark.slow
@settings(max_examples=200, deadline=None)
@given(facts=airborne(), source=st.sampled_from(SOURCES), value=ABSURD)
def test_no_single_faulty_source_makes_a_contact_in_the_air(facts: Situation, source: str, value: float) -> None:
    with np.errstate(all="ignore"):
        signs = signs_of(with_fault(facts, source, value), TOUCHDOWN)
        assert verdict(signs, CONFIG) is Verdict.AIRBORNE
        assert not may_force_motors_off(signs, LONG_S, CONFIG)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(facts=airborne(), source=st.sampled_from(SOURCES), data=st.data())
def test_no_source_stuck_at_what_it_says_on_the_pad_makes_a_contact_in_the_air(
    facts: Situation, source: str, data: st.DataObject
) -> None:
    # The most treacherous value is the one that a contact has; it is drawn from close around it.
    contact = {"own height": 1.5 + GEAR_M, "pad height": facts_height(facts), "setpoint": facts_height(facts) - 0.3}
    value = contact.get(source, 0.0) + data.draw(st.floats(-0.3, 0.3))
    signs = signs_of(with_fault(facts, source, value), TOUCHDOWN)
    assert verdict(signs, CONFIG) is Verdict.AIRBORNE
    assert not may_force_motors_off(signs, LONG_S, CONFIG)


def facts_height(facts: Situation) -> float:
    """The drone's height in W."""
    assert facts.drone is not None
    return float(facts.drone.position_enu_m[2])


def test_drone_that_stands_on_the_pad_is_in_contact_and_may_be_switched_off() -> None:
    signs = signs_of(on_pad(), TOUCHDOWN)
    assert verdict(signs, CONFIG) is Verdict.CONTACT
    assert may_force_motors_off(signs, 0.0, CONFIG)


@pytest.mark.parametrize(
    ("range_height_m", "descent_max_m_s", "expected"),
    [
        (0.2, 1.5, Verdict.AIRBORNE),
        (None, 1.5, Verdict.AIRBORNE),
        (0.05, 1.5, Verdict.CONTACT),
        (0.2, 3.0, Verdict.DISPUTED),
        (None, 3.0, Verdict.CONTACT),
    ],
)
def test_drone_that_sinks_as_fast_as_it_may_onto_a_deck_that_falls_as_fast_is_not_held_up(
    range_height_m: float | None, descent_max_m_s: float, expected: Verdict
) -> None:
    pad = pad_at((4.0, 1.0, -1.45))
    facts = replace(on_pad(), drone=drone_at(0.0, 0.1, pad=pad), pad=pad)
    limits = replace(CONFIG.limits.flight_limits(), descent_max_m_s=descent_max_m_s)
    signs = signs_of(changed(facts, limits=limits, range_height_m=range_height_m), TOUCHDOWN)
    assert verdict(signs, CONFIG) is expected


def test_drone_that_slides_off_the_pad_while_it_is_pressed_down_is_switched_off() -> None:
    facts = on_pad()
    beside = changed(facts, drone=drone_at(0.0, 2.0 * over_pad_radius_m(pad_at().half_width_m, CONFIG), pad=pad_at()))
    assert verdict(signs_of(beside, TOUCHDOWN), CONFIG) is Verdict.AIRBORNE
    assert may_force_motors_off(signs_of(beside, TOUCHDOWN), 0.0, CONFIG)
    assert not may_force_motors_off(signs_of(changed(beside, reference=reference_at(0.0)), TOUCHDOWN), 0.0, CONFIG)


@pytest.mark.parametrize(("lean_rate_hz", "expected"), [(0.0, Verdict.AIRBORNE), (-1.5, Verdict.CONTACT)])
def test_drone_that_the_pad_brings_upright_sinks_and_stands_on_its_lowest_foot(
    lean_rate_hz: float, expected: Verdict
) -> None:
    leaning = replace(drone_at(0.05, 0.1, (0.0, 0.0, -0.3), pad=pad_at()), lean=0.3, lean_rate_hz=lean_rate_hz)
    facts = changed(on_pad(), drone=leaning)
    assert verdict(signs_of(facts, TOUCHDOWN), CONFIG) is expected


@pytest.mark.parametrize(("sunk_m", "expected"), [(0.05, Verdict.AIRBORNE), (0.07, Verdict.CONTACT)])
@pytest.mark.parametrize("rides_m", [-0.1, 0.0, 0.1])
def test_setpoint_has_to_sink_beyond_how_the_drone_flew_on_it(rides_m: float, sunk_m: float, expected: Verdict) -> None:
    facts = changed(on_pad(), reference=reference_at(-rides_m - sunk_m), rides_m=rides_m)
    assert verdict(signs_of(facts, TOUCHDOWN), CONFIG) is expected


@pytest.mark.parametrize("landed", [None, False, True])
@pytest.mark.parametrize("range_height_m", [None, 0.05])
def test_range_finder_and_autopilots_word_are_not_needed(landed: bool | None, range_height_m: float | None) -> None:
    facts = on_pad()
    facts = changed(facts, range_height_m=range_height_m, autopilot=replace(facts.autopilot, landed=landed))
    assert verdict(signs_of(facts, TOUCHDOWN), CONFIG) is Verdict.CONTACT


def test_range_finder_that_sees_the_pad_far_below_puts_off_the_forced_disarm() -> None:
    signs = signs_of(changed(on_pad(), range_height_m=TOUCHDOWN.range_finder.contact_height_max_m + 0.01), TOUCHDOWN)
    assert verdict(signs, CONFIG) is Verdict.DISPUTED
    assert not may_force_motors_off(signs, TOUCHDOWN.range_finder.disputed_hold_s - 0.01, CONFIG)
    assert may_force_motors_off(signs, TOUCHDOWN.range_finder.disputed_hold_s, CONFIG)


@pytest.mark.parametrize(
    ("roof_m", "seen_m", "is_afloat", "expected"),
    [
        (1.5, 1.43, False, Verdict.AT_EDGE),
        (1.5, 1.5 + OFF_M - 0.01, False, Verdict.AT_EDGE),
        (1.5, 1.5 - OFF_M - 0.01, False, Verdict.DISPUTED),
        (1.5, 1.43, True, Verdict.DISPUTED),  # of water nothing is said
        (2.0 * OFF_M - 0.01, 2.0 * OFF_M - 0.01, False, Verdict.DISPUTED),  # so low a pad is mistaken for its road
        (1.5, 0.1, False, Verdict.CONTACT),
    ],
)
def test_range_finder_that_sees_the_road_beside_the_vehicle_says_where_the_drone_is(
    roof_m: float, seen_m: float, expected: Verdict, *, is_afloat: bool
) -> None:
    facts = changed(on_pad(), range_height_m=seen_m)
    assert facts.pad is not None
    pad = replace(facts.pad, height_m=roof_m, mounting=replace(facts.pad.mounting, is_afloat=is_afloat))
    signs = signs_of(replace(facts, pad=pad), TOUCHDOWN)
    assert verdict(signs, CONFIG) is expected
    assert may_force_motors_off(signs, LONG_S, CONFIG) is (expected is not Verdict.AT_EDGE)


@pytest.mark.parametrize(
    ("height_m", "beside_m", "seen_m", "expected"),
    [
        (COMMIT_M - 0.01, 0.1, 1.5 + COMMIT_M, True),
        (COMMIT_M + 0.01, 0.1, 1.5 + COMMIT_M, False),
        (-0.3, 0.1, 1.2, True),
        (0.2, 0.1, 1.7 - OFF_M - 0.01, False),  # a box under it, or a pad that is lower than it is said to be
        (0.2, 0.7, 1.7, False),  # the drone itself is beside the pad
        (0.2, 0.1, 0.2, False),
        (0.2, 0.1, None, False),
    ],
)
def test_drone_that_sinks_freely_with_the_road_below_it_where_the_pad_should_be_knows_it(
    height_m: float, beside_m: float, seen_m: float | None, *, expected: bool
) -> None:
    facts = changed(situation(height_m, beside_m, pad=replace(pad_at(), height_m=1.5)), range_height_m=seen_m)
    assert facts.drone is not None
    sinks = replace(facts.drone, velocity_enu_m_s=facts.drone.velocity_enu_m_s - np.array([0.0, 0.0, 0.4]))
    signs = signs_of(replace(facts, drone=sinks), TOUCHDOWN)
    assert verdict(signs, CONFIG) is Verdict.AIRBORNE
    assert is_over_road(signs, CONFIG) is expected


@pytest.mark.parametrize(
    ("climb_m_s", "range_height_m", "since_s", "is_forced"),
    [
        (0.4, 0.0, TOUCHDOWN.stopped_hold_s, True),
        (-0.4, 0.0, TOUCHDOWN.stopped_hold_s, True),
        (-0.4, 0.0, TOUCHDOWN.stopped_hold_s - 0.01, False),
        (-0.4, None, TOUCHDOWN.stopped_hold_s, False),
        (-0.4, TOUCHDOWN.range_finder.contact_height_max_m + 0.01, TOUCHDOWN.stopped_hold_s, False),
        (-TOUCHDOWN.pressed_speed_m_s - 0.01, 0.0, TOUCHDOWN.stopped_hold_s, False),
        (float("nan"), 0.0, TOUCHDOWN.stopped_hold_s, False),
    ],
    ids=["seems to climb", "seems to sink", "just touched", "no range finder", "sees nothing", "falls", "no number"],
)
def test_pressed_drone_whose_speeds_are_known_badly_is_switched_off_where_the_range_finder_sees_the_pad(
    climb_m_s: float, range_height_m: float | None, since_s: float, *, is_forced: bool
) -> None:
    drone = drone_at(0.0, 0.0, (0.0, 0.0, climb_m_s), pad=pad_at())
    signs = signs_of(changed(on_pad(), drone=drone, range_height_m=range_height_m), TOUCHDOWN)
    assert verdict(signs, CONFIG) is Verdict.AIRBORNE
    assert may_force_motors_off(signs, since_s, CONFIG) is is_forced
    assert not may_force_motors_off(signs, since_s, configured({"setpoints": {"position_only": True}}))


@pytest.mark.parametrize(
    "facts",
    [
        replace(on_pad(), drone=drone_at(CONFIG.touchdown.height_max_m + 0.01, pad=pad_at())),
        replace(on_pad(), drone=drone_at(0.0, over_pad_radius_m(pad_at().half_width_m, CONFIG) + 0.01, pad=pad_at())),
        replace(on_pad(), drone=drone_at(0.0, 0.0, (0.0, 0.0, -TOUCHDOWN.blocked_speed_m_s - 0.01), pad=pad_at())),
        replace(
            on_pad(),
            drone=replace(
                drone_at(0.0, pad=pad_at()), acceleration_up_m_s2=-TOUCHDOWN.falling_acceleration_m_s2 - 0.01
            ),
        ),
        changed(on_pad(), reference=reference_at(0.0)),
        replace(on_pad(), drone=None),
        replace(on_pad(), pad=None),
        replace(on_pad(), pad=pad_at(placed=False)),
    ],
    ids=["too high", "beside", "sinking", "falling", "setpoint above", "own unknown", "pad unknown", "heading unknown"],
)
def test_contact_lacks_one_of_its_signs(facts: Situation) -> None:
    assert verdict(signs_of(facts, TOUCHDOWN), CONFIG) is Verdict.AIRBORNE


def test_drone_as_deep_below_the_pad_as_no_press_brings_it_is_in_no_contact() -> None:
    deepest_m = DESCENT.sink.press_depth_m + TOUCHDOWN.height_max_m
    for depth_m, expected in ((deepest_m - 0.01, Verdict.CONTACT), (deepest_m + 0.01, Verdict.AIRBORNE)):
        facts = changed(on_pad(), drone=drone_at(-depth_m, pad=pad_at()), reference=reference_at(-depth_m - 0.3))
        assert verdict(signs_of(facts, TOUCHDOWN), CONFIG) is expected


@pytest.mark.parametrize(
    ("sunk_m", "landed", "expected"), [(0.05, False, False), (0.07, False, True), (0.05, True, True)]
)
def test_setpoint_far_enough_below_or_the_autopilots_word_supports_a_contact(
    sunk_m: float, landed: bool, *, expected: bool
) -> None:
    facts = changed(on_pad(), reference=reference_at(-sunk_m))
    facts = replace(facts, autopilot=replace(facts.autopilot, landed=landed))
    assert (verdict(signs_of(facts, TOUCHDOWN), CONFIG) is Verdict.CONTACT) is expected


def test_forced_disarm_after_a_stop_by_the_pad_asks_for_its_height_and_nothing_else() -> None:
    moving = drone_at(DESCENT.commit_height_m - 0.01, 3.0, (0.0, 0.0, -2.0), pad=pad_at())
    higher = replace(moving, position_enu_m=moving.position_enu_m + np.array([0.0, 0.0, 0.02]))
    for drone, pad, expected in ((moving, pad_at(), True), (higher, pad_at(), False), (moving, None, False)):
        signs = signs_of(replace(on_pad(), drone=drone, pad=pad), TOUCHDOWN)
        assert may_force_motors_off(signs, 0.0, CONFIG, stopped_and_held=True) is expected


def test_decision_is_described_by_its_signs() -> None:
    assert signs_text(signs_of(on_pad(), TOUCHDOWN)) == (
        "0.00 m over the pad, 0.25 m above the setpoint, 0.00 m/s up, 0.01 m by range finder, autopilot not landed"
    )
    drone = replace(drone_at(-0.02, 0.0, (0.0, 0.0, 0.11), pad=pad_at()), acceleration_up_m_s2=-0.25)
    facts = replace(on_pad(), drone=drone, autopilot=replace(on_pad().autopilot, landed=True))
    assert "0.11 m/s up, -0.25 m/s^2 up, 0.01 m by range finder, autopilot landed" in signs_text(
        signs_of(facts, TOUCHDOWN)
    )
    unknown = replace(on_pad(), drone=None, autopilot=replace(on_pad().autopilot, landed=None))
    assert signs_text(signs_of(unknown, TOUCHDOWN)) == "0.01 m by range finder"


def test_description_has_no_minus_before_a_zero() -> None:
    text = signs_text(replace(signs_of(on_pad(), TOUCHDOWN), range_height_m=-0.001, climb_m_s=-0.014))
    assert "-0.01 m/s up, " in text
    assert ", 0.00 m by range finder" in text
