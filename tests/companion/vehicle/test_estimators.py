"""Laws that every estimator keeps."""

import math
import random

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import Estimator
from link.records import replace
from tests.companion.vehicle.drives import (
    NOMINAL,
    brake,
    circle,
    random_drive,
    stop_and_go,
    straight,
)
from tests.companion.vehicle.rides import KINDS, arrivals, estimator, now_ns, ride, rms

WITH_PAD = replace(NOMINAL, pad_rate_hz=15.0, frame_offset_m=0.5, delay_s=0.15)
HORIZON_S = np.linspace(0.0, 4.0, 41)


@pytest.mark.parametrize("kind", KINDS)
def test_memory_without_a_fix_gives_no_estimate(kind: EstimatorKind) -> None:
    chosen: Estimator = estimator(kind)
    velocity = next(m for m in arrivals(straight(5.0), NOMINAL, 1) if m.quantity is Quantity.VELOCITY)
    memory = chosen.fuse(chosen.fuse(None, []), [velocity])
    assert chosen.estimate(memory, velocity.t_ns) is None
    assert chosen.forecast(memory, velocity.t_ns, HORIZON_S) is None
    assert chosen.newest_fix_ns(memory) is None


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [11, 12])
def test_covariance_is_symmetric_and_positive_after_every_step(kind: EstimatorKind, seed: int) -> None:
    chosen: Estimator = estimator(kind)
    memory = None
    for measurement in arrivals(random_drive(seed), WITH_PAD, seed)[:400]:
        memory = chosen.fuse(memory, [measurement])
        estimate = chosen.estimate(memory, measurement.t_ns + 80_000_000)
        if estimate is None:
            continue
        assert np.array_equal(estimate.covariance, estimate.covariance.T)
        assert np.linalg.eigvalsh(estimate.covariance).min() > -1e-9
        assert estimate.covariance.diagonal()[:6].min() > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [21, 22, 23])
def test_order_of_arrival_leaves_no_trace_within_the_buffer(kind: EstimatorKind, seed: int) -> None:
    chosen: Estimator = estimator(kind)
    measurements = [m for m in arrivals(circle(), WITH_PAD, seed) if m.t_ns <= now_ns(0.9)]
    shuffled = list(measurements)
    random.Random(seed).shuffle(shuffled)
    in_order, out_of_order = chosen.fuse(None, measurements), None
    for measurement in shuffled:
        out_of_order = chosen.fuse(out_of_order, [measurement])
    one, other = chosen.estimate(in_order, now_ns(1.1)), chosen.estimate(out_of_order, now_ns(1.1))
    assert one is not None
    assert other is not None
    assert np.array_equal(one.position_enu_m, other.position_enu_m)
    assert np.array_equal(one.covariance, other.covariance)


@pytest.mark.parametrize("kind", KINDS)
def test_no_measurements_leave_the_memory_to_prediction(kind: EstimatorKind) -> None:
    chosen: Estimator = estimator(kind)
    memory = chosen.fuse(None, [m for m in arrivals(circle(), NOMINAL, 31) if m.t_ns <= now_ns(5.0)])
    again = chosen.fuse(memory, [])
    assert again is memory
    forecast = chosen.forecast(memory, now_ns(5.0), np.array([0.0, 0.1, 0.2]))
    later = chosen.estimate(memory, now_ns(5.2))
    assert forecast is not None
    assert later is not None
    assert forecast.position_enu_m[2] == pytest.approx(later.position_enu_m, abs=5e-3)
    assert forecast.velocity_enu_m_s[2] == pytest.approx(later.velocity_enu_m_s, abs=2e-2)


@pytest.mark.parametrize("kind", KINDS)
def test_newest_fix_is_the_newest_one_taken_not_the_newest_one_arrived(kind: EstimatorKind) -> None:
    chosen: Estimator = estimator(kind)
    fixes = [m for m in arrivals(straight(5.0), NOMINAL, 41) if m.quantity is Quantity.POSITION][:5]
    memory = chosen.fuse(chosen.fuse(None, [*fixes[:2], *fixes[3:]]), [fixes[2]])
    assert chosen.newest_fix_ns(memory) == fixes[4].t_ns


@pytest.mark.parametrize("kind", KINDS)
def test_forecast_starts_at_the_estimate_and_its_spread_grows(kind: EstimatorKind) -> None:
    chosen: Estimator = estimator(kind)
    memory = chosen.fuse(None, [m for m in arrivals(circle(), NOMINAL, 51) if m.t_ns <= now_ns(6.0)])
    estimate, forecast = chosen.estimate(memory, now_ns(6.1)), chosen.forecast(memory, now_ns(6.1), HORIZON_S)
    assert estimate is not None
    assert forecast is not None
    assert forecast.position_enu_m[0] == pytest.approx(estimate.position_enu_m)
    assert forecast.velocity_enu_m_s[0] == pytest.approx(estimate.velocity_enu_m_s)
    assert forecast.acceleration_enu_m_s2[0] == pytest.approx(estimate.acceleration_enu_m_s2)
    area = forecast.position_std_m[:, 0] ** 2 + forecast.position_std_m[:, 1] ** 2
    assert (np.diff(area) > 0.0).all()


@pytest.mark.parametrize("kind", [EstimatorKind.UKF, EstimatorKind.IMM])
def test_forecast_of_a_braking_vehicle_never_drives_backwards(kind: EstimatorKind) -> None:
    chosen: Estimator = estimator(kind)
    memory = chosen.fuse(None, [m for m in arrivals(brake(), NOMINAL, 61) if m.t_ns <= now_ns(10.8)])
    forecast = chosen.forecast(memory, now_ns(10.85), HORIZON_S)
    assert forecast is not None
    along = np.array([math.cos(0.3), math.sin(0.3), 0.0])
    speed = forecast.velocity_enu_m_s @ along
    assert speed[0] > 4.0
    assert speed.min() > -1e-6
    assert speed[-1] < 1e-6
    assert (np.diff(forecast.position_enu_m @ along) > -1e-6).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", [EstimatorKind.UKF, EstimatorKind.IMM])
@pytest.mark.parametrize("seed", [71, 72])
def test_heading_does_not_turn_while_the_vehicle_stands(kind: EstimatorKind, seed: int) -> None:
    sensors = replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0)
    chosen: Estimator = estimator(kind)
    standing = ride(estimator(kind), stop_and_go(), sensors, seed, from_s=10.3, until_s=12.9)
    yaws = [e.yaw_rad for e in standing.estimates]
    assert all(yaw is not None for yaw in yaws)
    assert np.array(yaws, dtype=float) == pytest.approx(0.3, abs=math.radians(4.0))
    assert chosen.newest_fix_ns(standing.memory) is not None


@pytest.mark.parametrize("kind", [EstimatorKind.UKF, EstimatorKind.IMM])
def test_heading_that_was_never_measured_is_unknown_at_rest(kind: EstimatorKind) -> None:
    sensors = replace(NOMINAL, heading_std_rad=0.0)
    parked = ride(estimator(kind), straight(0.0, 6.0), sensors, 81)
    assert all(e.yaw_rad is None for e in parked.estimates)


@pytest.mark.parametrize("kind", [EstimatorKind.UKF, EstimatorKind.IMM])
def test_heading_goes_over_pi_without_a_jump(kind: EstimatorKind) -> None:
    truth = circle()  # turns 0.4 rad/s from 0.3 rad: crosses pi after 7.1 s
    crossing = ride(estimator(kind), truth, NOMINAL, 91, from_s=6.0, until_s=9.0)
    for t_s, estimate in zip(crossing.t_s, crossing.estimates, strict=True):
        assert estimate.yaw_rad is not None
        assert -math.pi <= estimate.yaw_rad <= math.pi
        assert math.remainder(estimate.yaw_rad - truth.at(t_s)[2], math.tau) == pytest.approx(0.0, abs=0.05)
    assert rms(crossing.errors(truth)) < 0.05


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind is not EstimatorKind.LKF_REPORT])
def test_outlier_is_gated_and_counted(kind: EstimatorKind) -> None:
    chosen: Estimator = estimator(kind)
    good = [m for m in arrivals(straight(5.0), NOMINAL, 95) if m.t_ns <= now_ns(4.0)]
    memory = chosen.fuse(None, good)
    outlier = Measurement(
        t_ns=now_ns(4.05),
        quantity=Quantity.POSITION,
        value=straight(5.0).at(4.05)[0] + np.array([0.0, 8.0, 0.0]),
        covariance=4e-4 * np.eye(3),
    )
    after = chosen.fuse(memory, [outlier])
    one, other = chosen.estimate(memory, now_ns(4.1)), chosen.estimate(after, now_ns(4.1))
    assert one is not None
    assert other is not None
    assert other.position_enu_m == pytest.approx(one.position_enu_m, abs=1e-3)
    assert sum(estimator(kind).health(after).rejected) == 1


@pytest.mark.parametrize("kind", KINDS)
def test_vehicle_that_jumps_for_good_is_found_again(kind: EstimatorKind) -> None:
    truth, away = straight(5.0), straight(5.0)
    moved = replace(away, position=away.position + np.array([6.0, -9.0, 0.5]))
    measurements = [m for m in arrivals(truth, NOMINAL, 97) if m.t_ns <= now_ns(6.0)]
    measurements += [m for m in arrivals(moved, NOMINAL, 98) if now_ns(6.0) < m.t_ns <= now_ns(9.0)]
    chosen: Estimator = estimator(kind)
    memory = chosen.fuse(None, measurements[:1])
    for i in range(1, len(measurements), 4):
        memory = chosen.fuse(memory, measurements[i : i + 4])
    estimate = chosen.estimate(memory, now_ns(9.0))
    assert estimate is not None
    assert estimate.position_enu_m == pytest.approx(moved.at(9.0)[0], abs=0.3)
