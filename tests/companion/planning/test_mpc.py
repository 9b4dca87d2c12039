import numpy as np
import pytest

from companion.config.planning import MpcConfig, SolverKind
from companion.core.data import Array
from companion.planning.guidance import PlanResult, PlanStatus, ReferenceState, Target
from companion.planning.mpc import Mpc
from link.records import replace
from tests.companion.planning.cases import (
    Motion,
    caught_s,
    circle,
    fly,
    request_of,
    state_at,
    state_on,
    straight,
    target_of,
)

MPC = Mpc(MpcConfig())
MEETING = straight((30.0, -40.0, 2.0), (7.0, 6.0, 0.2))
START = state_at((1.0, 2.0, 5.0), (3.0, -1.0, 0.4), (0.5, 0.7, -0.3))


def plan(state: ReferenceState, motion: Motion, floor_m: float = -1e3) -> PlanResult:
    return MPC.plan(None, request_of(state, target_of(motion), floor_m=floor_m))[1]


def stacked(result: PlanResult) -> Array:
    path = result.trajectory
    return np.stack((path.position_enu_m, path.velocity_enu_m_s, path.acceleration_enu_m_s2))


def test_a_far_target_is_caught_near_the_bang_bang_time() -> None:
    """Analytic bound without a jerk limit: 4 s to 20 m/s, 117.5 m at 5 m/s relative, 1 s of braking: 28.5 s."""
    flight = fly(MPC, straight((100.0, 0.0, 2.0), (15.0, 0.0, 0.0)), state_at((0.0, 0.0, 5.0)), 32.0)
    assert 28.0 < caught_s(flight) < 1.08 * 28.5


@pytest.mark.slow
@pytest.mark.parametrize("speed_m_s", [0.0, 5.0, 10.0])
def test_closing_in_from_50_m_behind_overshoots_less_than_10_cm(speed_m_s: float) -> None:
    flight = fly(MPC, straight((50.0, 0.0, 2.0), (speed_m_s, 0.0, 0.0)), state_at((0.0, 0.0, 5.0)), 14.0)
    assert flight.error[:, 0].max() < 0.10


def test_a_small_step_overshoots_less_than_a_tenth() -> None:
    flight = fly(MPC, straight((0.1, 0.0, 2.0), (0.0, 0.0, 0.0)), state_at((0.0, 0.0, 2.0)), 4.0)
    assert flight.error[:, 0].max() < 0.01


def test_a_target_at_constant_velocity_is_followed_without_error() -> None:
    flight = fly(MPC, MEETING, START, 16.0)
    assert np.abs(flight.error[-1]).max() < 1e-5
    assert np.abs(flight.rate[-1]).max() < 1e-5


@pytest.mark.parametrize(("radius_m", "speed_m_s"), [(16.5, 7.0), (16.5, 4.17), (20.0, 8.0)])
def test_a_known_circle_is_followed_within_2_mm(radius_m: float, speed_m_s: float) -> None:
    motion = circle(radius_m, speed_m_s)
    assert np.abs(fly(MPC, motion, state_on(motion), 8.0).error).max() < 0.002


def test_estimate_noise_of_5_cm_does_not_chatter() -> None:
    rng = np.random.default_rng(2)
    samples = 0.05 * rng.normal(size=(200, 3))
    motion = straight((0.0, 0.0, 2.0), (8.0, 0.0, 0.0))
    flight = fly(MPC, motion, state_on(motion), 20.0, noise_m=lambda t_s: samples[int(t_s * 10.0 + 1e-6)])
    assert np.sqrt((flight.acceleration**2).mean(axis=0)).max() < 0.13
    assert np.sqrt((flight.error**2).mean(axis=0)).max() < 0.025


def test_both_solvers_plan_the_same() -> None:
    other = Mpc(MpcConfig(solver=SolverKind.OSQP))
    request = request_of(START, target_of(MEETING), floor_m=1.0)
    np.testing.assert_allclose(stacked(other.plan(None, request)[1]), stacked(MPC.plan(None, request)[1]), atol=2e-3)


@pytest.mark.slow
def test_osqp_solves_every_plan_of_a_chase_at_its_limits() -> None:
    other = Mpc(MpcConfig(solver=SolverKind.OSQP))
    wanted = fly(MPC, MEETING, START, 2.0)
    np.testing.assert_allclose(fly(other, MEETING, START, 2.0).position, wanted.position, atol=1e-4)


def test_a_plan_depends_on_its_arguments_only() -> None:
    first = plan(START, MEETING)
    plan(state_at((0.0, 0.0, 0.0)), circle(16.5, 7.0))
    assert np.array_equal(stacked(first), stacked(plan(START, MEETING)))


def test_a_mirrored_scenario_is_planned_mirrored() -> None:
    mirror = np.array([1.0, -1.0, 1.0])
    state = replace(START, **{name: getattr(START, name) * mirror for name in ReferenceState.__struct_fields__})
    target = target_of(MEETING)
    mirrored = Target(
        offset_s=target.offset_s, **{n: getattr(target, n) * mirror for n in Target.__struct_fields__[1:]}
    )
    result = MPC.plan(None, request_of(state, mirrored))[1]
    np.testing.assert_allclose(stacked(result), stacked(plan(START, MEETING)) * mirror, atol=1e-6)


def test_a_turned_scenario_is_planned_turned() -> None:
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    state = replace(START, **{name: turn @ getattr(START, name) for name in ReferenceState.__struct_fields__})
    target = target_of(MEETING)
    turned = Target(offset_s=target.offset_s, **{n: getattr(target, n) @ turn.T for n in Target.__struct_fields__[1:]})
    result = MPC.plan(None, request_of(state, turned))[1]
    np.testing.assert_allclose(stacked(result), stacked(plan(START, MEETING)) @ turn.T, atol=1e-6)


def test_a_shifted_scenario_is_planned_shifted() -> None:
    shift = np.array([812.0, -455.0, 31.0])
    state = replace(START, position_enu_m=START.position_enu_m + shift)
    target = target_of(MEETING)
    shifted = replace(target, position_enu_m=target.position_enu_m + shift)
    result = MPC.plan(None, request_of(state, shifted, floor_m=1.0 + shift[2]))[1]
    wanted = stacked(plan(START, MEETING, floor_m=1.0))
    wanted[0] += shift
    np.testing.assert_allclose(stacked(result), wanted, atol=1e-6)


def test_the_trajectory_starts_at_the_state() -> None:
    path = plan(START, MEETING).trajectory
    assert path.offset_s[0] == 0.0
    np.testing.assert_allclose(path.position_enu_m[0], START.position_enu_m, atol=1e-9)
    np.testing.assert_allclose(path.velocity_enu_m_s[0], START.velocity_enu_m_s, atol=1e-9)


@pytest.mark.parametrize("field", Target.__struct_fields__[1:])
def test_a_target_with_nan_is_answered_by_braking(field: str) -> None:
    target = target_of(MEETING)
    broken = getattr(target, field).copy()
    broken[4, 1] = np.nan
    result = MPC.plan(None, request_of(START, replace(target, **{field: broken})))[1]
    assert result.status is PlanStatus.FAILED
    assert np.isfinite(stacked(result)).all()


def test_a_state_with_nan_is_replaced_by_the_last_planned_one() -> None:
    memory, first = MPC.plan(None, request_of(START, target_of(MEETING)))
    broken = state_at((np.nan, 0.0, 0.0))
    result = MPC.plan(memory, request_of(broken, target_of(MEETING)))[1]
    again = MPC.plan(None, request_of(first.next_state, target_of(MEETING)))[1]
    assert np.array_equal(stacked(result), stacked(again))


def test_a_first_state_with_nan_is_refused() -> None:
    with pytest.raises(ValueError, match="not finite"):
        MPC.plan(None, request_of(state_at((np.nan, 0.0, 0.0)), target_of(MEETING)))


def test_a_control_period_of_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="must be positive"):
        MPC.plan(None, request_of(START, target_of(MEETING), dt_s=0.0))


def test_two_half_periods_of_one_plan_agree_with_a_whole_one() -> None:
    half = MPC.plan(None, request_of(START, target_of(MEETING), dt_s=0.01))[1].next_state
    whole = MPC.plan(None, request_of(START, target_of(MEETING), dt_s=0.02))[1].next_state
    middle = 0.5 * (START.acceleration_enu_m_s2 + whole.acceleration_enu_m_s2)
    np.testing.assert_allclose(half.acceleration_enu_m_s2, middle, atol=1e-9)
