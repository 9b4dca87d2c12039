"""Which of the models the vehicle is in, as its readings tell."""

import math

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from companion.config.estimation import EstimatorConfig, EstimatorKind, ImmConfig, ReceiversConfig
from companion.core.data import Quantity
from companion.vehicle import imm_judgement as judgement
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.imm_swing import SIZE
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, arrival, drive, sense
from tests.companion.vehicle.rides import estimator, now_ns
from tests.companion.vehicle.test_imm_kernels import LEVER, NOISE, a_covariance, a_state

BEGINS_AFTER_S = np.array([0.4, 10.0, 40.0])
NOISES = np.stack([NOISE, 3.0 * NOISE, 30.0 * NOISE])
SAME_FRAME = EstimatorConfig(
    imm=ImmConfig(receivers=ReceiversConfig(frame_offset_std_m=0.0, frame_offset_walk_m2_s=0.0))
)


def two_modes(weight: float) -> mixing.Modes:
    means = np.stack([a_state(2), a_state(2)])
    covariances = np.stack([0.03 * np.eye(SIZE), 0.7 * np.eye(SIZE)])
    return means, covariances, np.array([1.0 - weight, weight])


def test_scalar_tells_the_modes_apart_by_its_likelihood() -> None:
    modes, error, R = two_modes(0.2), 0.9, 0.01 * np.eye(1)
    expected, H = sensors.observe(sensors.HEADING, modes[0][0], LEVER, True)
    (_, _, after), _, _ = judgement.update_modes(modes, (sensors.HEADING, expected + error, R), LEVER, True)
    spreads = [math.sqrt(float((H @ P @ H.T + R)[0, 0])) for P in modes[1]]
    ratio = norm.pdf(error, scale=spreads[1]) / norm.pdf(error, scale=spreads[0])
    assert after[1] / after[0] == pytest.approx(0.25 * ratio)


@pytest.mark.parametrize(("kind", "components"), [(sensors.VELOCITY, 1), (sensors.POSITION, 3)])
def test_velocity_counts_in_full_and_a_place_as_one_component(kind: int, components: int) -> None:
    modes, R = two_modes(0.2), 0.01 * np.eye(3)
    expected, H = sensors.observe(kind, modes[0][0], LEVER, True)
    error = np.array([0.5, -0.2, 0.3])
    (_, _, after), _, _ = judgement.update_modes(modes, (kind, expected + error, R), LEVER, True)
    fits = [multivariate_normal.logpdf(error, cov=H @ P @ H.T + R) for P in modes[1]]
    assert after[1] / after[0] == pytest.approx(0.25 * math.exp((fits[1] - fits[0]) / components))


def test_models_that_all_fit_badly_are_still_told_apart() -> None:
    means = np.stack([a_state(2)] * 3)
    covariances = np.stack([spread * np.eye(SIZE) for spread in (0.001, 0.7, 0.9)])
    modes = (means, covariances, np.array([0.8, 0.1, 0.1]))
    expected, H = sensors.observe(sensors.VELOCITY, means[0], LEVER, True)
    error, R = np.array([30.0, 0.0, 0.0]), 1e-4 * np.eye(3)
    (_, _, after), _, _ = judgement.update_modes(modes, (sensors.VELOCITY, expected + error, R), LEVER, True)
    fits = [multivariate_normal.logpdf(error, cov=H @ P @ H.T + R) for P in covariances]
    assert after[2] / after[1] == pytest.approx(math.exp(fits[2] - fits[1]))
    assert after[0] < 1e-100


def test_error_that_nothing_expects_leaves_probabilities() -> None:
    modes = two_modes(0.01)
    value = sensors.observe(sensors.VELOCITY, modes[0][0], LEVER, True)[0] + 1e4
    (_, _, after), _, _ = judgement.update_modes(modes, (sensors.VELOCITY, value, 1e-4 * np.eye(3)), LEVER, True)
    assert after[1] == pytest.approx(1.0)
    assert after.sum() == pytest.approx(1.0)


def test_each_manoeuvre_is_expected_with_the_probability_that_it_has_begun() -> None:
    means = np.stack([a_state(3), a_state(4), a_state(5)])
    covariances = np.stack([a_covariance(3), a_covariance(4), a_covariance(5)])
    modes = (means, covariances, np.array([1.0, 0.0, 0.0]))
    after = judgement.expect_manoeuvres(modes, 0.2, BEGINS_AFTER_S, NOISES)
    total = (1.0 / BEGINS_AFTER_S).sum()
    begun = (1.0 - math.exp(-0.2 * total)) / BEGINS_AFTER_S / total
    assert after[2][1:] == pytest.approx(begun[1:])
    assert after[2].sum() == pytest.approx(1.0)
    assert after[0] == pytest.approx(np.stack([means[0]] * 3))
    assert after[1][0] == pytest.approx(covariances[0])
    ux, uy = means[0][2:4] / np.hypot(*means[0][2:4])
    for j in (1, 2):
        jerk = after[1][j] - covariances[0]
        grown = np.array([ux, uy]) @ jerk[2:4, 2:4] @ np.array([ux, uy])
        assert grown == pytest.approx(NOISES[j, 0] * 0.2**3 / 3.0, rel=1e-6)


def test_other_manoeuvre_begins_in_one_that_is_under_way_from_where_that_is() -> None:
    means = np.stack([a_state(3), a_state(4), a_state(5)])
    covariances = np.stack([a_covariance(3), a_covariance(4), a_covariance(5)])
    weights = np.array([0.0, 0.0, 1.0])
    after = judgement.expect_manoeuvres((means, covariances, weights), 0.2, BEGINS_AFTER_S, NOISES)
    begun = mixing.switching(BEGINS_AFTER_S, 0.2)[1][1]
    assert after[2] == pytest.approx([0.0, begun, 1.0 - begun])
    assert after[0][1] == pytest.approx(means[2])


def test_manoeuvre_that_is_under_way_is_left_alone() -> None:
    means = np.stack([a_state(3), a_state(4), a_state(5)])
    covariances = np.stack([a_covariance(3), a_covariance(4), a_covariance(5)])
    modes = (means, covariances, np.array([0.2, 0.7, 0.1]))
    for before, after in zip(modes, judgement.expect_manoeuvres(modes, 0.2, BEGINS_AFTER_S, NOISES), strict=True):
        assert after == pytest.approx(before)


@pytest.mark.parametrize("deceleration_m_s2", [2.5, 6.0])
def test_yaw_rates_of_a_straight_road_do_not_hide_a_brake(deceleration_m_s2: float) -> None:
    truth = drive(12.0, lambda t: float(np.clip(12.0 - deceleration_m_s2 * (t - 10.02), 0.0, 12.0)), lambda _: 0.0)
    late = replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0, velocity_std_m_s=0.08, fix_std_m=0.06)
    errors = []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        rates = [
            arrival(i / 50.0, 0.06, Quantity.YAW_RATE, 0.009 * rng.standard_normal(1), 0.009**2 * np.eye(1))
            for i in range(600)
        ]
        told = [measured for at_ns, measured in (*sense(truth, late, seed), *rates) if at_ns <= now_ns(10.48)]
        chosen = estimator(EstimatorKind.IMM, SAME_FRAME)
        estimate = chosen.estimate(chosen.fuse(None, told), now_ns(10.48))
        assert estimate is not None
        errors.append(np.linalg.norm(estimate.velocity_enu_m_s[:2]) - np.linalg.norm(truth.at(10.48)[1][:2]))
    assert abs(np.mean(errors)) < 0.06 * deceleration_m_s2
