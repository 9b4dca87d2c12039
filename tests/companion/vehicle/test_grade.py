"""The height of the road: it changes with the distance driven, and the vehicle pitches with its grade."""

import math

import numpy as np
import pytest
from scipy import stats

from companion.config.estimation import EstimatorConfig, EstimatorKind, ImmConfig, ReceiversConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle import imm_kernels as kernels
from companion.vehicle import imm_noise as noises
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.imm_swing import PITCH, SIZE
from companion.vehicle.pad import pad_path
from link.messages import PadGeometry
from tests.companion.vehicle.drives import ANTENNA_TO_PAD_M, NOMINAL, Drive, climb
from tests.companion.vehicle.rides import arrivals, estimator, now_ns, ride
from tests.companion.vehicle.test_imm_kernels import HEAVE, NOISE, TAU_S, TILT, TILT_NOISE

SAME_FRAME = EstimatorConfig(
    imm=ImmConfig(receivers=ReceiversConfig(frame_offset_std_m=0.0, frame_offset_walk_m2_s=0.0))
)
PAD = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=ANTENNA_TO_PAD_M)
VERTICAL = np.array([2, 5])
GRADES_AND_SPEEDS = [(0.03, 3.0), (0.12, 3.0), (0.08, 8.0), (-0.08, 8.0), (0.03, 12.0), (0.08, 12.0)]


def test_height_is_that_of_a_vertical_curve() -> None:
    x = np.zeros(SIZE)
    x[2:4], x[7] = 8.0 * np.array([math.cos(0.4), math.sin(0.4)]), 0.4
    x[8], x[9], x[kernels.BEND] = 2.0, 0.03, 0.004
    after, _ = kernels.advance(x, 0.1, TAU_S, HEAVE, TILT)
    assert after[8] == pytest.approx(2.0 + 0.03 * 0.8 + 0.5 * 0.004 * 0.8**2)
    assert after[9] == pytest.approx(0.03 + 0.004 * 0.8)


def test_vehicle_that_reverses_goes_down_what_it_has_climbed() -> None:
    x = np.zeros(SIZE)
    x[2], x[9] = -2.0, 0.1
    assert kernels.advance(x, 0.1, TAU_S, HEAVE, TILT)[0][8] == pytest.approx(-0.02)


def test_standing_vehicle_neither_climbs_nor_heaves() -> None:
    Q = noises.process_noise(np.zeros(SIZE), 0.1, NOISE, 1e-4 * np.eye(3), TILT_NOISE)
    assert np.abs(Q[[9, 10, 11, kernels.BEND]]).max() == 0.0
    assert Q[8, 8] == pytest.approx(NOISE[7] * 0.1)  # how far the drone errs about itself


@pytest.mark.parametrize("speed_m_s", [1.0, 8.0, 25.0])
def test_change_of_the_grade_stays_within_what_roads_are_built_with(speed_m_s: float) -> None:
    x = np.zeros(SIZE)
    x[2] = speed_m_s
    left, fed = noises.bend_step(x, 0.1, NOISE)
    std = math.sqrt(fed / (1.0 - left**2))
    assert std <= NOISE[noises.BEND_STD] * (1.0 + 1e-9)
    assert std * speed_m_s**2 <= NOISE[noises.BEND_ACCELERATION_STD] * (1.0 + 1e-9)


def test_noise_of_the_grade_is_that_of_many_small_steps() -> None:
    x = np.zeros(SIZE)
    x[2] = 8.0
    rows = np.array([8, 9, kernels.BEND])
    whole = noises.process_noise(x, 0.02, NOISE, np.zeros((3, 3)), TILT_NOISE)[np.ix_(rows, rows)]
    _, F = kernels.advance(x, 0.0004, TAU_S, HEAVE, TILT)
    once = noises.process_noise(x, 0.0004, NOISE, np.zeros((3, 3)), TILT_NOISE)
    parts = np.zeros_like(once)
    for _ in range(50):
        parts = F @ parts @ F.T + once
    scale = np.sqrt(np.diag(whole))
    assert np.abs((whole - parts[np.ix_(rows, rows)]) / np.outer(scale, scale)).max() < 0.02


@pytest.mark.parametrize(("grade", "speed_m_s"), GRADES_AND_SPEEDS)
def test_height_on_a_climb_is_as_sure_as_is_stated(grade: float, speed_m_s: float) -> None:
    truth = climb(grade, speed_m_s)
    nees, errors_m = [], []
    for seed in range(4):
        done = ride(estimator(EstimatorKind.IMM, SAME_FRAME), truth, NOMINAL, 400 + seed, from_s=6.0, rate_hz=2.0)
        for t_s, estimate in zip(done.t_s, done.estimates, strict=True):
            error = np.concatenate([estimate.position_enu_m, estimate.velocity_enu_m_s])
            error = (error - np.concatenate(truth.at(t_s)[:2]))[VERTICAL]
            nees.append(error @ np.linalg.solve(estimate.covariance[np.ix_(VERTICAL, VERTICAL)], error))
        forecast = estimator(EstimatorKind.IMM, SAME_FRAME).forecast(
            done.memory, done.estimates[-1].t_ns, np.array([0.0, 0.1])
        )
        assert forecast is not None
        errors_m.append(pad_path(forecast, PAD).position_enu_m[0, 2] - truth.pad_at(float(done.t_s[-1]))[2])
    assert np.sum(nees) < stats.chi2.ppf(0.975, 2 * len(nees))
    assert np.abs(errors_m).max() < 0.06


def _told_pitches(truth: Drive, until_s: float, seed: int) -> list[Measurement]:
    """What an inertial unit tells fifty times a second of a body that follows its road."""
    rng, variances = np.random.default_rng(seed), np.diag([0.0035**2, 0.0035**2, 0.009**2, 0.009**2])
    times = np.arange(0.0, until_s, 0.02)
    grade = np.array([truth.at(t)[1][2] / np.hypot(*truth.at(t)[1][:2]) for t in times.tolist()])
    pitch = np.stack([np.zeros(len(times)), -grade, np.zeros(len(times)), -np.gradient(grade, times)], axis=1)
    noise = rng.standard_normal(pitch.shape) * np.sqrt(np.diag(variances))
    return [
        Measurement(t_ns=now_ns(t), quantity=Quantity.TILT, value=value, covariance=variances)
        for t, value in zip(times.tolist(), pitch + noise, strict=True)
    ]


@pytest.mark.parametrize(("grade", "speed_m_s"), [(0.12, 6.0), (0.12, 12.0), (-0.12, 12.0)])
@pytest.mark.parametrize("after_s", [0.3, 0.6, 2.0])
def test_ramp_that_the_vehicles_unit_tells_is_no_swing_of_its_body(
    grade: float, speed_m_s: float, after_s: float
) -> None:
    truth = climb(grade, speed_m_s, from_s=8.0)
    late_m_s = []
    for seed in range(4):
        told = [one for one in arrivals(truth, NOMINAL, 500 + seed) if one.t_ns < now_ns(8.0 + after_s - 0.06)]
        chosen = estimator(EstimatorKind.IMM, SAME_FRAME)
        memory = chosen.fuse(None, [*told, *_told_pitches(truth, 8.0 + after_s, seed)])
        forecast = chosen.forecast(memory, now_ns(8.0 + after_s), np.array([0.0, 0.1]))
        assert forecast is not None
        late_m_s.append(truth.at(8.0 + after_s)[1][2] - forecast.velocity_enu_m_s[0, 2])
    assert np.abs(np.mean(late_m_s)) < 0.2 * abs(grade) * speed_m_s


def test_pitch_rate_that_is_told_is_the_bodys_on_a_road_that_bends() -> None:
    x = np.zeros(SIZE)
    x[2:4], x[7] = 8.0 * np.array([math.cos(0.4), math.sin(0.4)]), 0.4
    x[9], x[kernels.BEND], x[PITCH], x[PITCH + 1] = 0.03, 0.004, 0.01, -0.2
    told, H = sensors.read_tilt(x)
    assert told == pytest.approx([0.0, 0.01 - 0.03, 0.0, -0.2 - 0.004 * 8.0])
    for i in range(SIZE):
        step = 1e-6 * np.eye(SIZE)[i]
        slope = (sensors.read_tilt(x + step)[0] - sensors.read_tilt(x - step)[0]) / 2e-6
        assert H[:, i] == pytest.approx(slope, abs=1e-6)
