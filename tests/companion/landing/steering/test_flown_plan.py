"""A plan as it is flown: where the virtual model is between two steps, and how it is kept up."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.response import Cascade, Shaping
from companion.core.data import Array
from companion.landing.state.step_data import StepOutputs
from companion.landing.steering.flown_plan import (
    asked_for,
    extrapolate,
    flown_plan,
    keep_up,
    limit_sink,
    state_at,
    state_in_plan,
)
from companion.planning.guidance import PlanResult, PlanStatus, ReferenceState, Trajectory
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.world import CONFIG, PAD_HEIGHT_M, Flight, KnownVehicle


def test_carried_is_the_closed_form_of_constant_acceleration() -> None:
    reference = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([4.0, 0.0, -1.0]),
        acceleration_enu_m_s2=np.array([2.0, 1.0, 0.0]),
    )
    later = extrapolate(reference, 0.05)
    np.testing.assert_allclose(later.position_enu_m, [1.0 + 0.2 + 0.0025, 2.0 + 0.00125, 3.0 - 0.05])
    np.testing.assert_allclose(later.velocity_enu_m_s, [4.1, 0.05, -1.0])
    np.testing.assert_allclose(extrapolate(later, -0.05).position_enu_m, reference.position_enu_m, atol=1e-12)


heights, rates, ups = st.floats(-3.0, 20.0), st.floats(-4.0, 4.0), st.floats(-10.0, 10.0)
durations = st.floats(0.1, 5.0)
BRAKES_M_S2 = 1.0  # ArduPilot's WPNAV_ACCEL_Z
LIMITS = CONFIG.limits.flight_limits()
GAINS = Cascade(position_per_s=0.95, velocity_per_s=1.8, integral_per_s2=0.4, lead_s=0.0, attitude_lag_s=0.3)
UNLIMITED = replace(LIMITS, climb_max_m_s=1e6, vertical_acceleration_max_m_s2=1e6)


def _carried(duration_s: float) -> Shaping:
    return Shaping(
        carried_s=duration_s,
        acceleration_m_s2=2.5,
        jerk_m_s3=5.0,
        vertical_acceleration_m_s2=BRAKES_M_S2,
        vertical_jerk_m_s3=5.0,
    )


def _moving(height_m: float, rate_m_s: float, up_m_s2: float) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array([1.0, 2.0, height_m]),
        velocity_enu_m_s=np.array([4.0, 0.0, rate_m_s]),
        acceleration_enu_m_s2=np.array([2.0, 1.0, up_m_s2]),
    )


@given(heights, rates, ups, durations)
def test_model_that_is_carried_on_and_then_brakes_ends_above_the_lowest_height(
    height_m: float, rate_m_s: float, up_m_s2: float, duration_s: float
) -> None:
    carried = extrapolate(
        limit_sink(_moving(height_m, rate_m_s, up_m_s2), 0.6, _carried(duration_s), UNLIMITED), duration_s
    )
    sinks_m_s = max(-float(carried.velocity_enu_m_s[2]), 0.0)
    assert carried.position_enu_m[2] - sinks_m_s**2 / (2.0 * BRAKES_M_S2) >= 0.6 - 1e-6


@given(heights, rates, ups, durations)
def test_model_that_ends_above_the_lowest_height_is_left_alone(
    height_m: float, rate_m_s: float, up_m_s2: float, duration_s: float
) -> None:
    reference = _moving(height_m, rate_m_s, up_m_s2)
    carried = extrapolate(reference, duration_s)
    sinks_m_s = max(-float(carried.velocity_enu_m_s[2]), 0.0)
    lowest_m = float(carried.position_enu_m[2]) - sinks_m_s * (sinks_m_s / BRAKES_M_S2 + BRAKES_M_S2 / 5.0) / 2.0 - 1e-6
    assert limit_sink(reference, lowest_m, _carried(duration_s), UNLIMITED) is reference


@given(heights, rates, ups, durations)
def test_nothing_but_the_acceleration_upwards_is_limited(
    height_m: float, rate_m_s: float, up_m_s2: float, duration_s: float
) -> None:
    reference = _moving(height_m, rate_m_s, up_m_s2)
    limited = limit_sink(reference, 0.6, _carried(duration_s), LIMITS)
    np.testing.assert_array_equal(limited.position_enu_m, reference.position_enu_m)
    np.testing.assert_array_equal(limited.velocity_enu_m_s, reference.velocity_enu_m_s)
    np.testing.assert_array_equal(limited.acceleration_enu_m_s2[:2], reference.acceleration_enu_m_s2[:2])
    assert limited.acceleration_enu_m_s2[2] >= up_m_s2


@given(heights, st.floats(-4.0, LIMITS.climb_max_m_s), ups, st.floats(0.1, 3.0))
def test_model_that_is_too_low_climbs_within_the_limits_however_short_it_is_carried_on(
    height_m: float, rate_m_s: float, up_m_s2: float, duration_s: float
) -> None:
    reference = _moving(height_m, rate_m_s, up_m_s2)
    limited = limit_sink(reference, 0.6, _carried(duration_s), LIMITS)
    if limited is not reference:
        assert limited.acceleration_enu_m_s2[2] <= LIMITS.vertical_acceleration_max_m_s2
        assert extrapolate(limited, duration_s).velocity_enu_m_s[2] <= LIMITS.climb_max_m_s + 1e-9


motions = st.tuples(rates, ups)


@given(heights, motions, motions, durations)
def test_next_state_that_is_kept_up_may_be_carried_on(
    height_m: float, planned: tuple[float, float], before: tuple[float, float], duration_s: float
) -> None:
    moved, start = _moving(height_m, *planned), _moving(height_m + 0.01, *before)
    kept_up = keep_up(moved, start, 0.6, _carried(duration_s), limits=UNLIMITED, elapsed_s=0.02)
    carried = extrapolate(kept_up, duration_s)
    sinks_m_s = max(-float(carried.velocity_enu_m_s[2]), 0.0)
    assert carried.position_enu_m[2] - sinks_m_s**2 / (2.0 * BRAKES_M_S2) >= 0.6 - 1e-6


def test_plan_of_an_autopilot_that_carries_nothing_on_is_flown_as_planned() -> None:
    sinking = _moving(0.1, -2.0, -3.0)
    following = state_at(flown_plan(_plan(sinking), PERIOD_S, 0.6, None, LIMITS), PERIOD_S)
    np.testing.assert_array_equal(following.acceleration_enu_m_s2, sinking.acceleration_enu_m_s2)


def _cubic(t_s: Array) -> Trajectory:
    """A motion of constant jerk, at `t_s` (n,)."""
    p, v, a, j = (np.array(one) for one in ([1.0, 2.0, 3.0], [4.0, -1.0, 0.3], [0.5, 2.0, -0.7], [3.0, -5.0, 1.0]))
    t = t_s[:, None]
    return Trajectory(
        offset_s=t_s,
        position_enu_m=p + v * t + a * t**2 / 2.0 + j * t**3 / 6.0,
        velocity_enu_m_s=v + a * t + j * t**2 / 2.0,
        acceleration_enu_m_s2=a + j * t,
    )


@pytest.mark.parametrize("offset_s", [0.0, 0.013, 0.11, 0.3, 0.37])
def test_model_between_two_instants_of_its_plan_is_the_motion_of_their_jerk(offset_s: float) -> None:
    model, truth = state_in_plan(_cubic(np.array([0.0, 0.02, 0.13, 0.3])), offset_s), _cubic(np.array([offset_s]))
    np.testing.assert_allclose(model.position_enu_m, truth.position_enu_m[0])
    np.testing.assert_allclose(model.velocity_enu_m_s, truth.velocity_enu_m_s[0])
    np.testing.assert_allclose(model.acceleration_enu_m_s2, truth.acceleration_enu_m_s2[0])


PERIOD_S = 0.02


def _plan(following: ReferenceState) -> PlanResult:
    return PlanResult(
        next_state=following,
        trajectory=_cubic(np.array([0.0, 0.1, 0.2, 0.4])),
        status=PlanStatus.SOLVED,
        limit_excess=0.0,
        iterations=1,
    )


@pytest.mark.parametrize("offset_s", [0.0, 0.013, PERIOD_S, 0.033, 0.13])
def test_model_between_two_steps_is_where_its_plan_leads(offset_s: float) -> None:
    following = state_in_plan(_cubic(np.array([0.0, PERIOD_S, 0.1])), PERIOD_S)
    model = state_at(flown_plan(_plan(following), PERIOD_S, 0.0, None, LIMITS), offset_s)
    truth = _cubic(np.array([offset_s]))
    np.testing.assert_allclose(model.position_enu_m, truth.position_enu_m[0])
    np.testing.assert_allclose(model.velocity_enu_m_s, truth.velocity_enu_m_s[0])
    np.testing.assert_allclose(model.acceleration_enu_m_s2, truth.acceleration_enu_m_s2[0])


def test_model_after_one_period_is_the_next_state_of_a_law_that_plans_no_instant_there() -> None:
    following = _moving(3.0, -1.0, 0.5)
    model = state_at(flown_plan(_plan(following), PERIOD_S, 0.0, None, LIMITS), PERIOD_S)
    np.testing.assert_array_equal(model.position_enu_m, following.position_enu_m)
    np.testing.assert_array_equal(model.acceleration_enu_m_s2, following.acceleration_enu_m_s2)


def _asked(cascade: Cascade, shaping: Shaping | None) -> ReferenceState:
    following = state_in_plan(_cubic(np.array([0.0, PERIOD_S, 0.1])), PERIOD_S)
    return asked_for(flown_plan(_plan(following), PERIOD_S, -1e4, shaping, LIMITS), cascade, PERIOD_S)


def test_led_acceleration_is_that_of_the_plan_and_its_jerk_over_the_lag() -> None:
    asked = _asked(replace(GAINS, is_led=True), None)
    now, ahead = _cubic(np.array([0.0, 0.3])).acceleration_enu_m_s2  # of a constant jerk
    np.testing.assert_allclose(asked.acceleration_enu_m_s2, [*ahead[:2], now[2]])
    np.testing.assert_allclose(asked.position_enu_m, _cubic(np.array([0.0])).position_enu_m[0])


def test_setpoint_that_is_carried_on_asks_for_the_mean_acceleration_until_the_next() -> None:
    asked = _asked(GAINS, _carried(1.0))
    start, end = _cubic(np.array([0.0, PERIOD_S])).acceleration_enu_m_s2
    np.testing.assert_allclose(asked.acceleration_enu_m_s2, 0.5 * (start + end))
    np.testing.assert_allclose(asked.velocity_enu_m_s, _cubic(np.array([0.0])).velocity_enu_m_s[0])


def test_setpoint_that_is_held_as_it_came_asks_for_the_acceleration_then() -> None:
    start = _cubic(np.array([0.0])).acceleration_enu_m_s2[0]
    np.testing.assert_allclose(_asked(GAINS, None).acceleration_enu_m_s2, start)


class LateFlight(Flight):
    """The companion's steps come later than every period, as over a link that loses the drone's reports."""

    late_ns = 20_000_000

    def step(self, command: Command | None = None) -> StepOutputs:
        outputs = super().step(command)
        self.t_ns += self.late_ns
        return outputs


@pytest.mark.slow
def test_chase_of_limited_jerk_swings_no_farther_past_the_pad_where_steps_come_late() -> None:
    """With the acceleration of one period for each step of two, half of the jerk would be left."""
    config = CONFIG.model_copy(
        update={"limits": CONFIG.limits.model_copy(update={"jerk_max_m_s3": 4.0, "vertical_jerk_max_m_s3": 4.0})}
    )
    vehicle = KnownVehicle((-40.0, 4.0, PAD_HEIGHT_M), (5.0, 0.0, 0.0))
    passed_m = []
    for kind in (Flight, LateFlight):
        flight = kind(vehicle=vehicle, config=config)
        flight.start_and_reach(Phase.CHASE)
        across_m = []
        while flight.phase in (Phase.CHASE, Phase.ALIGN):
            flight.step()
            across_m.append(vehicle.at(flight.own.t_ns)[1] - flight.own.position_enu_m[1])
        assert flight.phase is Phase.DESCEND
        passed_m.append(-min(across_m))
    assert passed_m[1] < passed_m[0] + 0.1
