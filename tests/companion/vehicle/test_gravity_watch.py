"""An accelerometer is believed where it shows gravity, or none, and its reading is that along the heading."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.data import Quantity
from companion.vehicle.gravity_watch import GravityWatch
from companion.vehicle.imu_inputs import imu_measurements
from companion.vehicle.inputs import plausible
from companion.vehicle.unit_watch import UnitWatch
from link.frames.rotations import conjugate, quaternion_from_roll_pitch_yaw, rotate
from link.messages import Matrix3, Vector3, VehicleImu

PERIOD_S = 0.02
G = 9.80665


def felt(*forces: Vector3) -> GravityWatch:
    """What is thought of a unit that has told `forces` at 50 Hz."""
    watch = GravityWatch()
    for index, force in enumerate(forces):
        watch.take(round(index * PERIOD_S * 1e9), force, None)
    return watch


def unit_of(gravity: GravityWatch) -> UnitWatch:
    unit = UnitWatch()
    unit.gravity = gravity
    return unit


def upright() -> UnitWatch:
    """A unit that is believed."""
    return unit_of(felt(*[(0.0, 0.0, G)] * 60))


def swaying(rise_m_s2: float, brake_m_s2: float) -> list[Vector3]:
    """8 s of a body that bounces at 1.5 Hz and brakes for the last 3 s, with gravity."""
    return [
        (-brake_m_s2 * (index > 250), 0.3, G + rise_m_s2 * math.sin(2.0 * math.pi * 1.5 * index * PERIOD_S))
        for index in range(400)
    ]


@given(roll=st.floats(-0.3, 0.3), pitch=st.floats(-0.3, 0.3), yaw=st.floats(-3.1, 3.1), braking=st.floats(0.0, 9.0))
def test_acceleration_is_without_gravity_where_the_attitude_is_told(
    roll: float, pitch: float, yaw: float, braking: float
) -> None:
    attitude = quaternion_from_roll_pitch_yaw(roll, pitch, yaw)
    felt = rotate(conjugate(attitude), (-braking * math.cos(yaw), -braking * math.sin(yaw), 9.80665))
    imu = VehicleImu(t_ns=1, orientation_wxyz=attitude, specific_force_flu_m_s2=felt)
    _, acceleration = imu_measurements(imu, upright())
    assert acceleration.quantity is Quantity.ACCELERATION
    assert acceleration.value[0] == pytest.approx(-braking, abs=1e-9)


def test_acceleration_without_an_attitude_is_what_is_felt_forward() -> None:
    (acceleration,) = imu_measurements(VehicleImu(t_ns=1, specific_force_flu_m_s2=(-2.5, 0.4, 9.7)), upright())
    assert acceleration.value.tolist() == [-2.5]


def test_accelerometer_at_the_noise_of_its_data_sheet_is_not_better_than_the_body_that_it_is_on() -> None:
    at_rest: Matrix3 = (4e-4, 0.0, 0.0, 0.0, 4e-4, 0.0, 0.0, 0.0, 4e-4)
    imu = VehicleImu(t_ns=1, specific_force_flu_m_s2=(0.1, 0.0, 9.8), specific_force_covariance_m2_s4=at_rest)
    (acceleration,) = imu_measurements(imu, upright())
    assert 0.3**2 <= plausible(acceleration).covariance[0, 0] < 0.31**2


def test_acceleration_is_measured_once_a_second_of_it_has_shown_gravity() -> None:
    imu = VehicleImu(t_ns=1, specific_force_flu_m_s2=(-2.5, 0.4, 9.7))
    young = felt(*[(0.0, 0.0, G)] * 40)
    assert imu_measurements(imu, unit_of(young)) == ()
    assert young.doubt is None
    assert len(imu_measurements(imu, upright())) == 1


@pytest.mark.parametrize("gravity", [1.0, 0.0])
@pytest.mark.parametrize("rise_m_s2", [0.0, 5.0])
def test_unit_on_a_body_that_shakes_and_brakes_is_believed(rise_m_s2: float, gravity: float) -> None:
    forces = [(x, y, z - (1.0 - gravity) * G) for x, y, z in swaying(rise_m_s2, 8.0)]
    assert felt(*forces).is_believed


def test_cheap_unit_without_a_calibration_is_believed() -> None:
    assert felt(*[(0.5, -0.5, 1.03 * G + 0.08 * G)] * 100).is_believed


@pytest.mark.parametrize(
    "told",
    [
        lambda x, y, z: (x / G, y / G, z / G),
        lambda x, y, z: (10.0 * x, 10.0 * y, 10.0 * z),
        lambda x, y, z: (1e3 * x / G, 1e3 * y / G, 1e3 * z / G),
        lambda x, y, z: (-x, -y, -z),
        lambda x, y, z: (x, -y, -z),
        lambda x, y, z: (z, y, x),
        lambda x, y, z: (x, z, y),
    ],
    ids=["g", "ten times", "mg", "sign", "down", "x and z", "y and z"],
)
def test_other_units_and_axes_are_told_and_not_measured(told: Callable[[float, float, float], Vector3]) -> None:
    watch = felt(*(told(*force) for force in swaying(2.0, 4.0)))
    assert imu_measurements(VehicleImu(t_ns=1, specific_force_flu_m_s2=told(-4.0, 0.0, G)), unit_of(watch)) == ()
    assert watch.doubt is not None
    assert "axes (FLU)" in watch.doubt
    assert len(watch.doubt) <= 90  # more is cut off where it is told


def test_mean_acceleration_is_told_as_it_is_felt_along_the_heading() -> None:
    attitude = quaternion_from_roll_pitch_yaw(0.0, -0.1, 2.0)
    watch = GravityWatch()
    for index in range(100):
        watch.take(index * 20_000_000, rotate(conjugate(attitude), (0.0, 0.0, -G)), attitude)
    assert watch.doubt == "mean acceleration (0.0, 0.0, -9.8) is neither (0, 0, 9.8) nor 0: see m/s^2, axes (FLU)"


@pytest.mark.parametrize("absurd", [1e6, -1e300])
def test_one_absurd_reading_says_nothing_of_the_others(absurd: float) -> None:
    watch = felt(*[(0.0, 0.0, G)] * 200, (absurd, 0.0, absurd))
    assert watch.is_believed
