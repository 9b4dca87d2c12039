"""When a vehicle that drives past is chased, and which vehicle stands."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_trapezoid, trapezoid

from companion.core.reasons import Cause, Reason
from companion.landing.decisions.entries import update_held
from companion.landing.decisions.passing import vehicle_passes, why_not_chased
from companion.landing.outputs import landing_status
from companion.landing.state.memory import Held, StepMemory
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation, vehicle_stands
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    TICK_NS,
    changed,
    drone_at,
    first_decision,
    later,
    pad_at,
    progress,
    situation,
)

HIGH_M = CONFIG.descent.alignment.height_m


def test_vehicle_that_stands_is_not_taken_for_one_that_passes() -> None:
    standing = situation(3.0, 2.0, pad=pad_at((0.2, 0.0, 0.0)))
    assert vehicle_passes(standing, CONFIG) is None
    decision, _ = first_decision(Phase.WAITING, standing, CONFIG.chase.parked_wait_s - 0.1)
    assert decision is None


def test_vehicle_is_chased_once_it_has_driven_for_the_hold_time_and_not_for_a_jump_of_its_estimate() -> None:
    passing = situation(HIGH_M, 2.0, pad=pad_at((4.0, 1.0, 0.0)))
    hold_s = CONFIG.chase.driving_hold_s
    jumped, _ = first_decision(Phase.WAITING, passing, hold_s - 2.0 * TICK_NS * 1e-9)
    assert jumped is None
    decision, ticks = first_decision(Phase.WAITING, passing, hold_s + 1.0)
    assert decision is not None
    assert decision[0] is Event.VEHICLE_PASSES
    assert ticks == math.ceil(hold_s * 1e9 / TICK_NS - 1e-9)


def test_vehicle_that_stands_far_away_is_not_chased() -> None:
    far = situation(3.0, CONFIG.chase.passing_distance_m + 0.1, pad=pad_at((0.0, 0.0, 0.0)))
    decision, _ = first_decision(Phase.WAITING, far, 2.0 * CONFIG.chase.parked_wait_s)
    assert decision is None


def _vehicle_gains_m(speed_m_s: float, acceleration_max_m_s2: float = 5.0) -> float:
    """How much farther a vehicle gets than a drone that comes from rest to its speed by a ramp, a hold and a ramp."""
    most_m_s2 = 0.7 * acceleration_max_m_s2
    jerk_m_s3 = 0.7 * CONFIG.limits.jerk_max_m_s3
    ramp_s = most_m_s2 / jerk_m_s3
    end_s = speed_m_s / most_m_s2 + ramp_s
    t_s = np.linspace(0.0, end_s, 4001)
    acceleration = jerk_m_s3 * np.minimum(np.minimum(t_s, ramp_s), end_s - t_s)
    speed = cumulative_trapezoid(acceleration, t_s, initial=0)
    return speed_m_s * end_s - float(trapezoid(speed, t_s))


@given(
    speed_m_s=st.floats(1.0, 20.0),
    course_rad=st.floats(-math.pi, math.pi),
    beside_m=st.floats(-0.9, 0.9),
    height_m=st.floats(HIGH_M, 10.0),
)
@settings(max_examples=100, deadline=None)
def test_chase_starts_when_a_drone_that_accelerates_meets_the_vehicle(
    speed_m_s: float, course_rad: float, beside_m: float, height_m: float
) -> None:
    lead_m = _vehicle_gains_m(speed_m_s)
    along = np.array([math.cos(course_rad), math.sin(course_rad), 0.0])
    across = np.array([-along[1], along[0], 0.0])
    velocity = (speed_m_s * along).tolist()
    pad = pad_at((velocity[0], velocity[1], 0.0))
    drone = drone_at(height_m, pad=pad)

    def passes(to_go_m: float) -> bool:
        offset = to_go_m * along + beside_m * CONFIG.chase.passing_distance_m * across
        there = replace(drone, position_enu_m=drone.position_enu_m + offset)
        return vehicle_passes(replace(situation(pad=pad), drone=there), CONFIG) is not None

    assert not passes(lead_m + 0.05)
    assert passes(lead_m - 0.05)
    assert passes(0.0)
    # One that is past is caught up with while the drone can fly so much faster.
    faster_m_s = min(CONFIG.limits.speed_max_m_s - speed_m_s, CONFIG.chase.catch_up_speed_m_s)
    past_m = max(CONFIG.chase.catch_up_s * faster_m_s, CONFIG.chase.passing_distance_m)
    assert passes(-past_m + 0.05)
    assert not passes(-past_m - 0.05)


@pytest.mark.parametrize("acceleration_max_m_s2", [2.1, 5.0, 6.3])
def test_chase_starts_early_enough_for_the_same_share_of_any_limit(acceleration_max_m_s2: float) -> None:
    limits = CONFIG.limits.model_copy(update={"acceleration_max_m_s2": acceleration_max_m_s2})
    config = CONFIG.model_copy(update={"limits": limits})
    lead_m, pad = _vehicle_gains_m(7.0, acceleration_max_m_s2), pad_at((7.0, 0.0, 0.0))
    drone = drone_at(HIGH_M, pad=pad)
    for to_go_m, is_chased in ((lead_m - 0.05, True), (lead_m + 0.05, False)):
        there = replace(drone, position_enu_m=drone.position_enu_m + np.array([to_go_m, 0.0, 0.0]))
        facts = replace(situation(pad=pad), drone=there, limits=None)
        assert (vehicle_passes(facts, config) is not None) is is_chased


def test_vehicle_that_is_past_is_let_go_by_the_limit_that_the_autopilot_lowers() -> None:
    pad = pad_at((10.0, 0.0, 0.0))
    behind = drone_at(HIGH_M, -20.0, pad=pad)
    facts = replace(situation(pad=pad), drone=behind)
    limits = CONFIG.limits.flight_limits()
    assert vehicle_passes(replace(facts, limits=limits), CONFIG) is not None
    assert vehicle_passes(replace(facts, limits=replace(limits, speed_max_m_s=11.6)), CONFIG) is None


def test_vehicle_that_passes_too_far_beside_is_not_chased() -> None:
    pad = pad_at((5.0, 0.0, 0.0))
    drone = drone_at(3.0, pad=pad)
    far_m = CONFIG.chase.passing_distance_m + 0.1
    beside = replace(drone, position_enu_m=drone.position_enu_m + np.array([0.0, far_m, 0.0]))
    assert vehicle_passes(replace(situation(pad=pad), drone=beside), CONFIG) is None


def test_drone_below_the_roof_does_not_begin_a_chase() -> None:
    assert vehicle_passes(situation(0.5), CONFIG) is None
    assert vehicle_passes(situation(HIGH_M), CONFIG) is not None


@pytest.mark.parametrize(
    ("speed_m_s", "std_m_s", "expected"),
    [
        (0.2, 0.1, True),
        (0.4, 0.1, False),
        (0.4, 0.5, True),
        (0.8, 0.5, False),
        (0.4, math.inf, False),
        (0.2, math.inf, True),
    ],
)
def test_vehicle_stands_as_far_as_its_speed_is_known(speed_m_s: float, std_m_s: float, *, expected: bool) -> None:
    facts = changed(situation(pad=pad_at((speed_m_s, 0.0, 0.0))), speed_std_m_s=std_m_s)
    assert vehicle_stands(facts, CONFIG.chase) is expected
    assert (Reason.VEHICLE_STANDS in update_held({}, Phase.WAITING, facts, CONFIG)) is expected
    assert (Reason.VEHICLE_DRIVES in update_held({}, Phase.WAITING, facts, CONFIG)) is not expected


def test_vehicle_that_is_not_known_does_not_stand() -> None:
    assert not vehicle_stands(replace(situation(), pad=None), CONFIG.chase)


def test_chase_starts_earlier_where_drag_leaves_little_of_the_tilt_limit() -> None:
    """30 degrees leave 4.8 m/s^2 for all, and at 8 m/s against the air less to go faster."""
    pad = pad_at((8.0, 0.0, 0.0))
    level = CONFIG.limits.flight_limits()
    drone = drone_at(HIGH_M, pad=pad)

    def lead_m(tilt_m_s2: float) -> float:
        limits = replace(level, tilt_acceleration_m_s2=tilt_m_s2)
        offsets_m = np.arange(0.0, 60.0, 0.25)
        places = (replace(drone, position_enu_m=drone.position_enu_m + np.array([m, 0.0, 0.0])) for m in offsets_m)
        passing = (replace(situation(pad=pad), drone=place, limits=limits) for place in places)
        return float(max(m for m, one in zip(offsets_m, passing, strict=True) if vehicle_passes(one, CONFIG)))

    assert lead_m(4.8) > lead_m(8.3) + 3.0
    assert lead_m(0.5) < 60.0 - 0.5


def _why(facts: Situation, held: Held | None = None) -> Cause | None:
    return why_not_chased(held or {}, facts, CONFIG)


@given(
    speed_m_s=st.floats(0.0, 24.0),
    course_rad=st.floats(-math.pi, math.pi),
    east_m=st.floats(-150.0, 150.0),
    north_m=st.floats(-150.0, 150.0),
)
@settings(max_examples=200, deadline=None)
def test_vehicle_is_chased_or_it_comes_yet_or_the_status_says_why_not(
    speed_m_s: float, course_rad: float, east_m: float, north_m: float
) -> None:
    velocity_m_s = speed_m_s * np.array([math.cos(course_rad), math.sin(course_rad)])
    pad = pad_at((float(velocity_m_s[0]), float(velocity_m_s[1]), 0.0))
    drone = drone_at(HIGH_M, pad=pad)
    there = replace(drone, position_enu_m=drone.position_enu_m + np.array([east_m, north_m, 0.0]))
    facts = replace(situation(pad=pad), drone=there)
    why, to_go_m_s = _why(facts), float(np.array([east_m, north_m]) @ velocity_m_s)
    if vehicle_passes(facts, CONFIG) is not None:
        assert why is None
    else:
        assert why is not None or to_go_m_s > 0.0


def test_status_says_how_far_beside_a_vehicle_passes_that_is_let_go() -> None:
    pad = pad_at((4.0, 3.0, 0.0))
    drone = drone_at(HIGH_M, pad=pad)
    across = np.array([-0.6, 0.8, 0.0])
    beside = replace(drone, position_enu_m=drone.position_enu_m + 21.5 * across - 30.0 * np.array([0.8, 0.6, 0.0]))
    cause = _why(replace(situation(pad=pad), drone=beside))
    assert cause is not None
    assert cause.reason is Reason.VEHICLE_PASSES_FAR
    assert cause.values == pytest.approx((21.5, CONFIG.chase.passing_distance_m))


def test_status_says_that_a_vehicle_stands_too_far_away_and_that_one_is_past() -> None:
    far_m = CONFIG.chase.passing_distance_m + 0.1
    far = _why(situation(3.0, far_m, pad=pad_at((0.0, 0.0, 0.0))))
    assert far is not None
    assert far.reason is Reason.VEHICLE_STANDS_FAR
    assert far.values == pytest.approx((far_m, CONFIG.chase.passing_distance_m))
    past = _why(situation(HIGH_M, -120.0, pad=pad_at((5.0, 0.0, 0.0))))
    assert past is not None
    assert past.reason is Reason.VEHICLE_IS_PAST
    assert past.values == pytest.approx((120.0,))


def test_status_counts_down_until_a_vehicle_that_stands_is_landed_on() -> None:
    facts = situation(3.0, 2.0, pad=pad_at((0.0, 0.0, 0.0)))
    held = update_held({}, Phase.WAITING, facts, CONFIG)
    left_s = [cause.values[0] for ticks in (0, 100) if (cause := _why(later(facts, ticks * TICK_NS), held))]
    assert left_s == pytest.approx([CONFIG.chase.parked_wait_s, CONFIG.chase.parked_wait_s - 2.0])


def test_status_says_while_the_drone_waits_that_the_vehicle_has_fallen_silent() -> None:
    silent = changed(situation(HIGH_M), fix_age_s=CONFIG.abort.fix_age_max_s + 0.1)
    assert _why(silent) == Cause(Reason.VEHICLE_DATA_OLD)


def test_drone_that_waits_says_in_its_status_why_it_does_not_chase() -> None:
    far = situation(3.0, CONFIG.chase.passing_distance_m + 0.1, pad=pad_at((0.0, 0.0, 0.0)))
    memory = StepMemory(progress=progress(Phase.WAITING))
    assert landing_status(memory, far, CONFIG).reason_code == Reason.VEHICLE_STANDS_FAR.name
