import math

import numpy as np
import pytest
from scipy import stats

from companion.config.companion import CompanionConfig
from companion.config.estimation import EstimatorConfig, EstimatorKind, ImmConfig, ReceiversConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.factory import make_estimator
from companion.vehicle.imm_numbers import Deck
from link.records import replace
from tests.companion.vehicle.drives import (
    ANTENNA_TO_PAD_M,
    DEGRADED,
    FIX_ONLY,
    NOMINAL,
    Drive,
    Sensors,
    brake,
    circle,
    drive,
    figure_eight,
    pad_centre,
    stop_and_go,
    straight,
)
from tests.companion.vehicle.rides import Ride, arrivals, estimator, now_ns, ride, rms

IMM = EstimatorKind.IMM
SAME_FRAME = EstimatorConfig(
    imm=ImmConfig(receivers=ReceiversConfig(frame_offset_std_m=0.0, frame_offset_walk_m2_s=0.0))
)
WITH_PAD = replace(NOMINAL, pad_rate_hz=30.0, frame_offset_m=0.5)
DEGRADED_WITH_PAD = replace(DEGRADED, pad_rate_hz=10.0, pad_delay_s=0.15, frame_offset_m=1.2)


def pad_errors(done: Ride, truth: Drive) -> Array:
    errors = []
    for t_s, estimate in zip(done.t_s, done.estimates, strict=True):
        position, _, yaw, _ = truth.at(t_s)
        assert estimate.yaw_rad is not None
        errors.append(pad_centre(estimate.position_enu_m, estimate.yaw_rad) - pad_centre(position, yaw))
    return np.array(errors)


@pytest.mark.slow
@pytest.mark.parametrize("truth", [straight(7.0), circle()], ids=["straight", "circle"])
def test_covariance_on_steady_roads_is_cautious_but_not_idle(truth: Drive) -> None:
    nees, nis = [], []
    for seed in range(10):
        chosen = estimator(IMM, SAME_FRAME)
        done = ride(chosen, truth, NOMINAL, seed, from_s=8.0, until_s=8.1)
        error = done.errors(truth)[0][:2]
        nees.append(float(error @ np.linalg.solve(done.estimates[0].covariance[:2, :2], error)))
        nis.append(chosen.health(done.memory).nis_per_dof)
    assert np.mean(nees) < stats.chi2.ppf(0.975, 2 * len(nees)) / len(nees)
    assert 0.5 < np.mean(np.array(nis, dtype=float)) < 1.0


def test_models_of_an_estimate_make_up_its_covariance() -> None:
    chosen = make_estimator(SAME_FRAME, Deck(), IMM)  # the pad at the antenna
    estimate = ride(chosen, circle(), NOMINAL, 1, from_s=8.0, until_s=8.1).estimates[0]
    mixture = estimate.mixture
    assert mixture is not None
    assert mixture.weight.sum() == pytest.approx(1.0)
    assert mixture.weight @ mixture.off == pytest.approx(np.zeros(9), abs=1e-3)
    between = np.einsum("ki,kj->kij", mixture.off, mixture.off)
    scale = np.sqrt(np.diag(estimate.covariance))
    total = np.tensordot(mixture.weight, mixture.covariance + between, 1)
    assert total / np.outer(scale, scale) == pytest.approx(estimate.covariance / np.outer(scale, scale), abs=0.02)


def test_models_of_an_estimate_are_of_the_pad_at_the_end_of_its_arm() -> None:
    chosen = estimator(IMM, SAME_FRAME)
    done = ride(chosen, circle(), NOMINAL, 1, from_s=8.0, until_s=8.1)
    estimate, ahead = done.estimates[0], chosen.forecast(done.memory, done.estimates[0].t_ns, np.array([0.0, 0.1]))
    assert estimate.mixture is not None
    assert ahead is not None
    weight, off = estimate.mixture.weight, estimate.mixture.off
    variances = np.array([one.diagonal() for one in estimate.mixture.covariance])
    std = np.sqrt(weight @ (variances + off**2))
    assert std[:2] == pytest.approx(ahead.position_std_m[0, :2], rel=0.05)
    assert std[3:5] != pytest.approx(np.sqrt(estimate.covariance.diagonal()[3:5]), rel=0.05)


def test_offset_between_the_receivers_is_learnt_from_sightings() -> None:
    truth = circle()
    without = ride(estimator(IMM), truth, replace(NOMINAL, frame_offset_m=0.5), 103)
    with_pad = ride(estimator(IMM), truth, WITH_PAD, 103)
    assert rms(without.errors(truth)) == pytest.approx(0.5, abs=0.1)
    assert rms(pad_errors(with_pad, truth)) < 0.04


def test_offset_stays_learnt_when_the_sightings_end() -> None:
    truth = circle()
    seen = [m for m in arrivals(truth, WITH_PAD, 104) if m.quantity is not Quantity.PAD or m.t_ns < now_ns(6.0)]
    chosen = estimator(IMM)
    memory = chosen.fuse(None, [])
    for measurement in seen:
        memory = chosen.fuse(memory, [measurement])
    estimate = chosen.estimate(memory, now_ns(20.0))
    assert estimate is not None
    there = truth.at(20.0)[0]
    assert estimate.position_enu_m[:2] == pytest.approx(there[:2], abs=0.08)
    # The drone's own height may have wandered: what seemed to be its rate goes on and fades.
    assert estimate.position_enu_m[2] == pytest.approx(there[2], abs=0.5 * math.sqrt(estimate.covariance[2, 2]))


def test_slow_error_of_a_plain_receiver_is_followed_by_sightings() -> None:
    truth = straight(7.0)
    blind = ride(estimator(IMM), truth, replace(DEGRADED, frame_offset_m=1.2), 105)
    seeing = ride(estimator(IMM), truth, DEGRADED_WITH_PAD, 105)
    assert rms(blind.errors(truth)) > 0.7
    assert rms(seeing.errors(truth)) < 0.12


def test_spread_without_sightings_admits_the_unknown_offset() -> None:
    truth = straight(7.0)
    nominal = ride(estimator(IMM), truth, NOMINAL, 106).estimates[-1]
    seeing = ride(estimator(IMM), truth, WITH_PAD, 106).estimates[-1]
    assert math.sqrt(nominal.covariance[0, 0]) == pytest.approx(1.0, abs=0.05)
    assert math.sqrt(seeing.covariance[0, 0]) < 0.05


def test_step_of_the_drones_own_frame_is_followed_within_a_second() -> None:
    truth = straight(5.0)
    step = np.array([2.0, -3.0, 0.4])
    measurements = [
        replace(m, value=m.value + step) if m.quantity is Quantity.PAD and m.t_ns > now_ns(8.0) else m
        for m in arrivals(truth, WITH_PAD, 107)
        if m.t_ns < now_ns(9.0)
    ]
    chosen = estimator(IMM)
    memory = chosen.fuse(None, [])
    for measurement in measurements:
        memory = chosen.fuse(memory, [measurement])
    estimate = chosen.estimate(memory, now_ns(9.0))
    assert estimate is not None
    assert estimate.position_enu_m == pytest.approx(truth.at(9.0)[0] + step, abs=0.15)
    assert estimate.velocity_enu_m_s == pytest.approx(truth.at(9.0)[1], abs=0.15)


def test_step_of_the_receiver_does_not_move_a_pad_that_is_seen() -> None:
    truth = straight(5.0)
    measurements = [
        replace(m, value=m.value + 4.0) if m.quantity is Quantity.POSITION and m.t_ns > now_ns(8.0) else m
        for m in arrivals(truth, WITH_PAD, 108)
        if m.t_ns < now_ns(10.0)
    ]
    chosen = estimator(IMM)
    memory = chosen.fuse(None, [])
    for measurement in measurements:
        memory = chosen.fuse(memory, [measurement])
        estimate = chosen.estimate(memory, measurement.t_ns)
        if estimate is not None and measurement.t_ns > now_ns(7.9):
            t_s = (measurement.t_ns - now_ns(0.0)) * 1e-9
            assert estimate.position_enu_m == pytest.approx(truth.at(t_s)[0], abs=0.3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "sensors", "bound_m"),
    [
        (circle(), NOMINAL, 0.14),
        (circle(), FIX_ONLY, 0.40),
        (straight(25.0), NOMINAL, 0.17),
        (figure_eight(), NOMINAL, 0.45),
        (stop_and_go(), NOMINAL, 0.5),
    ],
    ids=["circle", "circle, fix only", "straight", "figure eight", "stop and go"],
)
def test_forecast_at_one_second_stays_within_its_bound(truth: Drive, sensors: Sensors, bound_m: float) -> None:
    done = ride(estimator(IMM, SAME_FRAME), truth, sensors, 109)
    assert rms(done.ahead_errors(truth, 1.0)) < bound_m


def test_forecast_spread_covers_its_error_on_a_circle() -> None:
    truth = circle()
    done = ride(estimator(IMM, SAME_FRAME), truth, NOMINAL, 110)
    scaled = done.ahead_errors(truth, 1.0) / done.ahead_std
    assert np.mean(np.abs(scaled) < 2.0) > 0.9


def test_braking_is_in_the_forecast_soon_after_it_began() -> None:
    truth = brake()
    done = ride(estimator(IMM, SAME_FRAME), truth, NOMINAL, 111, from_s=10.3, until_s=12.5)
    unaware = 0.5 * 6.0
    assert np.linalg.norm(done.ahead_errors(truth, 1.0), axis=1).max() < 0.3 * unaware


@pytest.mark.slow
@pytest.mark.parametrize("deceleration_m_s2", [6.0, 9.0])
@pytest.mark.parametrize("seed", [120, 121, 122, 123])
def test_emergency_brake_is_not_taken_for_outliers(deceleration_m_s2: float, seed: int) -> None:
    truth = drive(13.0, lambda t: float(np.clip(15.0 - deceleration_m_s2 * (t - 10.02), 0.0, 15.0)), lambda _: 0.0)
    chosen = estimator(IMM)
    done = ride(chosen, truth, NOMINAL, seed, from_s=9.0)
    assert not any(chosen.health(done.memory).rejected)


@pytest.mark.parametrize(("length_s", "bound_m"), [(1.0, 0.15), (2.0, 0.4), (3.0, 0.9)])
def test_outage_on_a_circle_is_bridged_along_the_arc(length_s: float, bound_m: float) -> None:
    truth = circle()
    sensors = replace(NOMINAL, outage_s=(10.0, 10.0 + length_s))
    end_s = 10.0 + length_s
    done = ride(estimator(IMM, SAME_FRAME), truth, sensors, 112, from_s=end_s - 0.1, until_s=end_s)
    assert rms(done.errors(truth)) < bound_m
    after = ride(estimator(IMM, SAME_FRAME), truth, sensors, 112, from_s=end_s + 0.5)
    assert rms(after.errors(truth)) < 0.06
    assert after.memory is not None


def test_outage_with_sightings_does_not_matter() -> None:
    truth = circle()
    sensors = replace(WITH_PAD, outage_s=(10.0, 13.0))
    done = ride(estimator(IMM), truth, sensors, 113, from_s=9.0, until_s=14.0)
    assert rms(done.errors(truth)) < 0.06


def test_unknown_heading_does_not_spoil_a_sighting() -> None:
    parked = straight(0.0, 6.0)
    sensors = replace(WITH_PAD, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0)
    done = ride(estimator(IMM), parked, sensors, 114, ahead_s=0.5)
    lever = math.hypot(*ANTENNA_TO_PAD_M[:2])
    assert np.abs(done.errors(parked)).max() < lever + 0.1


def test_lever_arm_may_become_known_while_the_memory_goes_on() -> None:
    truth = circle()
    measurements = [m for m in arrivals(truth, WITH_PAD, 115) if m.t_ns < now_ns(8.0)]
    before, after = make_estimator(EstimatorConfig()), estimator(IMM)
    memory = before.fuse(None, [m for m in measurements if m.t_ns < now_ns(4.0)])
    memory = after.fuse(memory, [m for m in measurements if m.t_ns >= now_ns(4.0)])
    estimate = after.estimate(memory, now_ns(8.0))
    assert estimate is not None
    assert estimate.position_enu_m == pytest.approx(truth.at(8.0)[0], abs=0.12)


def test_driving_backwards_keeps_the_measured_heading() -> None:
    forwards = straight(3.0)
    backwards = replace(forwards, yaw=forwards.yaw + math.pi)
    done = ride(estimator(IMM, SAME_FRAME), backwards, NOMINAL, 116)
    for estimate in done.estimates:
        assert estimate.yaw_rad is not None
        assert math.remainder(estimate.yaw_rad - 0.3 - math.pi, math.tau) == pytest.approx(0.0, abs=0.05)


def test_fix_that_states_a_large_error_is_not_averaged_into_certainty() -> None:
    truth = straight(7.0)
    done = ride(estimator(IMM), truth, DEGRADED, 117)
    assert math.sqrt(done.estimates[-1].covariance[0, 0]) > 1.0


def test_measurement_of_a_single_axis_is_not_taken_for_more() -> None:
    chosen = estimator(IMM, SAME_FRAME)
    fix = Measurement(t_ns=now_ns(0.0), quantity=Quantity.POSITION, value=np.zeros(3), covariance=4e-4 * np.eye(3))
    yaw_rate = Measurement(
        t_ns=now_ns(0.1), quantity=Quantity.YAW_RATE, value=np.array([0.2]), covariance=1e-4 * np.eye(1)
    )
    memory = chosen.fuse(None, [fix, yaw_rate])
    estimate = chosen.estimate(memory, now_ns(0.1))
    assert estimate is not None
    assert np.abs(estimate.position_enu_m).max() < 0.05


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 8])
def test_noise_that_all_axes_share_is_not_taken_for_a_manoeuvre(seed: int) -> None:
    """The source report's receiver: 0.1 m at 100 Hz, the same draw on each axis, stated as independent."""
    truth, rng, chosen = straight(7.0), np.random.default_rng(seed), estimator(IMM)
    memory, errors_m_s = chosen.fuse(None, []), []
    for i in range(1200):
        position = truth.at(0.01 * i)[0] + rng.normal(0.0, 0.1)
        fix = Measurement(
            t_ns=now_ns(0.01 * i), quantity=Quantity.POSITION, value=position, covariance=0.01 * np.eye(3)
        )
        memory = chosen.fuse(memory, [fix])
        estimate = chosen.estimate(memory, fix.t_ns)
        assert estimate is not None
        errors_m_s.append(math.hypot(*(estimate.velocity_enu_m_s - truth.velocity[0])[:2]))
    assert max(errors_m_s[400:]) < CompanionConfig().abort.near_speed_max_m_s
