"""How steadily a vehicle is driven is learnt from how its accelerations change while no manoeuvre begins."""

import math
from typing import Any

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind, ImmConfig
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_numbers import Deck, numbers_of
from companion.vehicle.imm_swing import SIZE
from companion.vehicle.steady_driving import LAG_S, MEMORY_S, PRIOR_S, SteadyDriving, Watched, learn, passed
from link.records import replace
from tests.companion.vehicle.drives import FIX_ONLY, NOMINAL, Drive, Sensors, drive, random_drive, straight
from tests.companion.vehicle.rides import estimator, ride

CONFIG = ImmConfig()
BOUNDS = numbers_of(CONFIG, Deck()).steady_m2_s5
PRIOR = (CONFIG.steady.jerk_psd_m2_s5, CONFIG.steady.lateral_acceleration_psd_m2_s5)
DT_S = 0.1
SPEED_M_S = 8.0
KNOWN_STD_M_S2 = 0.01


def known(
    along_m_s2: float,
    across_m_s2: float,
    speed_m_s: float = SPEED_M_S,
    *,
    std_m_s2: float = KNOWN_STD_M_S2,
    turning: float = 0.0,
) -> Modes:
    """A filter that knows a vehicle which drives north; all modes know the same."""
    x, P = np.zeros(SIZE), np.zeros((SIZE, SIZE))
    x[3], x[5], x[6] = speed_m_s, along_m_s2, across_m_s2 / speed_m_s**2
    P[4, 4] = P[5, 5] = std_m_s2**2
    P[6, 6] = std_m_s2**2 / speed_m_s**4
    weights = np.array([1.0 - turning, 0.0, 0.0, turning, 0.0])
    return np.stack([x] * 5), np.stack([P] * 5), weights


def watched(psd_m2_s5: tuple[float, float], seconds: float, *, seed: int = 3) -> SteadyDriving:
    """What is learnt of accelerations that walk so fast."""
    rng = np.random.default_rng(seed)
    driving, along_m_s2, across_m_s2 = SteadyDriving(), 0.0, 1.0
    for _ in range(round(seconds / DT_S)):
        along_m_s2 += math.sqrt(psd_m2_s5[0] * DT_S) * rng.standard_normal()
        across_m_s2 += math.sqrt(psd_m2_s5[1] * DT_S) * rng.standard_normal()
        driving = learn(passed(driving, DT_S), known(along_m_s2, across_m_s2), CONFIG)
    return driving


def pair(before: Modes, now: Modes, lag_s: float = LAG_S) -> SteadyDriving:
    """What is learnt of two instants."""
    return learn(passed(learn(SteadyDriving(), before, CONFIG), lag_s), now, CONFIG)


def test_driver_who_was_not_watched_is_taken_for_an_ordinary_one() -> None:
    assert SteadyDriving().psd_m2_s5(BOUNDS) == PRIOR


@pytest.mark.parametrize("psd_m2_s5", [(0.02, 2.0), (0.4, 0.4), (3.0, 0.03)])
def test_what_is_learnt_is_how_fast_the_accelerations_walk(psd_m2_s5: tuple[float, float]) -> None:
    learnt = [watched(psd_m2_s5, 240.0, seed=seed) for seed in range(12)]
    for i, axes in enumerate(([one.along for one in learnt], [one.across for one in learnt])):
        found = np.mean([axis.squares_m2_s4 / axis.seen_s for axis in axes])
        assert found == pytest.approx(psd_m2_s5[i], rel=0.15)
        weighted = (PRIOR_S * PRIOR[i] + axes[0].squares_m2_s4) / (PRIOR_S + axes[0].seen_s)
        assert axes[0].psd_m2_s5(BOUNDS[i]) == pytest.approx(np.clip(weighted, *BOUNDS[i]))


def test_nobody_is_steadier_than_ordinary() -> None:
    assert watched((0.0, 0.0), 600.0).psd_m2_s5(BOUNDS) == PRIOR


def test_no_steady_driver_is_as_wild_as_a_manoeuvre() -> None:
    along_m2_s5, across_m2_s5 = watched((100.0, 1000.0), 120.0).psd_m2_s5(BOUNDS)
    assert along_m2_s5 == pytest.approx(0.1 * CONFIG.easing.jerk_psd_m2_s5)
    assert across_m2_s5 == pytest.approx(0.1 * CONFIG.turning.lateral_acceleration_psd_m2_s5)


def test_speeding_up_in_an_even_curve_is_no_steering() -> None:
    slow, fast = (known(0.0, 0.03 * v * v, v, std_m_s2=1e-4 * v * v) for v in (5.0, 8.0))
    steered = pair(slow, fast)
    assert steered.across.squares_m2_s4 == pytest.approx(0.0, abs=1e-9)
    assert steered.across.seen_s == pytest.approx(LAG_S)


def test_filter_that_is_not_sure_yet_teaches_nothing() -> None:
    assert pair(known(0.0, 0.0, std_m_s2=3.0), known(4.0, -4.0)).psd_m2_s5(BOUNDS) == PRIOR


def test_doubt_that_shrinks_is_told_from_driving() -> None:
    """A mean that is drawn to the truth moves by what the variance falls, in the mean of many."""
    rng, found = np.random.default_rng(5), []
    before_std, now_std, moved_m_s2 = 0.5, 0.4, 1.0
    gain = 1.0 - (now_std / before_std) ** 2
    for error in rng.standard_normal(2000):
        told = before_std * error + math.sqrt(before_std**2 / gain - before_std**2) * rng.standard_normal()
        now = known(0.0, moved_m_s2 + gain * told, std_m_s2=now_std)
        found.append(pair(known(0.0, 0.0, std_m_s2=before_std), now).across.squares_m2_s4)
    assert np.mean(found) == pytest.approx(moved_m_s2**2, abs=0.05)


def test_swerve_that_has_a_model_of_its_own_makes_no_unsteady_driver() -> None:
    assert pair(known(0.0, 0.0), known(0.0, 4.0)).psd_m2_s5(BOUNDS)[1] > PRIOR[1]
    assert pair(known(0.0, 0.0), known(0.0, 4.0, turning=1.0)).psd_m2_s5(BOUNDS) == PRIOR
    driving = SteadyDriving()
    for across_m_s2, turning in ((0.0, 0.0), (4.0, 1.0), (4.0, 0.0), (4.0, 0.0)):
        driving = learn(passed(driving, 0.5 * LAG_S), known(0.0, across_m_s2, turning=turning), CONFIG)
    assert driving.psd_m2_s5(BOUNDS) == PRIOR


@pytest.mark.parametrize("pause_s", [3.0, 600.0, 36_000.0])
def test_silence_makes_no_pair_and_what_was_learnt_fades(pause_s: float) -> None:
    before = watched((0.5, 0.5), 30.0)
    after = learn(passed(before, pause_s), known(5.0, 5.0), CONFIG)
    left = math.exp(-(before.passed_s + pause_s) / MEMORY_S)
    assert after.along.squares_m2_s4 == pytest.approx(left * before.along.squares_m2_s4)
    assert after.across.seen_s == pytest.approx(left * before.across.seen_s)


def test_receiver_that_tells_once_a_second_teaches_whatever_its_jitter() -> None:
    for lag_s in (0.999 * LAG_S, 1.001 * LAG_S):
        driving = learn(SteadyDriving(), known(0.0, 0.0), CONFIG)
        for i in range(4):
            driving = learn(passed(driving, lag_s), known(float(i % 2), 0.0), CONFIG)
        assert driving.along.seen_s > LAG_S


def test_standing_vehicle_teaches_nothing_and_its_departure_neither() -> None:
    before = watched((0.5, 0.5), 30.0)
    driving = learn(passed(before, LAG_S), known(0.0, 0.0, 1e-3), CONFIG)
    driving = learn(passed(driving, LAG_S), known(3.0, 0.0), CONFIG)
    assert driving.along.squares_m2_s4 < before.along.squares_m2_s4
    assert driving.across.seen_s < before.across.seen_s


def doubt_m_s(truth: Drive, at_s: float) -> float:
    """Of the vehicle's velocity by data that are 0.3 s old and more."""
    late = replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0, delay_s=0.3)
    ridden = ride(estimator(EstimatorKind.IMM), truth, late, 2, from_s=at_s - 1.0, until_s=at_s)
    return float(np.mean([math.sqrt(one.covariance[3, 3] + one.covariance[4, 4]) for one in ridden.estimates]))


def test_vehicle_that_sways_is_more_in_doubt_than_one_that_drives_evenly() -> None:
    even = straight(SPEED_M_S, 40.0)
    swaying = drive(40.0, lambda _: SPEED_M_S, lambda t_s: 0.03 * math.sin(2.0 * t_s))  # 1.9 m/s^2 to the side
    assert doubt_m_s(swaying, 35.0) > 1.5 * doubt_m_s(even, 35.0)


@pytest.mark.parametrize("sensors", [NOMINAL, replace(FIX_ONLY, fix_std_m=0.1)], ids=["nominal", "fixes only"])
def test_filter_tells_a_random_driver_from_an_even_one(sensors: Sensors) -> None:
    """The random one's accelerations walk at 0.43 m^2/s^5: 2 (0.8 m/s^2)^2 / 3 s."""
    random = [driving_of(random_drive(seed), sensors, seed) for seed in range(8)]
    even = [driving_of(straight(7.0), sensors, seed) for seed in range(4)]
    for axis in ("along", "across"):
        found = mean_psd_m2_s5([getattr(one, axis) for one in random])
        assert 0.5 < found / 0.43 < 2.0
        assert mean_psd_m2_s5([getattr(one, axis) for one in even]) < found / 1.5


def driving_of(truth: Drive, sensors: Sensors, seed: int) -> SteadyDriving:
    memory: Any = ride(estimator(EstimatorKind.IMM), truth, sensors, seed, from_s=18.0).memory
    driving = memory.newest.state.driving
    assert isinstance(driving, SteadyDriving)
    return driving


def mean_psd_m2_s5(watched_ones: list[Watched]) -> float:
    return sum(one.squares_m2_s4 for one in watched_ones) / sum(one.seen_s for one in watched_ones)
