"""A vehicle that turns on the spot: its heading follows its gyro, and no reading ends the filter."""

import math
from collections.abc import Callable
from typing import cast

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind, ImmConfig
from companion.core.data import Forecast, Measurement, Quantity
from companion.vehicle.estimator import DelayBuffer, EstimatorMemory
from companion.vehicle.filter_step import std_of
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_kernels import HEADING
from companion.vehicle.imm_numbers import Deck
from companion.vehicle.imm_spin import spun
from companion.vehicle.imm_state import ImmState
from companion.vehicle.spin import NO_SPIN, Spin, compared, passed, told
from link.frames.rotations import wrap_angle
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, Drive, Sensors, drive
from tests.companion.vehicle.rides import arrivals, estimator, now_ns, ride
from tests.companion.vehicle.test_standing import turning_on_the_spot

IMM = EstimatorKind.IMM
TURNS_S, TURNED_S, DONE_S = 5.0, 11.0, 15.0
PLACE = Measurement(t_ns=now_ns(0.0), quantity=Quantity.POSITION, value=np.zeros(3), covariance=1e-4 * np.eye(3))
TOLD = replace(NOMINAL, heading_std_rad=0.03)
GYRO_ALONE = replace(NOMINAL, heading_std_rad=0.0)


def yaw_error(truth: Drive, sensors: Sensors, seed: int) -> tuple[float, float]:
    """How far off the heading is after the turn, and what it is said to be, rad."""
    chosen = estimator(IMM)
    done = ride(chosen, truth, sensors, seed, from_s=DONE_S - 0.1, until_s=DONE_S)
    forecast = chosen.forecast(done.memory, now_ns(DONE_S), np.array([0.0]))
    assert forecast is not None
    assert forecast.yaw_rad is not None
    return wrap_angle(float(forecast.yaw_rad[0]) - truth.at(DONE_S)[2]), forecast.yaw_std_rad


def test_told_heading_is_as_good_after_a_turn_on_the_spot_as_is_said() -> None:
    found = np.array([yaw_error(turning_on_the_spot(), TOLD, seed) for seed in range(8)])
    assert np.abs(found[:, 0]).max() < 0.05
    assert np.mean((found[:, 0] / found[:, 1]) ** 2) < 3.0


def test_gyro_carries_a_heading_that_was_learnt_through_a_turn_on_the_spot() -> None:
    """Half a turn after a drive, by which the heading is known."""
    turns = drive(
        DONE_S + 1.0,
        lambda t: min(max(5.0 - 3.0 * (t - 2.0), 1e-6), 5.0),
        lambda t: 0.5e6 if TURNS_S < t < TURNED_S else 0.0,
    )
    found = np.array([yaw_error(turns, GYRO_ALONE, seed) for seed in range(4)])
    assert np.abs(found[:, 0]).max() < 0.3  # of 3 rad
    assert np.mean((found[:, 0] / found[:, 1]) ** 2) < 3.0


@pytest.mark.parametrize(("heading_std_rad", "moves"), [(0.1, True), (2.0, False)])
def test_turn_swings_the_antenna_about_the_pad_where_the_heading_is_known(
    heading_std_rad: float, *, moves: bool
) -> None:
    model = ImmModel(config=ImmConfig(), deck=Deck(antenna_to_pad_m=(1.5, 0.0, 0.0)))
    state = model.start(PLACE)
    means, covariances, weights = state.modes
    covariances = covariances.copy()
    covariances[:, HEADING, HEADING] = heading_std_rad**2
    state = replace(state, modes=(means, covariances, weights), spin=Spin(told_rad_s=1.0, left_s=0.5, is_believed=True))
    after = spun(state, 0.2, model.config, model.numbers)
    swung_m = 1.5 * np.array([1.0 - math.cos(0.2), -math.sin(0.2)])
    assert after.modes[0][:, :2] == pytest.approx(means[:, :2] + (swung_m if moves else 0.0))
    assert after.modes[0][:, HEADING] == pytest.approx(np.full(len(weights), 0.2))


@pytest.mark.parametrize(("t_s", "is_known"), [(4.9, True), (8.0, False), (13.0, True)])
def test_there_is_no_heading_to_land_by_while_the_vehicle_turns(t_s: float, *, is_known: bool) -> None:
    chosen = estimator(IMM)
    done = ride(chosen, turning_on_the_spot(), TOLD, 0, from_s=t_s - 0.1, until_s=t_s)
    forecast = chosen.forecast(done.memory, now_ns(t_s), np.array([0.0]))
    assert forecast is not None
    assert (forecast.yaw_rad is not None, forecast.turns_on_spot) == (is_known, not is_known)


def spin_of(memory: EstimatorMemory | None) -> float:
    state = cast("DelayBuffer[ImmState]", memory).newest.state
    assert isinstance(state, ImmState)
    return state.spin.told_rad_s


def test_car_that_departs_in_a_bend_does_not_turn_on_the_spot() -> None:
    chosen = estimator(IMM)
    departs = drive(16.0, lambda t: max(3.0 * (t - 8.0), 0.0), lambda t: 0.25 if t > 8.0 else 0.0)
    for t_s in np.arange(8.0, 11.0, 0.2):
        done = ride(chosen, departs, TOLD, 0, from_s=t_s - 0.1, until_s=t_s)
        assert spin_of(done.memory) == 0.0


@pytest.mark.parametrize("seed", range(4))
def test_rover_that_ends_a_tight_arc_and_speeds_up_has_not_turned_on_the_spot(seed: int) -> None:
    """Its curvature was 5 1/m, and what is left of it is to be learnt anew."""
    rover = drive(
        12.0, lambda t: 0.3 if t < 5.0 else min(0.3 + 1.5 * (t - 5.0), 4.0), lambda t: 5.0 if 2.0 < t < 5.0 else 0.0
    )
    chosen = estimator(IMM)
    for t_s in np.arange(5.4, 7.0, 0.2):
        done = ride(chosen, rover, TOLD, seed, from_s=t_s, until_s=t_s + 0.1)
        forecast = chosen.forecast(done.memory, now_ns(t_s), np.array([0.0]))
        assert forecast is not None
        assert forecast.yaw_rad is not None
        assert abs(wrap_angle(float(forecast.yaw_rad[0]) - rover.at(t_s)[2])) < 0.5


def test_one_that_has_turned_tightly_and_drives_off_does_not_stand_because_it_turns_no_more() -> None:
    """Its curvature was 7 1/m; the steering of what turns so is let go within 0.1 s."""
    forklift = drive(
        12.0,
        lambda t: 0.2 if t < 5.0 else min(0.2 + 1.5 * (t - 5.0), 3.0),
        lambda t: 7.0 * min(max(10.0 * (t - 3.0), 0.0), max(10.0 * (5.0 - t), 0.0), 1.0),
    )
    chosen = estimator(IMM)
    for seed in range(4):
        done = ride(chosen, forklift, TOLD, seed, from_s=5.3, until_s=6.5)
        assert np.linalg.norm(done.errors(forklift)[:, :2], axis=1).max() < 0.1


def parked(
    gyro_rad_s: Callable[[float], float],
    lasts_s: float,
    seed: int,
    *,
    gyro_std_rad_s: float = 0.003,
) -> list[Forecast]:
    """Return what is forecast, 50 times a second, of a parked vehicle that heads east and whose gyro tells this."""
    chosen, rng = estimator(IMM), np.random.default_rng(seed)
    memory: EstimatorMemory | None = None
    forecasts = []

    def told(quantity: Quantity, t_s: float, value: list[float], std: float) -> Measurement:
        noisy = np.array(value) + rng.normal(0.0, std, len(value))
        return Measurement(t_ns=now_ns(t_s), quantity=quantity, value=noisy, covariance=std**2 * np.eye(len(value)))

    for step in range(round(50 * lasts_s)):
        t_s = step / 50
        readings = [
            told(Quantity.HEADING, t_s, [0.0], 0.02),
            told(Quantity.YAW_RATE, t_s, [gyro_rad_s(t_s)], gyro_std_rad_s),
        ]
        if step % 5 == 0:
            readings.append(told(Quantity.POSITION, t_s, [0.0, 0.0, 0.0], 0.02))
            readings.append(told(Quantity.VELOCITY, t_s, [0.0, 0.0, 0.0], 0.05))
        memory = chosen.fuse(memory, readings)
        forecast = chosen.forecast(memory, now_ns(t_s), np.array([0.0, 1.0]))
        assert forecast is not None
        forecasts.append(forecast)
    return forecasts


@pytest.mark.parametrize("rate_rad_s", [0.5, 2.0, 6.0])
@pytest.mark.parametrize("std_rad_s", [0.001, 0.02])
@pytest.mark.parametrize("seed", range(3))
def test_gyro_that_contradicts_a_parked_vehicles_heading_ends_nothing(
    rate_rad_s: float, std_rad_s: float, seed: int
) -> None:
    """Such as one that tells degrees for radians."""
    forecasts = parked(lambda _: rate_rad_s, 6.0, seed, gyro_std_rad_s=std_rad_s)
    assert all(np.isfinite(forecast.position_std_m).all() for forecast in forecasts)


@pytest.mark.parametrize("rate_rad_s", [1.0, 3.0, 9.0])
def test_gyro_that_runs_away_for_a_second_leaves_the_told_heading_as_it_was(rate_rad_s: float) -> None:
    """At 9 rad/s it was 17 degrees off for a minute, and up to 140 meanwhile."""
    forecasts = parked(lambda t_s: rate_rad_s if 3.0 <= t_s < 4.0 else 0.0, 6.0, 1)[100:]
    yaws_rad = [wrap_angle(float(one.yaw_rad[0])) for one in forecasts if one.yaw_rad is not None]
    assert len(yaws_rad) > 0.9 * len(forecasts)
    assert np.abs(yaws_rad).max() < 0.06


@pytest.mark.parametrize("rate_rad_s", [0.5, 3.0, -9.0])
def test_heading_that_lags_behind_the_gyro_turns_along(rate_rad_s: float) -> None:
    spin, lags_s = NO_SPIN, 0.08
    for step in range(100):
        spin = passed(told(spin, rate_rad_s), 0.02)
        spin = compared(spin, rate_rad_s * max(0.02 * step - lags_s, 0.0), 0.02**2)
    assert spin.is_believed
    assert not spin.is_denied


def test_one_yaw_rate_that_no_vehicle_turns_by_is_an_outlier() -> None:
    forecasts = parked(lambda t_s: 0.5 if t_s in (4.0, 6.0) else 0.0, 8.0, 1)[100:]
    yaws_rad = [forecast.yaw_rad[0] for forecast in forecasts if forecast.yaw_rad is not None]
    assert len(yaws_rad) == len(forecasts)
    assert np.abs(yaws_rad).max() < 0.06


def test_one_yaw_rate_of_a_slow_gyro_turns_no_heading_that_nothing_else_tells() -> None:
    """The heading is learnt on the way there."""
    stops = drive(20.0, lambda t: min(max(5.0 - 3.0 * (t - 4.0), 1e-6), 5.0), lambda _: 0.0)
    chosen = estimator(IMM)
    readings = list(arrivals(stops, GYRO_ALONE, 3))
    memory: EstimatorMemory | None = None
    for one in readings:
        is_outlier = one.quantity is Quantity.YAW_RATE and now_ns(11.95) < one.t_ns <= now_ns(12.05)
        if one.t_ns < now_ns(14.0):
            memory = chosen.fuse(memory, [replace(one, value=np.array([3.0])) if is_outlier else one])
    forecast = chosen.forecast(memory, now_ns(14.0), np.array([0.0]))
    assert forecast is not None
    assert forecast.yaw_rad is not None
    assert abs(wrap_angle(float(forecast.yaw_rad[0]) - stops.at(14.0)[2])) < 0.1


@pytest.mark.parametrize("heading_std_rad", [0.03, 0.1])
def test_turn_on_the_spot_is_followed_whatever_the_told_heading_scatters(heading_std_rad: float) -> None:
    sensors = replace(TOLD, heading_std_rad=heading_std_rad)
    found = [yaw_error(turning_on_the_spot(), sensors, seed)[0] for seed in range(4)]
    assert np.abs(found).max() < 0.12


def test_variance_that_contradictions_have_made_negative_is_told_as_none() -> None:
    assert math.isnan(std_of(-1e-9))
    assert std_of(0.04) == pytest.approx(0.2)


def test_a_forecast_over_a_negative_variance_is_told_as_no_number() -> None:
    model = ImmModel(config=ImmConfig())
    state: ImmState = model.start(PLACE)
    means, covariances, weights = state.modes
    covariances = covariances.copy()
    covariances[:, HEADING, HEADING] = -1e-6
    forecast = model.forecast(replace(state, modes=(means, covariances, weights)), now_ns(0.0), np.array([0.0, 1.0]))
    assert math.isnan(forecast.yaw_std_rad)
