"""A yaw rate is believed where the heading turns by it: other units and the other sign are told, and not measured."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from companion.core.data import Quantity
from companion.vehicle.imu_inputs import imu_measurements
from companion.vehicle.unit_watch import UnitWatch
from link.frames.rotations import quaternion_from_roll_pitch_yaw
from link.messages import VehicleImu

PERIOD_S = 0.02


def street(t_s: float) -> float:
    """How fast a car turns that drives bends of 5 s to the left and to the right, 0.25 rad/s, and straights between."""
    return (0.25, 0.0, -0.25, 0.0)[int(t_s / 5.0) % 4]


def driven(
    rate: Callable[[float], float],
    *,
    told: Callable[[float, float], float],
    noise_rad: float = 0.0175,
    lasts_s: float = 30.0,
) -> UnitWatch:
    """What is thought of a unit that tells a rate of time and true rate."""
    unit, yaw_rad, rng = UnitWatch(), 3.0, np.random.default_rng(1)
    for index in range(round(lasts_s / PERIOD_S)):
        t_s = index * PERIOD_S
        yaw_rad += rate(t_s) * PERIOD_S
        imu = VehicleImu(
            t_ns=round(t_s * 1e9),
            orientation_wxyz=quaternion_from_roll_pitch_yaw(0.0, 0.0, yaw_rad + noise_rad * rng.standard_normal()),
            orientation_covariance_rad2=(3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, noise_rad**2),
            angular_velocity_flu_rad_s=(0.0, 0.0, told(t_s, rate(t_s))),
        )
        measured = [one.quantity for one in imu_measurements(imu, unit)]
        assert (Quantity.YAW_RATE in measured) is unit.turns.is_believed
        assert Quantity.HEADING in measured
    return unit


@pytest.mark.parametrize("noise_rad", [0.0, 0.0175, 0.1])
def test_rate_by_which_the_heading_turns_is_believed(noise_rad: float) -> None:
    assert driven(street, told=lambda _, rate: rate + 0.02, noise_rad=noise_rad).doubts() == {}


@pytest.mark.parametrize("factor", [-1.0, math.degrees(1.0), 1.0 / 4.0 * 10.0])
def test_rate_in_other_units_or_of_the_other_sign_is_told(factor: float) -> None:
    why = driven(street, told=lambda _, rate: factor * rate).doubts()["yaw rate"]
    assert "rad/s, sign" in why
    assert len(why) <= 90  # more is cut off where it is told


def test_rates_of_the_tilt_are_as_little_believed_as_that_of_the_heading() -> None:
    imu = VehicleImu(
        t_ns=1,
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        orientation_covariance_rad2=(1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4),
        angular_velocity_flu_rad_s=(0.5, 0.6, 0.7),
    )
    for unit, says_something in ((UnitWatch(), True), (driven(street, told=lambda _, rate: -rate), False)):
        (tilt,) = (one for one in imu_measurements(imu, unit) if one.quantity is Quantity.TILT)
        assert bool(tilt.covariance[2, 2] < 1.0) is says_something


def test_rate_that_runs_away_for_a_second_is_believed_again() -> None:
    unit = driven(street, told=lambda t_s, rate: 9.0 if 7.0 < t_s < 8.0 else rate)
    assert unit.doubts() == {}


def test_straight_shows_nothing() -> None:
    assert driven(lambda _: 0.0, told=lambda _, __: 0.0, noise_rad=0.1).doubts() == {}


def test_gaps_and_stamps_that_go_back_show_nothing() -> None:
    unit = UnitWatch()
    for index in range(100):
        unit.turns.take((index % 3) * 10**9, 0.3 * index, 1e-4, 5.0)
    assert unit.doubts() == {}
