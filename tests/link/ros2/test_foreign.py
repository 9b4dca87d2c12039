"""Other people's messages as ours: places, axes and frames, against independent encodings and arithmetic."""

from math import cos, radians, sin

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from link.frames.geodesy import Datum
from link.payloads.checks import PayloadError
from link.ros2 import foreign
from tests.link.ros_definitions import (
    Header,
    Odometry,
    Pose,
    PoseWithCovariance,
    Quaternion,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Twist,
    TwistWithCovariance,
    Vector3,
)

LATITUDE_DEG, LONGITUDE_DEG, ALTITUDE_M = 47.4, 8.5, 431.0
ORIGIN = Datum(latitude_rad=radians(LATITUDE_DEG), longitude_rad=radians(LONGITUDE_DEG), altitude_m=ALTITUDE_M)
T_NS = 1_700_000_000_250_000_000
YAW_RAD, PITCH_RAD = 2.1, -0.07
ATTITUDE = Rotation.from_euler("ZY", [YAW_RAD, PITCH_RAD])
POSITION_M = (310.0, -120.0, 4.5)
VELOCITY_FLU = (7.0, 0.3, -0.1)


def odometry(frame: str = "map") -> bytes:
    x, y, z, w = ATTITUDE.as_quat().tolist()
    pose_covariance = np.diag([0.04, 0.09, 0.16, 0.01, 0.02, 0.03])
    twist_covariance = np.diag([0.25, 0.01, 0.04, 0.001, 0.002, 0.003])
    return bytes(
        Odometry(
            Header(Time(T_NS // 10**9, T_NS % 10**9), frame),
            "base_link",
            PoseWithCovariance(Pose(Vector3(*POSITION_M), Quaternion(x, y, z, w)), pose_covariance.ravel().tolist()),
            TwistWithCovariance(
                Twist(Vector3(*VELOCITY_FLU), Vector3(0.01, 0.02, 0.4)), twist_covariance.ravel().tolist()
            ),
        ).serialize()
    )


def transform(parent: str, child: str, place: tuple[float, float, float], yaw_rad: float = 0.0) -> TransformStamped:
    turned = Quaternion(0.0, 0.0, sin(0.5 * yaw_rad), cos(0.5 * yaw_rad))
    return TransformStamped(Header(Time(0, 0), parent), child, Transform(Vector3(*place), turned))


def read(*transforms: TransformStamped) -> foreign.Transforms:
    return foreign.transforms_of(TFMessage(list(transforms)).serialize())


def test_fix_of_an_odometry_is_where_pymap3d_puts_it() -> None:
    fix = foreign.fix_of_odometry(odometry(), "map", ORIGIN)
    expected = pymap3d.enu2geodetic(*POSITION_M, LATITUDE_DEG, LONGITUDE_DEG, ALTITUDE_M)
    assert fix.t_ns == T_NS
    assert np.degrees((fix.latitude_rad, fix.longitude_rad)) == pytest.approx(expected[:2], abs=1e-10)
    assert fix.altitude_m == pytest.approx(expected[2], abs=1e-6)
    assert fix.covariance_enu_m2 == pytest.approx((0.04, 0, 0, 0, 0.09, 0, 0, 0, 0.16))


def test_velocity_of_an_odometry_is_turned_from_the_body_with_its_covariance() -> None:
    velocity = foreign.velocity_of_odometry(odometry(), "map")
    R = ATTITUDE.as_matrix()
    assert velocity.velocity_enu_m_s == pytest.approx(tuple(R @ np.array(VELOCITY_FLU)))
    expected = R @ np.diag([0.25, 0.01, 0.04]) @ R.T
    assert velocity.velocity_covariance_enu_m2_s2 == pytest.approx(tuple(expected.ravel()))
    assert (velocity.yaw_rate_rad_s, velocity.yaw_rate_variance_rad2_s2) == (0.4, 0.003)


def test_attitude_of_an_odometry_is_its_own() -> None:
    imu = foreign.imu_of_odometry(odometry(), "map")
    assert imu.orientation_wxyz is not None
    w, x, y, z = imu.orientation_wxyz
    assert (Rotation.from_quat([x, y, z, w]) * ATTITUDE.inv()).magnitude() < 1e-9
    assert imu.orientation_covariance_rad2 == pytest.approx((0.01, 0, 0, 0, 0.02, 0, 0, 0, 0.03))
    assert imu.specific_force_flu_m_s2 is None


def test_odometry_in_another_frame_is_refused() -> None:
    with pytest.raises(PayloadError, match="frame 'odom', not 'map'"):
        foreign.fix_of_odometry(odometry("odom"), "map", ORIGIN)


def test_lever_goes_over_what_both_frames_hang_on() -> None:
    known = read(
        transform("base_link", "roof", (0.5, 0.0, 1.8), yaw_rad=radians(90.0)),
        transform("roof", "landing_pad", (0.2, 0.1, 0.05)),
        transform("base_link", "gnss", (1.0, 0.4, 1.5), yaw_rad=1.0),
        transform("earth", "base_link", (100.0, 200.0, 3.0), yaw_rad=0.7),
    )
    # the roof is turned to the left: its x is the vehicle's y, its y the vehicle's -x
    expected = (0.5 - 0.1 - 1.0, 0.2 - 0.4, 1.85 - 1.5)
    assert foreign.lever(known, "base_link", "gnss", "landing_pad") == pytest.approx(expected)


def test_lever_is_unknown_without_a_way_between_the_frames() -> None:
    known = read(transform("base_link", "gnss", (1.0, 0.0, 1.5)), transform("trailer", "landing_pad", (0.0, 0.0, 1.0)))
    assert foreign.lever(known, "base_link", "gnss", "landing_pad") is None


def test_ring_of_transforms_ends() -> None:
    known = read(transform("a", "b", (1.0, 0.0, 0.0)), transform("b", "a", (1.0, 0.0, 0.0)))
    assert foreign.lever(known, "a", "b", "landing_pad") is None


@pytest.mark.parametrize("payload", [b"", b"\0\1\0\0", odometry()[:90]])
def test_bytes_that_are_no_odometry_are_refused(payload: bytes) -> None:
    with pytest.raises(PayloadError):
        foreign.velocity_of_odometry(payload, "map")
