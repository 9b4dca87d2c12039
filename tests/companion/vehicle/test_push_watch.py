"""An acceleration is believed where the speed does what it tells; axes turned about the vertical are told."""

import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

from companion.core.data import GRAVITY_M_S2, Quantity
from companion.vehicle.imu_inputs import imu_measurements
from companion.vehicle.unit_watch import UnitWatch
from link.frames.rotations import quaternion_from_roll_pitch_yaw
from link.messages import Matrix3, Vector3, VehicleImu
from link.records import replace

PERIOD_S = 0.02
YAW_RAD = 0.6
LEVEL = (1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4)
HEADING_ONLY = (3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1e-4)


def town(t_s: float) -> float:
    """The acceleration of a car that is driven to 8 m/s in 4 s, on, and stopped in 2 s, again and again."""
    phase_s = t_s % 16.0
    if phase_s < 4.0:
        return 2.0
    return -4.0 if 9.0 <= phase_s < 11.0 else 0.0


def brake(t_s: float) -> float:
    return -4.0 if 9.0 <= t_s < 10.5 else 0.0


def turned(by_rad: float) -> Callable[[Vector3], Vector3]:
    c, s = math.cos(by_rad), math.sin(by_rad)
    return lambda force: (c * force[0] - s * force[1], s * force[0] + c * force[1], force[2])


def driven(
    accelerates: Callable[[float], float],
    told: Callable[[Vector3], Vector3],
    *,
    lag_s: float = 0.0,
    grade: Callable[[float], float] = lambda _: 0.0,
    covariance: Matrix3 = LEVEL,
    begins_m_s: float = 0.0,
    std_m_s: float = 0.05,
    forwards: float = 1.0,
) -> UnitWatch:
    """What is thought of a unit after 32 s, whose receiver tells velocities that are older than their stamps."""
    unit, rng, times = UnitWatch(), np.random.default_rng(3), np.arange(0.0, 32.0, PERIOD_S)
    speeds = begins_m_s + forwards * np.cumsum([accelerates(t_s) for t_s in times]) * PERIOD_S
    for index, t_s in enumerate(times.tolist()):
        pitch_rad = -math.atan(grade(t_s))
        tells_tilt = covariance is LEVEL
        along_m_s2 = forwards * accelerates(t_s) - GRAVITY_M_S2 * math.sin(pitch_rad) + 0.2
        imu = VehicleImu(
            t_ns=round(t_s * 1e9),
            orientation_wxyz=quaternion_from_roll_pitch_yaw(0.0, pitch_rad if tells_tilt else 0.0, YAW_RAD),
            orientation_covariance_rad2=covariance,
            specific_force_flu_m_s2=told((along_m_s2, -0.1, GRAVITY_M_S2 * math.cos(pitch_rad))),
        )
        measured = [one.quantity for one in imu_measurements(imu, unit)]
        assert (Quantity.ACCELERATION in measured) is unit.believes_acceleration
        if index % 5 == 0:
            speed_m_s = float(np.interp(t_s - lag_s, times, speeds)) + std_m_s * rng.standard_normal()
            velocity = (speed_m_s * math.cos(YAW_RAD), speed_m_s * math.sin(YAW_RAD), 0.0)
            unit.pushes.take_velocity(imu.t_ns, velocity, std_m_s**2)
    return unit


@pytest.mark.parametrize("lag_s", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("covariance", [LEVEL, HEADING_ONLY])
@pytest.mark.parametrize("forwards", [1.0, -1.0])
def test_forces_by_which_the_speed_changes_are_believed(lag_s: float, covariance: Matrix3, forwards: float) -> None:
    assert driven(town, turned(0.0), lag_s=lag_s, covariance=covariance, forwards=forwards).doubts() == {}


@pytest.mark.parametrize("by_rad", [0.5 * math.pi, math.pi, -0.5 * math.pi])
@pytest.mark.parametrize("covariance", [LEVEL, HEADING_ONLY])
def test_axes_that_are_turned_about_the_vertical_are_told(by_rad: float, covariance: Matrix3) -> None:
    why = driven(town, turned(by_rad), covariance=covariance).doubts()["acceleration"]
    assert "axes (x is ahead)" in why
    assert len(why) <= 90  # more is cut off where it is told


def test_one_hard_brake_tells_of_a_unit_that_knows_its_tilt() -> None:
    assert driven(brake, turned(math.pi), begins_m_s=7.0).doubts().keys() == {"acceleration"}
    assert driven(brake, turned(0.0), begins_m_s=7.0).doubts() == {}


def test_grade_that_a_unit_does_not_tell_is_no_contradiction() -> None:
    """It drives off down a steep street, where gravity takes most of the push away."""

    def once(t_s: float) -> float:
        return 1.3 if t_s < 6.0 else 0.0

    assert driven(once, turned(0.0), grade=lambda _: -0.12, covariance=HEADING_ONLY).doubts() == {}


def test_even_driving_shows_nothing() -> None:
    assert driven(lambda _: 0.0, turned(math.pi), begins_m_s=7.0, std_m_s=0.3).doubts() == {}


def test_gaps_and_stamps_that_go_back_show_nothing() -> None:
    unit = UnitWatch()
    for index, t_s in enumerate((0.0, 5.0, 4.0, 9.0, 9.0, 20.0)):
        unit.pushes.take_force(round(t_s * 1e9), -9.0, YAW_RAD, is_level=True)
        unit.pushes.take_velocity(round(t_s * 1e9), (9.0 * index, 0.0, 0.0), 0.01)
    assert unit.doubts() == {}


@pytest.mark.parametrize("wrong", [1e300, -1e300, 1e4, 90.0])
@pytest.mark.parametrize("of_force", [True, False], ids=["force", "velocity"])
def test_one_absurd_number_says_nothing_of_the_others(wrong: float, *, of_force: bool) -> None:
    unit, speed_m_s = UnitWatch(), 0.0
    for index in range(1600):
        t_ns, force_m_s2 = index * 20_000_000, town(index * PERIOD_S)
        speed_m_s += force_m_s2 * PERIOD_S
        is_wrong = index == 500
        told_m_s2 = wrong if is_wrong and of_force else force_m_s2
        unit.pushes.take_force(t_ns, told_m_s2, 0.0, is_level=True)
        if index % 5 == 0:
            told_m_s = wrong if is_wrong and not of_force else speed_m_s
            unit.pushes.take_velocity(t_ns, (told_m_s, 0.0, 0.0), 0.01)
        assert unit.pushes.is_believed


def test_one_force_too_large_to_be_turned_says_nothing_of_the_others() -> None:
    unit, speed_m_s = UnitWatch(), 0.0
    tilted = (-0.2702, 0.4332, -0.7904, 0.3386)
    for index in range(800):
        force_m_s2 = town(index * PERIOD_S)
        speed_m_s += force_m_s2 * PERIOD_S
        imu = VehicleImu(
            t_ns=index * 20_000_000,
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            orientation_covariance_rad2=LEVEL,
            specific_force_flu_m_s2=(force_m_s2, 0.0, GRAVITY_M_S2),
        )
        if index == 101:
            imu = replace(imu, orientation_wxyz=tilted, specific_force_flu_m_s2=(1e308, 1.7e308, 1e308))
        with np.errstate(over="ignore", invalid="ignore"):
            imu_measurements(imu, unit)
        if index % 5 == 0:
            unit.pushes.take_velocity(imu.t_ns, (speed_m_s, 0.0, 0.0), 0.01)
        assert unit.pushes.is_believed


@pytest.mark.parametrize("kind", ["forces", "velocities"])
def test_what_comes_alone_for_hours_is_not_kept(kind: str) -> None:
    unit = UnitWatch()

    def size_after(begins_s: int, ends_s: int) -> int:
        for t_s in range(begins_s, ends_s):
            if kind == "forces":
                unit.pushes.take_force(t_s * 100_000_000, 1.0, YAW_RAD, is_level=True)
            else:
                unit.pushes.take_velocity(t_s * 100_000_000, (9.0, 0.0, 0.0), 0.01)
        return len(pickle.dumps(unit))

    assert size_after(100, 200) == size_after(200, 5000)
