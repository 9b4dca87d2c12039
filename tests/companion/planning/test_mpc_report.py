import numpy as np
import pytest

from companion.config.planning import ReportMpcConfig, ReportReading
from companion.core.data import Array
from companion.planning.guidance import PlanStatus
from companion.planning.mpc_report import NUMBERS, STEP_S, ReportMpc, euler_predictions
from link.records import replace
from tests.companion.planning.cases import fly, request_of, state_at, straight, target_of

START = state_at((0.0, 0.0, 5.0))


def euler_rollout(x: Array, u: Array, steps: int) -> Array:
    """States (3, n) after each forward Euler step, the last input held."""
    path = []
    for k in range(steps):
        p, v, a = x
        x = np.array([p + v * STEP_S, v + a * STEP_S, a + u[min(k, len(u) - 1)] * STEP_S])
        path.append(x)
    return np.array(path).T


@pytest.mark.parametrize(("steps", "moves"), [(10, 2), (100, 20), (3, 3)])
def test_the_predictions_equal_an_euler_rollout(steps: int, moves: int) -> None:
    rng = np.random.default_rng(1)
    x, u = rng.normal(size=3), rng.normal(size=moves)
    free, forced = euler_predictions(steps, moves)
    np.testing.assert_allclose((free @ x + forced @ u).reshape(3, steps), euler_rollout(x, u, steps), atol=1e-12)


@pytest.mark.parametrize("reading", ReportReading)
def test_the_first_move_is_the_least_squares_one(reading: ReportReading) -> None:
    """numpy's least squares over the stacked weighed errors of a rollout, away from the road."""
    n, c = NUMBERS[reading], 1.0
    weights = np.sqrt([n.position_weight, n.velocity_weight, n.acceleration_weight])[:, None]
    target, x = np.array([2.0, 1.2 * 0.8, 0.0]), np.zeros(3)
    held = np.append(np.ones(n.control_steps - 1), n.prediction_steps - n.control_steps + c)

    def residuals(u: Array) -> Array:
        errors = weights * (euler_rollout(x, u, n.prediction_steps) - target[:, None])
        change = np.sqrt(n.change_weight) * np.diff(u, prepend=0.0)
        return np.concatenate((errors.ravel(), change, np.sqrt(n.input_weight * held) * u))

    zero = residuals(np.zeros(n.control_steps))
    jacobian = np.stack([residuals(unit) - zero for unit in np.eye(n.control_steps)], axis=1)
    best = np.linalg.lstsq(jacobian, -zero)[0]
    guidance = ReportMpc(ReportMpcConfig(reading=reading))
    motion = straight((2.0, 0.0, 5.0), (0.8, 0.0, 0.0))
    _, result = guidance.plan(None, request_of(START, target_of(motion), dt_s=STEP_S))
    assert result.next_state.acceleration_enu_m_s2[0] == pytest.approx(best[0] * STEP_S, rel=1e-6)


@pytest.mark.slow
def test_the_virtual_model_takes_forward_euler_steps() -> None:
    guidance = ReportMpc(ReportMpcConfig())
    state = state_at((0.0, 0.0, 5.0), (1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    _, result = guidance.plan(None, request_of(state, target_of(straight((1, 1, 1), (0, 0, 0))), dt_s=STEP_S))
    np.testing.assert_allclose(result.next_state.position_enu_m, [0.01, 0.02, 5.03])
    np.testing.assert_allclose(result.next_state.velocity_enu_m_s, [1.04, 2.05, 3.06])


@pytest.mark.slow
def test_only_with_the_velocity_factor_the_model_catches_up_with_a_moving_target() -> None:
    """The source report tells that without its factor of 1.2 the drone never caught up."""
    motion = straight((0.0, 0.0, 0.0), (5.0, 0.0, 0.0))
    lead = {
        factor: fly(ReportMpc(ReportMpcConfig(velocity_factor=factor)), motion, START, 6.0, dt_s=STEP_S).error[-1, 0]
        for factor in (1.0, 1.2)
    }
    assert lead[1.0] < -0.3
    assert lead[1.2] > 0.3


def test_the_road_is_not_flown_through() -> None:
    guidance = ReportMpc(ReportMpcConfig())
    flight = fly(guidance, straight((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), START, 6.0, dt_s=STEP_S)
    assert flight.position[:, 2].min() > -1e-4


def test_a_long_period_takes_several_steps_and_keeps_the_rest() -> None:
    guidance, motion = ReportMpc(ReportMpcConfig()), straight((3.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    memory, state = None, START
    for _ in range(4):
        memory, result = guidance.plan(memory, request_of(state, target_of(motion), dt_s=0.015))
        state = result.next_state
    fine = fly(guidance, motion, START, 0.06, dt_s=STEP_S)
    np.testing.assert_allclose(state.position_enu_m, fine.position[-1], atol=1e-12)


def test_a_period_shorter_than_a_step_keeps_the_state() -> None:
    guidance, motion = ReportMpc(ReportMpcConfig()), straight((3.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    _, result = guidance.plan(None, request_of(START, target_of(motion), dt_s=0.004))
    np.testing.assert_array_equal(result.next_state.position_enu_m, START.position_enu_m)
    assert result.trajectory.offset_s.tolist() == [0.0]


def test_a_target_with_nan_is_answered_by_braking() -> None:
    target = target_of(straight((3.0, 0.0, 1.0), (0.0, 0.0, 0.0)))
    broken = replace(target, velocity_enu_m_s=target.velocity_enu_m_s * np.nan)
    _, result = ReportMpc(ReportMpcConfig()).plan(None, request_of(START, broken, dt_s=STEP_S))
    assert result.status is PlanStatus.FAILED
    assert np.isfinite(result.next_state.position_enu_m).all()
