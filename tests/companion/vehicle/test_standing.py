"""The heading of a vehicle that stands, reverses or turns on the spot; without a heading sensor, that of a car."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind, ImmConfig, ReceiversConfig
from companion.core.data import Array
from companion.vehicle.imm_judgement import align_modes
from companion.vehicle.imm_kernels import HEADING
from companion.vehicle.imm_swing import SIZE
from link.frames.rotations import wrap_angle
from link.records import replace
from tests.companion.vehicle.drives import ANTENNA_TO_PAD_M, NOMINAL, Drive, drive, pad_centre
from tests.companion.vehicle.rides import Ride, arrivals, estimator, now_ns, ride

FIX_AND_VELOCITY = replace(NOMINAL, heading_std_rad=0.0, yaw_rate_std_rad_s=0.0)
SAME_FRAME = EstimatorConfig(
    imm=ImmConfig(receivers=ReceiversConfig(frame_offset_std_m=0.0, frame_offset_walk_m2_s=0.0))
)
STOPS_S, ENDS_S = 12.0, 40.0


def stopping() -> Drive:
    """7 m/s, a brake of 6 m/s^2 at 10 s, then half a minute at rest."""
    return drive(ENDS_S + 1.0, lambda t: min(max(7.0 - 6.0 * (t - 10.0), 0.0), 7.0), lambda _: 0.0)


def stopping_in_a_bend() -> Drive:
    """8 m/s, and from 8 s on a brake of 2 m/s^2 in a bend of 12.5 m."""
    return drive(16.0, lambda t: min(max(8.0 - 2.0 * (t - 8.0), 0.0), 8.0), lambda t: 0.08 if t > 8.0 else 0.0)


def turning_on_the_spot() -> Drive:
    """At rest but for half a turn per six seconds from 5 s to 11 s; the pad's centre stays where it is."""
    turns = drive(16.0, lambda _: 1e-6, lambda t: 0.5e6 if 5.0 < t < 11.0 else 0.0)
    arm = np.array([pad_centre(np.zeros(3), yaw) for yaw in turns.yaw])
    position = pad_centre(turns.position[0], float(turns.yaw[0])) - arm
    return replace(turns, position=position, velocity=np.gradient(position, turns.length_s / (len(arm) - 1), axis=0))


def estimated(truth: Drive, seed: int, *, with_imu: bool) -> Ride:
    sensors = NOMINAL if with_imu else FIX_AND_VELOCITY
    return ride(estimator(EstimatorKind.IMM, SAME_FRAME), truth, sensors, seed, ahead_s=0.5)


def yaws(done: Ride, from_s: float) -> Array:
    """Return the headings from then on; all must be known."""
    told = [e.yaw_rad for t_s, e in zip(done.t_s, done.estimates, strict=True) if t_s >= from_s]
    assert None not in told
    return np.unwrap(np.array(told, dtype=float))


@pytest.mark.parametrize("seed", range(4))
def test_standing_vehicle_keeps_the_heading_with_which_it_stopped(seed: int) -> None:
    yaw = yaws(estimated(stopping(), seed, with_imu=False), STOPS_S)
    assert np.abs(yaw - yaw[0]).max() < math.radians(3.0)


@pytest.mark.parametrize("with_imu", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_vehicle_that_brakes_in_a_bend_is_not_forecast_to_drive_backwards(seed: int, *, with_imu: bool) -> None:
    waiting = arrivals(stopping_in_a_bend(), NOMINAL if with_imu else FIX_AND_VELOCITY, seed)[::-1]
    chosen, memory, backwards_m_s = estimator(EstimatorKind.IMM, SAME_FRAME), None, []
    for t_s in np.arange(9.5, 14.0, 0.1):
        batch = []
        while waiting and waiting[-1].t_ns <= now_ns(t_s):
            batch.append(waiting.pop())
        memory = chosen.fuse(memory, batch)
        forecast = chosen.forecast(memory, now_ns(t_s), np.arange(0.0, 4.01, 0.2))
        assert forecast is not None
        assert forecast.yaw_rad is not None
        east_m_s, north_m_s, _ = forecast.velocity_enu_m_s.T
        ahead_m_s = np.cos(forecast.yaw_rad) * east_m_s + np.sin(forecast.yaw_rad) * north_m_s
        backwards_m_s.append(max(-ahead_m_s))
    assert max(backwards_m_s) < 0.3  # it was 3 to 4.5


@pytest.mark.parametrize("seed", range(4))
def test_vehicle_that_reverses_is_forecast_to_go_on_doing_so(seed: int) -> None:
    truth = drive(16.0, lambda t: min(max(-2.0, 4.0 - 1.0 * max(t - 5.0, 0.0)), 4.0), lambda _: 0.0)
    done = ride(estimator(EstimatorKind.IMM, SAME_FRAME), truth, NOMINAL, seed, from_s=13.0, ahead_s=1.0)
    moved_m = done.ahead[:, :2] - np.array([one.position_enu_m[:2] for one in done.estimates])
    assert np.hypot(*moved_m.T) == pytest.approx(2.0, abs=0.4)


def test_pad_of_a_vehicle_that_stands_for_long_is_not_forgotten() -> None:
    truth = stopping()
    chosen = estimator(EstimatorKind.IMM, SAME_FRAME)
    done = ride(chosen, truth, FIX_AND_VELOCITY, 5, from_s=STOPS_S, ahead_s=0.5)
    stopped, later = (
        chosen.forecast(done.memory, e.t_ns, np.array([0.0, 0.1])) for e in (done.estimates[-5], done.estimates[-1])
    )
    assert stopped is not None
    assert later is not None
    assert later.yaw_std_rad < math.radians(8.0)
    assert np.max(later.position_std_m[0, :2]) == pytest.approx(
        math.hypot(*ANTENNA_TO_PAD_M[:2]) * later.yaw_std_rad, rel=0.5
    )


def test_parked_vehicle_that_never_drove_has_no_heading() -> None:
    done = estimated(drive(20.0, lambda _: 0.0, lambda _: 0.0), 6, with_imu=False)
    assert {e.yaw_rad for e in done.estimates} == {None}


@pytest.mark.parametrize("with_imu", [False, True])
def test_car_that_reverses_keeps_its_heading(with_imu: bool) -> None:
    truth = drive(20.0, lambda t: 3.0 if t < 6.0 else 0.0 if t < 10.0 else -2.0, lambda _: 0.0)
    yaw = yaws(estimated(truth, 7, with_imu=with_imu), 8.0)
    assert np.abs(yaw - truth.yaw[0]).max() < math.radians(15.0)
    assert abs(wrap_angle(yaw[-1] - truth.yaw[-1])) < math.radians(5.0)


@pytest.mark.parametrize(("radius_m", "speed_m_s", "is_car"), [(1.5, 1.2, False), (6.0, 4.0, True)])
def test_heading_of_what_turns_tighter_than_a_car_is_unknown_without_a_sensor(
    radius_m: float, speed_m_s: float, *, is_car: bool
) -> None:
    """It is learnt from the course as a car's, which a rover that turns about its own middle is not."""
    truth = drive(30.0, lambda _: speed_m_s, lambda t: 0.0 if t < 10.0 else 1.0 / radius_m)
    done = estimated(truth, 5, with_imu=False)
    forecast = estimator(EstimatorKind.IMM, SAME_FRAME).forecast(
        done.memory, done.estimates[-1].t_ns, np.array([0.0, 0.2])
    )
    assert forecast is not None
    assert (forecast.yaw_rad is not None) is is_car


@pytest.mark.parametrize(("off_rad", "told", "is_kept"), [(0.5, 0.0, True), (1.3, 0.0, False), (1.3, 1.0, True)])
def test_heading_that_only_the_course_told_is_lost_where_the_vehicle_seems_to_go_sideways(
    off_rad: float, told: float, *, is_kept: bool
) -> None:
    """Else it would turn on until the vehicle seems to go backwards, and a pad on a long arm with it."""
    means = np.zeros((1, SIZE))
    means[0, [2, HEADING]] = 6.0, off_rad
    covariances = 1e-3 * np.eye(SIZE)[None]
    _, after = align_modes(means, covariances, np.array([1.0, 0.09, 0.25, told]))
    assert bool(after[0, HEADING, HEADING] <= covariances[0, HEADING, HEADING]) is is_kept
    assert np.linalg.eigvalsh(after[0]).min() > 0.0


def test_rover_that_turns_on_the_spot_is_followed_by_its_heading_sensor() -> None:
    truth = turning_on_the_spot()
    done = estimated(truth, 8, with_imu=True)
    expected = np.array([truth.at(t_s)[2] for t_s in done.t_s])
    assert np.abs(yaws(done, 0.0) - expected).max() < math.radians(6.0)
