"""How steadily a vehicle is driven is learnt from how its accelerations change while no manoeuvre begins."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind, ImmConfig
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_swing import SIZE
from companion.vehicle.steady_driving import LAG_S, MEMORY_S, PRIOR_S, SteadyDriving, learn, passed
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, Drive, drive, straight
from tests.companion.vehicle.rides import estimator, ride

CONFIG = ImmConfig()
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


def watched(
    psd_m2_s5: tuple[float, float], seconds: float, *, seed: int = 3, speed_change_m_s: float = 0.0
) -> SteadyDriving:
    """What is learnt of accelerations that walk so fast, the one along fading as the filter's model has it."""
    rng = np.random.default_rng(seed)
    left = math.exp(-DT_S / CONFIG.acceleration_decay_s)
    driving, along, curvature = SteadyDriving(), 0.0, 0.02
    for i in range(round(seconds / DT_S)):
        speed_m_s = SPEED_M_S + speed_change_m_s * math.sin(i * DT_S)
        along = left * along + math.sqrt(psd_m2_s5[0] * DT_S) * rng.standard_normal()
        curvature += math.sqrt(psd_m2_s5[1] * DT_S) * rng.standard_normal() / speed_m_s**2
        driving = learn(passed(driving, DT_S), known(along, curvature * speed_m_s**2, speed_m_s), CONFIG)
    return driving


def test_driver_who_was_not_watched_is_taken_for_the_configured_one() -> None:
    assert SteadyDriving().psd_m2_s5(PRIOR) == pytest.approx(PRIOR)


@pytest.mark.parametrize("psd_m2_s5", [(0.02, 2.0), (0.4, 0.4), (3.0, 0.03)])
def test_what_is_learnt_is_how_fast_the_accelerations_walk(psd_m2_s5: tuple[float, float]) -> None:
    learnt = [watched(psd_m2_s5, 240.0, seed=seed) for seed in range(12)]
    for i, axes in enumerate(([one.along for one in learnt], [one.across for one in learnt])):
        found = np.mean([axis.squares_m2_s4 / axis.seen_s for axis in axes])
        assert found == pytest.approx(psd_m2_s5[i], rel=0.15)
        weighted = (PRIOR_S * PRIOR[i] + axes[0].squares_m2_s4) / (PRIOR_S + axes[0].seen_s)
        assert axes[0].psd_m2_s5(PRIOR[i]) == pytest.approx(weighted)


def test_speeding_up_in_an_even_curve_is_no_steering() -> None:
    steered = watched((0.1, 0.0), 120.0, speed_change_m_s=3.0)
    assert steered.across.psd_m2_s5(PRIOR[1]) < 0.4 * PRIOR[1]


def test_filter_that_is_not_sure_yet_teaches_nothing() -> None:
    driving = learn(passed(SteadyDriving(), LAG_S), known(0.0, 0.0, std_m_s2=3.0), CONFIG)
    driving = learn(passed(driving, LAG_S), known(4.0, -4.0), CONFIG)
    assert driving.psd_m2_s5(PRIOR) == pytest.approx(PRIOR)


def test_doubt_that_shrinks_is_told_from_driving() -> None:
    """A mean that is drawn to the truth moves by what the variance falls, in the mean of many."""
    rng, found = np.random.default_rng(5), []
    before_std, now_std = 0.5, 0.4
    for truth in rng.standard_normal(2000):
        driving = learn(passed(SteadyDriving(), LAG_S), known(0.0, 0.0, std_m_s2=before_std), CONFIG)
        gain = 1.0 - (now_std / before_std) ** 2
        told = before_std * truth + math.sqrt(before_std**2 / gain - before_std**2) * rng.standard_normal()
        driving = learn(passed(driving, LAG_S), known(0.0, gain * told, std_m_s2=now_std), CONFIG)
        found.append(driving.across.squares_m2_s4)
    assert np.mean(found) == pytest.approx(0.0, abs=0.01)


def test_swerve_that_has_a_model_of_its_own_makes_no_unsteady_driver() -> None:
    driving = SteadyDriving()
    for across_m_s2, turning in ((0.0, 0.0), (4.0, 1.0), (4.0, 0.0), (4.0, 0.0)):
        driving = learn(passed(driving, LAG_S), known(0.0, across_m_s2, turning=turning), CONFIG)
    assert driving.across.psd_m2_s5(PRIOR[1]) < PRIOR[1]


@pytest.mark.parametrize("pause_s", [3.0, 600.0])
def test_silence_makes_no_pair(pause_s: float) -> None:
    driving = learn(passed(SteadyDriving(), LAG_S), known(0.0, 0.0), CONFIG)
    driving = learn(passed(driving, pause_s), known(5.0, 5.0), CONFIG)
    assert driving.psd_m2_s5(PRIOR) == pytest.approx(PRIOR)


def test_standing_vehicle_teaches_nothing_and_its_departure_neither_and_what_was_learnt_fades() -> None:
    before = watched((0.5, 0.5), 30.0)
    driving, stood_s = before, 100
    for _ in range(stood_s):
        driving = learn(passed(driving, 1.0), known(0.0, 0.0, 0.001), CONFIG)
    driving = learn(passed(driving, 1.0), known(2.0, 0.0), CONFIG)
    left = math.exp(-(before.passed_s + stood_s + 1.0) / MEMORY_S)
    for after, learnt in ((driving.along, before.along), (driving.across, before.across)):
        assert after.squares_m2_s4 == pytest.approx(left * learnt.squares_m2_s4)
        assert after.seen_s == pytest.approx(left * learnt.seen_s)


def test_perfectly_even_driver_may_still_do_something() -> None:
    even = watched((0.0, 0.0), 600.0)
    for axis, prior in ((even.along, PRIOR[0]), (even.across, PRIOR[1])):
        assert 0.5 * MEMORY_S < axis.seen_s < 1.1 * MEMORY_S
        assert axis.psd_m2_s5(prior) == pytest.approx(PRIOR_S / (PRIOR_S + axis.seen_s) * prior, rel=0.1)


def doubt_m_s(truth: Drive, at_s: float) -> float:
    """Of the vehicle's velocity by data that are 0.3 s old and more."""
    late = replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0, delay_s=0.3)
    ridden = ride(estimator(EstimatorKind.IMM), truth, late, 2, from_s=at_s - 1.0, until_s=at_s)
    return float(np.mean([math.sqrt(one.covariance[3, 3] + one.covariance[4, 4]) for one in ridden.estimates]))


def test_vehicle_that_was_seen_driving_evenly_is_less_in_doubt_and_one_that_sways_is_more() -> None:
    even = straight(SPEED_M_S, 70.0)
    swaying = drive(70.0, lambda _: SPEED_M_S, lambda t_s: 0.03 * math.sin(2.0 * t_s))  # 1.9 m/s^2 to the side
    soon, later = doubt_m_s(even, 8.0), doubt_m_s(even, 65.0)
    assert later < 0.95 * soon
    assert doubt_m_s(swaying, 65.0) > 1.5 * later
