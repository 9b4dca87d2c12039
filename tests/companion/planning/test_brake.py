import numpy as np
import pytest

from companion.planning.brake import brake
from companion.planning.guidance import PlanResult, PlanStatus
from link.records import replace
from tests.companion.planning.cases import LIMITS, request_of, state_at, straight, target_of

STATE = state_at((3.0, -2.0, 6.0), (9.0, -4.0, -1.2), (2.0, 1.0, -1.0))


def braked(velocity: tuple[float, float, float], dt_s: float = 0.02) -> PlanResult:
    return brake(request_of(STATE, target_of(straight((0, 0, 0), velocity)), dt_s=dt_s), PlanStatus.FAILED, 3)


def test_the_fallback_matches_the_target_horizontally() -> None:
    path = braked((7.0, 1.0, -0.4)).trajectory
    np.testing.assert_allclose(path.velocity_enu_m_s[-1], [7.0, 1.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(path.acceleration_enu_m_s2[-1], 0.0, atol=1e-9)


def test_the_fallback_climbs_with_a_climbing_target() -> None:
    assert braked((0.0, 0.0, 0.3)).trajectory.velocity_enu_m_s[-1, 2] == pytest.approx(0.3)


def test_the_fallback_without_a_finite_target_comes_to_rest() -> None:
    target = target_of(straight((0, 0, 0), (np.nan, 1.0, 0.0)))
    path = brake(request_of(STATE, target), PlanStatus.FAILED, 0).trajectory
    np.testing.assert_allclose(path.velocity_enu_m_s[-1], 0.0, atol=1e-9)


def test_the_fallback_says_why_it_brakes() -> None:
    result = braked((0.0, 0.0, 0.0))
    assert (result.status, result.iterations) == (PlanStatus.FAILED, 3)


def test_the_fallback_stays_inside_acceleration_and_jerk() -> None:
    state, jerks, pushes = STATE, [], []
    target = target_of(straight((0, 0, 0), (0.0, 0.0, 0.0)))
    for _ in range(200):
        after = brake(request_of(state, target), PlanStatus.FAILED, 0).next_state
        jerks.append((after.acceleration_enu_m_s2 - state.acceleration_enu_m_s2) / 0.02)
        pushes.append(after.acceleration_enu_m_s2)
        state = after
    jerk, push = np.array(jerks), np.array(pushes)
    assert np.hypot(jerk[:, 0], jerk[:, 1]).max() <= LIMITS.jerk_max_m_s3 + 1e-6
    assert np.abs(jerk[:, 2]).max() <= LIMITS.vertical_jerk_max_m_s3 + 1e-6
    assert np.hypot(push[:, 0], push[:, 1]).max() <= LIMITS.acceleration_max_m_s2 + 1e-9
    assert np.abs(push[:, 2]).max() <= LIMITS.vertical_acceleration_max_m_s2 + 1e-9
    np.testing.assert_allclose(state.velocity_enu_m_s, 0.0, atol=1e-6)


def test_the_next_state_lies_on_the_trajectory() -> None:
    result = braked((1.0, 2.0, 0.0), dt_s=0.1)
    np.testing.assert_allclose(result.next_state.position_enu_m, result.trajectory.position_enu_m[1], atol=1e-12)


def test_the_fallback_starts_at_the_state() -> None:
    path = brake(replace(request_of(STATE, target_of(straight((0, 0, 0), (0, 0, 0))))), PlanStatus.FAILED, 0).trajectory
    np.testing.assert_array_equal(path.position_enu_m[0], STATE.position_enu_m)
    np.testing.assert_allclose(path.velocity_enu_m_s[0], STATE.velocity_enu_m_s)
