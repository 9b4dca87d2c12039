import numpy as np
import pytest

from companion.config.planning import PnConfig
from companion.planning.guidance import PlanStatus
from companion.planning.pn import ProportionalNavigation, advance
from link.records import replace
from tests.companion.planning.cases import (
    LIMITS,
    caught_s,
    circle,
    fly,
    norm,
    request_of,
    state_at,
    straight,
    target_of,
)

PN = ProportionalNavigation(PnConfig())


@pytest.mark.slow
def test_a_fast_target_is_caught_and_followed_without_error() -> None:
    flight = fly(PN, straight((30.0, -40.0, 2.0), (7.0, 6.0, 0.0)), state_at((0.0, 0.0, 5.0)), 16.0)
    assert caught_s(flight) < 11.0
    assert np.abs(flight.error[-1]).max() < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("speed_m_s", [4.0, 7.0])
def test_a_circle_is_joined_within_the_limits(speed_m_s: float) -> None:
    flight = fly(PN, circle(16.5, speed_m_s), state_at((40.0, -10.0, 5.0)), 12.0)
    assert caught_s(flight) < 12.0
    assert norm(flight.velocity).max() <= 1.001 * LIMITS.speed_max_m_s
    assert norm(flight.acceleration).max() <= LIMITS.acceleration_max_m_s2 + 1e-9
    assert norm(flight.jerk).max() <= LIMITS.jerk_max_m_s3 + 1e-6
    assert -flight.velocity[:, 2].min() <= LIMITS.descent_max_m_s + 1e-3


def test_far_away_the_push_across_the_line_of_sight_is_the_papers() -> None:
    """-lambda |u'| (u / |u|) x Omega with Omega = (u x u') / (u . u), in three dimensions by numpy."""
    offset, rate = np.array([40.0, 9.0, 0.0]), np.array([-3.0, 5.0, 0.0])
    omega = np.cross(offset, rate) / (offset @ offset)
    wanted = -3.0 * np.linalg.norm(rate) * np.cross(offset / np.linalg.norm(offset), omega)
    state = state_at((0.0, 0.0, 2.0), (2.0, -5.0, 0.0))
    motion = straight((40.0, 9.0, 2.0), (-1.0, 0.0, 0.0))
    slow = replace(LIMITS, jerk_max_m_s3=1e6, speed_max_m_s=1e3, acceleration_max_m_s2=100.0)
    _, result = PN.plan(None, request_of(state, target_of(motion), slow))
    across = np.array([-offset[1], offset[0], 0.0]) / np.linalg.norm(offset)
    assert result.next_state.acceleration_enu_m_s2 @ across == pytest.approx(wanted @ across)


def test_on_a_collision_course_nothing_is_pushed_across() -> None:
    state = state_at((0.0, 0.0, 2.0), (6.0, 3.0, 0.0))
    _, result = PN.plan(None, request_of(state, target_of(straight((40.0, 20.0, 2.0), (0.0, 0.0, 0.0)))))
    push = result.next_state.acceleration_enu_m_s2
    assert push[0] * 20.0 - push[1] * 40.0 == pytest.approx(0.0, abs=1e-9)


def test_the_near_law_holds_on_a_little_farther_out_than_it_began() -> None:
    memory, _ = PN.plan(None, request_of(state_at((0, 0, 2)), target_of(straight((4.9, 0, 2), (0, 0, 0)))))
    assert memory.near
    memory, _ = PN.plan(memory, request_of(state_at((0, 0, 2)), target_of(straight((7.0, 0, 2), (0, 0, 0)))))
    assert memory.near
    memory, _ = PN.plan(memory, request_of(state_at((0, 0, 2)), target_of(straight((8.0, 0, 2), (0, 0, 0)))))
    assert not memory.near


@pytest.mark.slow
def test_the_floor_is_not_flown_through() -> None:
    flight = fly(PN, straight((0.0, 0.0, -3.0), (5.0, 0.0, 0.0)), state_at((0.0, 0.0, 5.0)), 10.0, floor_m=1.0)
    assert flight.position[:, 2].min() > 0.99


def test_advancing_is_exact_for_constant_jerk() -> None:
    state = state_at((1.0, 2.0, 9.0), (1.0, -1.0, 0.5), (0.3, 0.2, -0.1))
    after = advance(state, np.array([0.3, 0.4, -0.1]), LIMITS, 0.0, 0.1)
    jerk = (after.acceleration_enu_m_s2 - state.acceleration_enu_m_s2) / 0.1
    wanted = (
        state.position_enu_m + state.velocity_enu_m_s * 0.1 + state.acceleration_enu_m_s2 * 0.005 + jerk * 1e-3 / 6.0
    )
    np.testing.assert_allclose(after.position_enu_m, wanted)


def test_a_target_with_nan_is_answered_by_braking() -> None:
    target = target_of(straight((3.0, 0.0, 1.0), (0.0, 0.0, 0.0)))
    broken = replace(target, position_enu_m=target.position_enu_m * np.nan)
    _, result = PN.plan(None, request_of(state_at((0.0, 0.0, 2.0)), broken))
    assert result.status is PlanStatus.FAILED
    assert np.isfinite(result.next_state.position_enu_m).all()
