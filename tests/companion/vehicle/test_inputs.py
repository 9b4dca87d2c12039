"""Vehicle messages as measurements in W: values, covariances and what stands in when none is stated."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from companion.autopilots.driver import NO_AUTOPILOT
from companion.autopilots.state import AutopilotState
from companion.core.data import Measurement, Quantity
from companion.vehicle.imu_inputs import imu_measurements
from companion.vehicle.inputs import (
    fix_measurement,
    measurements_of,
    plausible,
    sighting_measurement,
    velocity_measurements,
)
from companion.vehicle.unit_watch import UnitWatch
from link.frames.geodesy import LocalFrame, Projection, geodetic_from_enu, geodetic_from_local
from link.frames.rotations import quaternion_from_roll_pitch_yaw
from link.messages import Fix, FixVelocity, Matrix3, PadSighting, Vector3, VehicleImu
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.payloads.ros_fields import matrix3
from link.records import replace
from link.zenoh.keys import Keys
from tests.companion.world import FRAME, ORIGIN, START_NS, own_state

COVARIANCE: Matrix3 = (0.04, 0.01, 0.0, 0.01, 0.09, 0.0, 0.0, 0.0, 0.25)
KEYS = Keys()
far = st.floats(-2e4, 2e4)


@given(place=st.tuples(far, far, st.floats(-400.0, 4000.0)), projection=st.sampled_from(Projection))
@settings(max_examples=50, deadline=None)
def test_fix_is_where_it_was_made_in_the_local_frame(place: Vector3, projection: Projection) -> None:
    frame = LocalFrame(origin=ORIGIN, projection=projection)
    latitude_rad, longitude_rad, altitude_m = geodetic_from_local(frame, place)
    fix = Fix(t_ns=START_NS, latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m)
    measurement = fix_measurement(fix, frame)
    assert measurement.quantity is Quantity.POSITION
    assert measurement.t_ns == START_NS
    np.testing.assert_allclose(measurement.value, place, atol=1e-3)


@pytest.mark.parametrize(("latitude_deg", "is_placed"), [(89.42, True), (89.44, False), (-89.44, False), (90.0, False)])
def test_fix_is_refused_so_near_a_pole_that_ardupilots_metres_are_none(latitude_deg: float, *, is_placed: bool) -> None:
    origin = replace(ORIGIN, latitude_rad=math.radians(latitude_deg))
    fix = Fix(t_ns=START_NS, latitude_rad=origin.latitude_rad, longitude_rad=0.1, altitude_m=0.0)
    fix_measurement(fix, LocalFrame(origin=origin, projection=Projection.PX4))
    frame = LocalFrame(origin=origin, projection=Projection.ARDUPILOT)
    if is_placed:
        fix_measurement(fix, frame)
        return
    with pytest.raises(PayloadError, match="pole"):
        fix_measurement(fix, frame)


def test_nothing_is_placed_before_the_autopilot_has_told_its_frame() -> None:
    fix = Fix(t_ns=START_NS, latitude_rad=0.83, longitude_rad=0.14, altitude_m=401.0)
    velocity = FixVelocity(t_ns=START_NS, velocity_enu_m_s=(1.0, 2.0, 0.0))
    unknown, known = AutopilotState(), AutopilotState(view=replace(NO_AUTOPILOT, frame=FRAME))
    for key, payload in ((KEYS.fix, cdr.encode(fix)), (KEYS.fix_velocity, cdr.encode(velocity))):
        assert measurements_of(key, payload, KEYS, unknown, UnitWatch()) == []
        assert len(measurements_of(key, payload, KEYS, known, UnitWatch())) == 1


def test_stated_covariance_is_taken_and_a_missing_one_is_replaced() -> None:
    stated = Fix(t_ns=1, latitude_rad=0.83, longitude_rad=0.14, altitude_m=1.0, covariance_enu_m2=COVARIANCE)
    np.testing.assert_array_equal(fix_measurement(stated, FRAME).covariance, np.reshape(COVARIANCE, (3, 3)))
    plain = Fix(t_ns=1, latitude_rad=0.83, longitude_rad=0.14, altitude_m=1.0)
    assert np.all(np.linalg.eigvalsh(fix_measurement(plain, FRAME).covariance) > 0.5)


def test_a_vertical_velocity_that_is_not_measured_says_nothing() -> None:
    stated = (0.04, 0.01, 0.0, 0.01, 0.09, 0.0, 0.0, 0.0, 0.0)
    for covariance, horizontal in ((None, [0.09, 0.09]), (stated, [0.04, 0.09])):
        (velocity,) = velocity_measurements(
            FixVelocity(
                t_ns=1,
                velocity_enu_m_s=(1.0, 2.0, 0.0),
                velocity_covariance_enu_m2_s2=covariance,
                is_vertical_measured=False,
            ),
            FRAME,
        )
        assert velocity.covariance.diagonal()[:2].tolist() == pytest.approx(horizontal)
        assert velocity.covariance[2].tolist() == [0.0, 0.0, 1e4]


def test_velocity_comes_with_a_yaw_rate_only_where_one_was_measured() -> None:
    alone = velocity_measurements(FixVelocity(t_ns=1, velocity_enu_m_s=(1.0, 2.0, 3.0)), FRAME)
    assert [one.quantity for one in alone] == [Quantity.VELOCITY]
    both = velocity_measurements(
        FixVelocity(t_ns=1, velocity_enu_m_s=(1.0, 2.0, 3.0), yaw_rate_rad_s=0.2, yaw_rate_variance_rad2_s2=0.01),
        FRAME,
    )
    assert [one.quantity for one in both] == [Quantity.VELOCITY, Quantity.YAW_RATE]
    assert both[1].value.tolist() == [0.2]
    assert both[1].covariance.tolist() == [[0.01]]


@pytest.mark.parametrize("projection", Projection)
def test_velocity_is_that_of_the_place_that_the_fixes_show(projection: Projection) -> None:
    frame = LocalFrame(origin=ORIGIN, projection=projection)
    true_enu_m_s = (11.0, -7.0, 0.6)
    (velocity,) = velocity_measurements(FixVelocity(t_ns=1, velocity_enu_m_s=true_enu_m_s), frame)
    before, after = (
        fix_measurement(
            Fix(t_ns=1, latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m), frame
        ).value
        for latitude_rad, longitude_rad, altitude_m in (
            geodetic_from_enu(ORIGIN, (s * true_enu_m_s[0], s * true_enu_m_s[1], s * true_enu_m_s[2]))
            for s in (-0.5, 0.5)
        )
    )
    np.testing.assert_allclose(velocity.value, after - before, atol=1e-4)


@given(roll=st.floats(-0.5, 0.5), pitch=st.floats(-0.5, 0.5), yaw=st.floats(-3.1, 3.1))
def test_heading_is_the_yaw_of_the_attitude(roll: float, pitch: float, yaw: float) -> None:
    imu = VehicleImu(t_ns=1, orientation_wxyz=quaternion_from_roll_pitch_yaw(roll, pitch, yaw))
    (heading,) = imu_measurements(imu, UnitWatch())
    assert heading.quantity is Quantity.HEADING
    assert heading.value[0] == pytest.approx(yaw, abs=1e-9)


@pytest.mark.parametrize("force", [None, (0.0, 0.0, 0.0)])
def test_imu_without_attitude_rate_and_force_says_nothing(force: Vector3 | None) -> None:
    assert imu_measurements(VehicleImu(t_ns=1, specific_force_flu_m_s2=force), UnitWatch()) == ()


def test_imu_variances_are_those_about_the_vertical() -> None:
    diagonal: Matrix3 = (0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.3)
    heading, rate = imu_measurements(
        VehicleImu(
            t_ns=1,
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            orientation_covariance_rad2=diagonal,
            angular_velocity_flu_rad_s=(0.5, 0.6, 0.7),
            angular_velocity_covariance_rad2_s2=diagonal,
        ),
        UnitWatch(),
    )
    assert heading.covariance.tolist() == [[0.3]]
    assert rate.covariance.tolist() == [[0.3]]
    assert rate.value.tolist() == [0.7]


def told_tilt(*, tilt_variance_rad2: float, rates: tuple[float, float, float] | None) -> list[Measurement]:
    """What an attitude unit tells of a vehicle that rolls by 0.1 rad and pitches by -0.04 rad on a heading of 2 rad."""
    known = VehicleImu(
        t_ns=1,
        orientation_wxyz=quaternion_from_roll_pitch_yaw(0.1, -0.04, 2.0),
        orientation_covariance_rad2=(tilt_variance_rad2, 0.0, 0.0, 0.0, tilt_variance_rad2, 0.0, 0.0, 0.0, 3e-4),
        angular_velocity_flu_rad_s=rates,
        angular_velocity_covariance_rad2_s2=None if rates is None else (1e-4, 0.0, 0.0, 0.0, 2e-4, 0.0, 0.0, 0.0, 3e-4),
    )
    return [one for one in imu_measurements(known, UnitWatch()) if one.quantity is Quantity.TILT]


def test_tilt_and_its_rates_are_measured_where_the_unit_knows_them() -> None:
    (tilt,) = told_tilt(tilt_variance_rad2=2e-5, rates=(0.3, -0.2, 0.0))
    assert tilt.value[:2] == pytest.approx([0.1, -0.04])
    assert tilt.value[2:] == pytest.approx([0.3, -0.2], abs=2e-3)
    yawing = (3e-4 * (math.tan(0.04) * math.cos(0.1)) ** 2, 3e-4 * math.sin(0.1) ** 2)  # what the yaw rate's error adds
    assert tilt.covariance.diagonal() == pytest.approx([2e-5, 2e-5, 1e-4 + yawing[0], 2e-4 + yawing[1]])


def test_rates_of_the_tilt_are_how_fast_roll_and_pitch_change() -> None:
    """A body that turns about its own axes for a moment, by scipy."""
    rates, step_s = (0.3, -0.2, 0.7), 1e-6
    (tilt,) = told_tilt(tilt_variance_rad2=2e-5, rates=rates)
    before = Rotation.from_euler("ZYX", [2.0, -0.04, 0.1])
    yaw, pitch, roll = (before * Rotation.from_rotvec(step_s * np.array(rates))).as_euler("ZYX")
    assert yaw > 2.0
    assert tilt.value[2:] == pytest.approx([(roll - 0.1) / step_s, (pitch + 0.04) / step_s], abs=1e-5)


def test_tilt_without_rates_says_nothing_of_them() -> None:
    (tilt,) = told_tilt(tilt_variance_rad2=2e-5, rates=None)
    assert min(tilt.covariance.diagonal()[2:]) > 1e3


def test_unit_that_knows_its_heading_only_measures_no_tilt() -> None:
    assert told_tilt(tilt_variance_rad2=3.3, rates=(0.3, -0.2, 0.7)) == []


def test_sighting_is_turned_into_the_world_with_its_covariance() -> None:
    own = own_state(START_NS, (4.0, 5.0, 6.0))
    sighting = PadSighting(
        t_ns=START_NS,
        position_flu_m=(0.3, -0.2, -2.5),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        position_covariance_m2=COVARIANCE,
    )
    w, x, y, z = own.orientation_wxyz
    turn = Rotation.from_quat([x, y, z, w]).as_matrix()
    measurement = sighting_measurement(sighting, own)
    assert measurement.quantity is Quantity.PAD
    np.testing.assert_allclose(measurement.value, turn @ [0.3, -0.2, -2.5] + [4.0, 5.0, 6.0], atol=1e-12)
    np.testing.assert_allclose(measurement.covariance, turn @ np.reshape(COVARIANCE, (3, 3)) @ turn.T, atol=1e-12)
    assert math.isclose(np.trace(measurement.covariance), sum(COVARIANCE[::4]))


@pytest.mark.parametrize(("age_s", "count"), [(0.02, 1), (0.1, 1), (0.3, 0), (5.0, 0)])
def test_sighting_is_taken_only_where_the_drones_attitude_was_known(age_s: float, count: int) -> None:
    own = replace(own_state(START_NS, (4.0, 5.0, 6.0)), attitude_age_s=age_s)
    sighting = PadSighting(
        t_ns=START_NS + 1,
        position_flu_m=(0.3, -0.2, -2.5),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        position_covariance_m2=COVARIANCE,
    )
    state = AutopilotState(view=replace(NO_AUTOPILOT, frame=FRAME), history=(own,))
    assert len(measurements_of(KEYS.pad_pose, cdr.encode(sighting), KEYS, state, UnitWatch())) == count


@pytest.mark.parametrize("variances", [(0.0, 0.0, 0.0), (0.1, 0.1, 0.0), (1e-30, 1.0, 1.0)])
def test_covariance_that_is_singular_is_widened_to_what_sensors_can_do(variances: Vector3) -> None:
    fix = fix_measurement(Fix(t_ns=1, latitude_rad=0.83, longitude_rad=0.14, altitude_m=1.0), FRAME)
    widened = plausible(replace(fix, covariance=np.diag(variances)))
    assert np.linalg.eigvalsh(widened.covariance)[0] >= 0.005**2
    assert np.all(widened.covariance >= np.diag(variances))


def test_covariance_that_rounding_leaves_less_than_no_variance_is_widened_to_what_sensors_can_do() -> None:
    turn = Rotation.from_euler("zyx", (0.7, 0.05, -0.04)).as_matrix()
    rounded = (turn @ np.diag([4e-4, 4e-4, 9e7]) @ turn.T).astype(np.float32).astype(np.float64)
    assert np.linalg.eigvalsh(rounded)[0] < -0.005
    state = AutopilotState(view=replace(NO_AUTOPILOT, frame=FRAME))
    message = FixVelocity(
        t_ns=START_NS,
        velocity_enu_m_s=(5.0, 0.3, 0.1),
        velocity_covariance_enu_m2_s2=matrix3(rounded.ravel()),
        is_vertical_measured=True,
    )
    (velocity,) = measurements_of(KEYS.fix_velocity, cdr.encode(message), KEYS, state, UnitWatch())
    assert np.linalg.eigvalsh(velocity.covariance)[0] > 0.5 * 0.01**2


def test_covariance_in_order_is_left_alone() -> None:
    fix = fix_measurement(Fix(t_ns=1, latitude_rad=0.83, longitude_rad=0.14, altitude_m=1.0), FRAME)
    assert plausible(fix) is fix


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e6, -1e300])
def test_absurd_number_is_refused(bad: float) -> None:
    fix = fix_measurement(Fix(t_ns=1, latitude_rad=0.83, longitude_rad=0.14, altitude_m=1.0), FRAME)
    with pytest.raises(PayloadError, match="absurd"):
        plausible(replace(fix, value=np.array([0.0, bad, 0.0])))
    with pytest.raises(PayloadError, match="absurd"):
        plausible(replace(fix, covariance=np.diag([1.0, abs(bad) * 1e3, 1.0])))


@pytest.mark.parametrize("axis", range(3))
def test_velocity_that_no_number_holds_in_the_drones_frame_is_refused(axis: int) -> None:
    huge: list[float] = [0.0, 0.0, 0.0]
    huge[axis] = sys.float_info.max
    message = FixVelocity(t_ns=START_NS, velocity_enu_m_s=(huge[0], huge[1], huge[2]), is_vertical_measured=True)
    state = AutopilotState(view=replace(NO_AUTOPILOT, frame=FRAME))
    with pytest.raises(PayloadError, match="absurd"):
        measurements_of(KEYS.fix_velocity, cdr.encode(message), KEYS, state, UnitWatch())
