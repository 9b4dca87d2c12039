"""How much an antenna goes to and fro: what its receiver tells of a sway, and nothing of how the vehicle is driven."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from companion.core.data import Array
from companion.vehicle.to_and_fro import ToAndFro, least_variances_m2_s2, passed, watch

HALF_PERIOD_S = 1.0 / 3.0
STEP_S, STD_M_S = 0.1, 0.05
SPEED_M_S, COURSE_RAD = 7.0, 0.7
Motion = Callable[[float], tuple[float, float]]
"""Speed along the course and across it, m/s, at a time, s."""


def watched(motion: Motion, seconds: float = 8.0, std_m_s: float = 0.0, step_s: float = STEP_S) -> ToAndFro:
    rng = np.random.default_rng(3)
    seen = ToAndFro()
    for i in range(round(seconds / step_s)):
        along, across = motion(i * step_s)
        c, s = math.cos(COURSE_RAD), math.sin(COURSE_RAD)
        velocity = np.array([c * along - s * across, s * along + c * across, 0.0])
        seen = watch(passed(seen, step_s), velocity + std_m_s * rng.standard_normal(3), covariance(), HALF_PERIOD_S)
    return seen


def covariance() -> Array:
    return STD_M_S**2 * np.eye(3)


def swing(amplitude_m_s: float, t_s: float) -> float:
    return amplitude_m_s * math.sin(math.pi * t_s / HALF_PERIOD_S)


def turning(t_s: float) -> tuple[float, float]:
    return SPEED_M_S * math.cos(0.5 * t_s), SPEED_M_S * math.sin(0.5 * t_s)


@pytest.mark.parametrize("step_s", [0.05, 0.1])
def test_variance_of_a_sway_is_found_along_and_across_or_a_little_less(step_s: float) -> None:
    seen = watched(lambda t: (SPEED_M_S + swing(0.5, t), swing(0.2, t)), std_m_s=STD_M_S, step_s=step_s)
    along, across = least_variances_m2_s2(seen)
    assert 0.6 < along / (0.5 * 0.5**2) < 1.2
    assert 0.6 < across / (0.5 * 0.2**2) < 1.2


@pytest.mark.parametrize(
    "motion",
    [
        lambda _: (SPEED_M_S, 0.0),
        lambda t: (SPEED_M_S + 2.0 * t, 0.0),
        turning,
        lambda t: (SPEED_M_S - 6.0 * min(max(t - 6.0, 0.0), 1.0), 0.0),
    ],
    ids=["steady", "speeding_up", "turning", "braking_for_a_second"],
)
def test_driving_is_no_sway(motion: Motion) -> None:
    assert max(least_variances_m2_s2(watched(motion))) == pytest.approx(0.0, abs=1e-4)


def test_noise_of_the_receiver_is_no_sway() -> None:
    assert max(least_variances_m2_s2(watched(lambda _: (SPEED_M_S, 0.0), std_m_s=STD_M_S))) < (0.3 * STD_M_S) ** 2


def test_nothing_is_said_after_half_a_second_or_across_a_gap() -> None:
    swings = watched(lambda t: (SPEED_M_S + swing(0.5, t), 0.0), seconds=1.2)
    assert least_variances_m2_s2(swings) == (0.0, 0.0)
    still = watch(passed(ToAndFro(), 0.0), np.array([SPEED_M_S, 0.0, 0.0]), covariance(), HALF_PERIOD_S)
    for _ in range(20):
        still = watch(passed(still, 0.6), np.array([SPEED_M_S, 0.0, 0.0]), covariance(), HALF_PERIOD_S)
    assert still.squares_m2_s2 == ()


def test_sway_that_has_ended_is_forgotten() -> None:
    seen = watched(lambda t: (SPEED_M_S + (swing(0.5, t) if t < 8.0 else 0.0), 0.0), seconds=14.0)
    assert max(least_variances_m2_s2(seen)) == pytest.approx(0.0, abs=1e-4)


def test_what_is_kept_is_bounded_at_any_rate() -> None:
    seen = watched(lambda _: (SPEED_M_S, 0.0), seconds=10.0, step_s=0.01)
    assert len(seen.velocities_m_s) <= 1.5 / 0.045 + 2
    assert len(seen.squares_m2_s2) <= 5.0 / 0.045 + 2
