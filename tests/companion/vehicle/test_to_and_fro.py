"""How much and how often an antenna goes to and fro: a sway shows, and nothing of how the vehicle is driven."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from companion.core.data import Array
from companion.vehicle.to_and_fro import ToAndFro, passed, watch

HALF_PERIODS_S = (1.0 / 3.0, 0.42, 0.52, 0.65, 0.81)
STEP_S, STD_M_S = 0.1, 0.05
SPEED_M_S, COURSE_RAD = 7.0, 0.7
Motion = Callable[[float], tuple[float, ...]]
"""Speed along the course, across it and, if it is not 0, up, m/s, at a time, s."""


def watched(motion: Motion, seconds: float = 8.0, std_m_s: float = 0.0, step_s: float = STEP_S) -> ToAndFro:
    rng = np.random.default_rng(3)
    seen = ToAndFro()
    for i in range(round(seconds / step_s)):
        along, across, up = (*motion(i * step_s), 0.0)[:3]
        c, s = math.cos(COURSE_RAD), math.sin(COURSE_RAD)
        velocity = np.array([c * along - s * across, s * along + c * across, up])
        seen = watch(passed(seen, step_s), velocity + std_m_s * rng.standard_normal(3), covariance(), HALF_PERIODS_S)
    return seen


def covariance() -> Array:
    return STD_M_S**2 * np.eye(3)


def swing(amplitude_m_s: float, t_s: float, frequency_hz: float = 1.5) -> float:
    return amplitude_m_s * math.sin(2.0 * math.pi * frequency_hz * t_s)


def largest(seen: ToAndFro) -> float:
    return max(seen.along.variance_m2_s2, seen.across.variance_m2_s2, seen.up.variance_m2_s2)


def turning(t_s: float) -> tuple[float, float]:
    return SPEED_M_S * math.cos(0.5 * t_s), SPEED_M_S * math.sin(0.5 * t_s)


@pytest.mark.parametrize("step_s", [0.05, 0.1])
@pytest.mark.parametrize("frequency_hz", [0.6, 0.8, 1.0, 1.3, 1.5])
def test_variance_of_a_sway_is_found_along_and_across_or_a_little_less(frequency_hz: float, step_s: float) -> None:
    def motion(t_s: float) -> tuple[float, float]:
        return SPEED_M_S + swing(0.5, t_s, frequency_hz), swing(0.2, t_s, frequency_hz)

    seen = watched(motion, seconds=14.0, std_m_s=STD_M_S, step_s=step_s)
    assert 0.5 < seen.along.variance_m2_s2 / (0.5 * 0.5**2) < 1.2
    assert 0.5 < seen.across.variance_m2_s2 / (0.5 * 0.2**2) < 1.2


def test_heave_is_found_likewise() -> None:
    seen = watched(lambda t: (SPEED_M_S, 0.0, swing(0.3, t, 0.6)), seconds=14.0, std_m_s=STD_M_S)
    assert 0.5 < seen.up.variance_m2_s2 / (0.5 * 0.3**2) < 1.2
    assert seen.up.period == len(HALF_PERIODS_S) - 1
    assert seen.along.variance_m2_s2 + seen.across.variance_m2_s2 < (0.3 * STD_M_S) ** 2


@pytest.mark.parametrize("frequency_hz", [0.6, 0.7, 0.8, 1.0, 1.2, 1.5, 1.8, 2.1])
def test_period_of_a_sway_is_the_nearest_of_those_it_may_have(frequency_hz: float) -> None:
    seen = watched(lambda t: (SPEED_M_S + swing(0.5, t, frequency_hz), 0.0), seconds=14.0, std_m_s=STD_M_S)
    apart = [abs(math.log(2.0 * half_period_s * frequency_hz)) for half_period_s in HALF_PERIODS_S]
    assert apart[seen.along.period] == pytest.approx(min(apart), abs=0.12)


@pytest.mark.parametrize(
    "motion",
    [
        lambda _: (SPEED_M_S, 0.0),
        lambda t: (SPEED_M_S + 2.0 * t, 0.0),
        turning,
        lambda t: (SPEED_M_S - 6.0 * min(max(t - 6.0, 0.0), 1.0), 0.0),
        lambda t: (SPEED_M_S, 0.0, 0.1 * SPEED_M_S * min(max(t - 5.0, 0.0), 1.0)),
        lambda t: (SPEED_M_S - 6.0 * min(max(t - 6.0, 0.0), 1.0) + 2.0 * min(max(t - 9.0, 0.0), 3.0), 0.0),
    ],
    ids=["steady", "speeding_up", "turning", "braking_for_a_second", "climbing", "and_driving_on"],
)
@pytest.mark.parametrize("seconds", [7.0, 8.0, 9.0, 10.0, 13.0])
def test_driving_is_no_sway(motion: Motion, seconds: float) -> None:
    assert largest(watched(motion, seconds)) == pytest.approx(0.0, abs=1e-3)


def test_noise_of_the_receiver_is_no_sway() -> None:
    assert largest(watched(lambda _: (SPEED_M_S, 0.0), std_m_s=STD_M_S)) < (0.3 * STD_M_S) ** 2


def test_nothing_is_said_after_half_a_second_or_across_a_gap() -> None:
    swings = watched(lambda t: (SPEED_M_S + swing(0.5, t), 0.0), seconds=1.7)
    assert largest(swings) == 0.0
    still = watch(passed(ToAndFro(), 0.0), np.array([SPEED_M_S, 0.0, 0.0]), covariance(), HALF_PERIODS_S)
    for _ in range(20):
        still = watch(passed(still, 0.6), np.array([SPEED_M_S, 0.0, 0.0]), covariance(), HALF_PERIODS_S)
    assert still.squares is not None
    assert np.isnan(still.squares[:, 1:]).all()


def test_sway_that_has_ended_is_forgotten() -> None:
    seen = watched(lambda t: (SPEED_M_S + (swing(0.5, t) if t < 8.0 else 0.0), 0.0), seconds=17.0)
    assert largest(seen) == pytest.approx(0.0, abs=1e-4)


def test_what_is_kept_is_bounded_at_any_rate() -> None:
    seen = watched(lambda _: (SPEED_M_S, 0.0), seconds=12.0, step_s=0.01)
    assert seen.squares is not None
    assert len(seen.told) <= (3.0 * HALF_PERIODS_S[-1] + 0.45) / 0.045 + 2
    assert len(seen.squares) <= 8.0 / 0.045 + 2
