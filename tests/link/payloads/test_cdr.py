"""The CDR payloads against an independent CDR library, in both directions, and against bytes that are none."""

from math import degrees, inf, nan, pi, radians
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pycdr2 import Endianness  # type: ignore[attr-defined]  # it does not list its exports

from link.frames.rotations import normalized
from link.messages import (
    BodyTruth,
    CameraImage,
    CompressedPicture,
    Fix,
    FixVelocity,
    PadSighting,
    Plan,
    PlannedPose,
    RotorTruth,
    VehicleImu,
)
from link.payloads.cdr import ROS_TYPES, Message, PayloadError, decode, encode, encoding_of
from link.program.clock import ClockTick
from link.records import replace
from tests.link import ros_definitions as ros

T_NS = 1_763_708_400_123_456_789
SECONDS, NANOSECONDS = 1_763_708_400, 123_456_789
COVARIANCE = (1.0, 0.1, -0.2, 0.1, 2.0, 0.3, -0.2, 0.3, 3.0)
ATTITUDE = normalized((0.9, 0.1, -0.3, 0.2))
W, X, Y, Z = ATTITUDE

FIX = Fix(
    t_ns=T_NS,
    latitude_rad=radians(46.017),
    longitude_rad=radians(-7.75),
    altitude_m=1673.5,
    covariance_enu_m2=COVARIANCE,
)
FIX_VELOCITY = FixVelocity(
    t_ns=T_NS,
    velocity_enu_m_s=(1.5, -2.5, 0.25),
    velocity_covariance_enu_m2_s2=COVARIANCE,
    yaw_rate_rad_s=0.35,
    yaw_rate_variance_rad2_s2=0.04,
)
IMU = VehicleImu(
    t_ns=T_NS,
    orientation_wxyz=ATTITUDE,
    orientation_covariance_rad2=COVARIANCE,
    angular_velocity_flu_rad_s=(0.1, -0.2, 0.3),
    angular_velocity_covariance_rad2_s2=COVARIANCE,
    specific_force_flu_m_s2=(0.5, -0.6, 9.8),
    specific_force_covariance_m2_s4=COVARIANCE,
)
SIGHTING = PadSighting(
    t_ns=T_NS, position_flu_m=(0.4, -0.3, -5.0), orientation_wxyz=ATTITUDE, position_covariance_m2=COVARIANCE
)
TRUTH = BodyTruth(
    t_ns=T_NS,
    position_enu_m=(1.0, -2.0, 3.0),
    orientation_wxyz=ATTITUDE,
    velocity_flu_m_s=(5.0, 0.5, -0.25),
    angular_velocity_flu_rad_s=(0.1, -0.2, 0.3),
)
ROTORS = RotorTruth(t_ns=T_NS, speed_rad_s=(701.0, 702.5, 703.0, 704.25))
PLAN = Plan(
    t_ns=T_NS,
    poses=tuple(
        PlannedPose(t_ns=T_NS + step * 100_000_000, position_enu_m=(0.5 * step, -step, 5.0), yaw_rad=0.7 * step - 1.0)
        for step in range(3)
    ),
)
TICK = ClockTick(t_ns=T_NS)
IMAGE = CameraImage(
    t_ns=T_NS, width_px=3, height_px=2, encoding="mono8", row_bytes=4, data=bytes([1, 2, 3, 0, 250, 251, 252, 0])
)
COMPRESSED = CompressedPicture(t_ns=T_NS, format="jpeg", data=b"\xff\xd8\xff\xd9")
MESSAGES: list[Message] = [FIX, FIX_VELOCITY, IMU, SIGHTING, TRUTH, ROTORS, PLAN, TICK, IMAGE, COMPRESSED]

HEADER = ros.Header(stamp=ros.Time(sec=SECONDS, nanosec=NANOSECONDS), frame_id="map")
LEVEL = ros.Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)


def block_6x6(covariance: tuple[float, ...]) -> list[float]:
    full = [0.0] * 36
    for row in range(3):
        full[6 * row : 6 * row + 3] = covariance[3 * row : 3 * row + 3]
    return full


def nav_sat_fix(**changes: Any) -> ros.NavSatFix:
    fields: dict[str, Any] = {
        "header": HEADER,
        "status": ros.NavSatStatus(status=0, service=1),
        "latitude": 46.017,
        "longitude": -7.75,
        "altitude": 1673.5,
        "position_covariance": list(COVARIANCE),
        "position_covariance_type": 3,
    }
    return ros.NavSatFix(**(fields | changes))


def imu(**changes: Any) -> ros.Imu:
    fields: dict[str, Any] = {
        "header": HEADER,
        "orientation": ros.Quaternion(x=X, y=Y, z=Z, w=W),
        "orientation_covariance": list(COVARIANCE),
        "angular_velocity": ros.Vector3(x=0.1, y=-0.2, z=0.3),
        "angular_velocity_covariance": list(COVARIANCE),
        "linear_acceleration": ros.Vector3(x=0.5, y=-0.6, z=9.8),
        "linear_acceleration_covariance": list(COVARIANCE),
    }
    return ros.Imu(**(fields | changes))


def twist_stamped(covariance: list[float], **changes: Any) -> ros.TwistWithCovarianceStamped:
    twist = ros.Twist(linear=ros.Vector3(x=1.5, y=-2.5, z=0.25), angular=ros.Vector3(x=0.0, y=0.0, z=0.35))
    fields: dict[str, Any] = {"header": HEADER, "twist": ros.TwistWithCovariance(twist=twist, covariance=covariance)}
    return ros.TwistWithCovarianceStamped(**(fields | changes))


def pad_pose(frame_id: str, covariance: list[float], orientation: ros.Quaternion = LEVEL) -> bytes:
    pose = ros.Pose(position=ros.Vector3(x=0.4, y=-0.3, z=-5.0), orientation=orientation)
    return ros.PoseWithCovarianceStamped(
        header=replace(HEADER, frame_id=frame_id), pose=ros.PoseWithCovariance(pose=pose, covariance=covariance)
    ).serialize()


def test_every_type_on_the_wire_makes_the_round_trip_below() -> None:
    assert {type(message) for message in MESSAGES} == set(ROS_TYPES)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_message_returns_from_its_bytes(message: Message) -> None:
    back = decode(type(message), encode(message))
    if isinstance(message, Fix):  # degrees on the wire round
        assert isinstance(back, Fix)
        assert back.latitude_rad == pytest.approx(message.latitude_rad, rel=1e-15)
        assert back.longitude_rad == pytest.approx(message.longitude_rad, rel=1e-15)
        back = replace(back, latitude_rad=message.latitude_rad, longitude_rad=message.longitude_rad)
    if isinstance(message, Plan):  # yaw goes through a quaternion
        assert isinstance(back, Plan)
        assert [pose.yaw_rad for pose in back.poses] == pytest.approx([pose.yaw_rad for pose in message.poses])
        back = replace(back, poses=tuple(map(_with_yaw, back.poses, message.poses)))
    assert back == message


def _with_yaw(pose: PlannedPose, other: PlannedPose) -> PlannedPose:
    return replace(pose, yaw_rad=other.yaw_rad)


def test_fix_is_read_by_the_other_library_in_degrees() -> None:
    other = ros.NavSatFix.deserialize(encode(FIX))
    assert (other.latitude, other.longitude, other.altitude) == pytest.approx((46.017, -7.75, 1673.5), abs=1e-12)
    assert (other.header.stamp.sec, other.header.stamp.nanosec) == (SECONDS, NANOSECONDS)
    assert tuple(other.position_covariance) == COVARIANCE
    assert other.position_covariance_type == 3


def test_fix_without_covariance_says_so() -> None:
    other = ros.NavSatFix.deserialize(encode(replace(FIX, covariance_enu_m2=None)))
    assert other.position_covariance_type == 0
    assert not any(other.position_covariance)


def test_velocity_is_read_by_the_other_library() -> None:
    other = ros.TwistWithCovarianceStamped.deserialize(encode(FIX_VELOCITY))
    linear, angular = other.twist.twist.linear, other.twist.twist.angular
    assert (linear.x, linear.y, linear.z, angular.z) == (1.5, -2.5, 0.25, 0.35)
    assert list(other.twist.covariance)[:35] == block_6x6(COVARIANCE)[:35]
    assert other.twist.covariance[35] == 0.04


def test_a_vertical_velocity_that_is_not_measured_is_marked_both_ways() -> None:
    flat = replace(FIX_VELOCITY, velocity_covariance_enu_m2_s2=None, is_vertical_measured=False)
    other = ros.TwistWithCovarianceStamped.deserialize(encode(flat))
    assert other.twist.covariance[14] == -1.0
    assert decode(FixVelocity, other.serialize()) == flat
    known = decode(FixVelocity, encode(replace(FIX_VELOCITY, is_vertical_measured=False)))
    assert known.velocity_covariance_enu_m2_s2 == (1.0, 0.1, 0.0, 0.1, 2.0, 0.0, 0.0, 0.0, 0.0)
    assert not known.is_vertical_measured


def test_imu_is_read_by_the_other_library() -> None:
    assert ros.Imu.deserialize(encode(IMU)) == imu(header=replace(HEADER, frame_id="base_link"))


def test_pad_sighting_is_read_by_the_other_library() -> None:
    other = ros.PoseWithCovarianceStamped.deserialize(encode(SIGHTING))
    assert other.header.frame_id == "base_link"
    assert other.pose.pose.position == ros.Vector3(x=0.4, y=-0.3, z=-5.0)
    assert other.pose.pose.orientation == ros.Quaternion(x=X, y=Y, z=Z, w=W)
    assert list(other.pose.covariance) == block_6x6(COVARIANCE)


def test_truth_is_read_by_the_other_library() -> None:
    other = ros.Odometry.deserialize(encode(TRUTH))
    assert (other.header.frame_id, other.child_frame_id) == ("map", "base_link")
    assert other.pose.pose.position == ros.Vector3(x=1.0, y=-2.0, z=3.0)
    assert other.pose.pose.orientation == ros.Quaternion(x=X, y=Y, z=Z, w=W)
    assert other.twist.twist.linear == ros.Vector3(x=5.0, y=0.5, z=-0.25)
    assert other.twist.twist.angular == ros.Vector3(x=0.1, y=-0.2, z=0.3)


def test_rotors_plan_and_tick_are_read_by_the_other_library() -> None:
    rotors = ros.JointState.deserialize(encode(ROTORS))
    assert (len(rotors.name), list(rotors.velocity)) == (4, [701.0, 702.5, 703.0, 704.25])
    path = ros.Path.deserialize(encode(PLAN))
    assert [pose.pose.position.x for pose in path.poses] == [0.0, 0.5, 1.0]
    assert [pose.header.stamp.nanosec for pose in path.poses] == [123_456_789, 223_456_789, 323_456_789]
    assert ros.Clock.deserialize(encode(TICK)).clock == ros.Time(sec=SECONDS, nanosec=NANOSECONDS)


@pytest.mark.parametrize("endianness", [Endianness.Little, Endianness.Big])
def test_bytes_of_the_other_library_are_read(endianness: Endianness) -> None:
    payloads: dict[type[Message], Any] = {
        VehicleImu: imu(),
        FixVelocity: twist_stamped([*block_6x6(COVARIANCE)[:35], 0.04]),
        RotorTruth: ros.JointState(
            header=HEADER, name=["a", "b", "c", "d"], position=[], velocity=list(ROTORS.speed_rad_s), effort=[]
        ),
        ClockTick: ros.Clock(clock=HEADER.stamp),
    }
    expected: dict[type[Message], Message] = {
        VehicleImu: IMU,
        FixVelocity: FIX_VELOCITY,
        RotorTruth: ROTORS,
        ClockTick: TICK,
    }
    for message_type, payload in payloads.items():
        assert decode(message_type, payload.serialize(endianness=endianness)) == expected[message_type]
    fix = decode(Fix, nav_sat_fix().serialize(endianness=endianness))
    assert degrees(fix.latitude_rad) == pytest.approx(46.017, abs=1e-12)
    assert fix.covariance_enu_m2 == COVARIANCE


def test_truth_and_plan_of_the_other_library_are_read() -> None:
    pose = ros.Pose(position=ros.Vector3(x=1.0, y=-2.0, z=3.0), orientation=ros.Quaternion(x=X, y=Y, z=Z, w=W))
    twist = ros.Twist(linear=ros.Vector3(x=5.0, y=0.5, z=-0.25), angular=ros.Vector3(x=0.1, y=-0.2, z=0.3))
    odometry = ros.Odometry(
        header=HEADER,
        child_frame_id="base_link",
        pose=ros.PoseWithCovariance(pose=pose, covariance=[0.0] * 36),
        twist=ros.TwistWithCovariance(twist=twist, covariance=[0.0] * 36),
    )
    assert decode(BodyTruth, odometry.serialize()) == TRUTH
    path = ros.Path(header=HEADER, poses=[ros.PoseStamped(header=HEADER, pose=pose)])
    assert decode(Plan, path.serialize()).poses[0].position_enu_m == (1.0, -2.0, 3.0)


def test_quaternion_is_read_with_its_scalar_part_positive() -> None:
    payload = imu(orientation=ros.Quaternion(x=-X, y=-Y, z=-Z, w=-W)).serialize()
    assert decode(VehicleImu, payload).orientation_wxyz == ATTITUDE


def test_what_an_imu_does_not_measure_is_none_both_ways() -> None:
    empty = VehicleImu(t_ns=T_NS)
    assert ros.Imu.deserialize(encode(empty)).orientation_covariance[0] == -1.0
    assert decode(VehicleImu, encode(empty)) == empty


def test_an_imu_whose_quaternion_was_never_set_has_no_orientation() -> None:
    payload = imu(orientation=ros.Quaternion(x=0.0, y=0.0, z=0.0, w=0.0), orientation_covariance=[0.0] * 9).serialize()
    back = decode(VehicleImu, payload)
    assert back.orientation_wxyz is None
    assert back.angular_velocity_flu_rad_s == IMU.angular_velocity_flu_rad_s


def test_zero_covariances_are_unknown() -> None:
    fix = decode(Fix, nav_sat_fix(position_covariance=[0.0] * 9).serialize())
    velocity = decode(FixVelocity, twist_stamped([0.0] * 36).serialize())
    assert fix.covariance_enu_m2 is None
    assert velocity.velocity_covariance_enu_m2_s2 is None
    assert (velocity.yaw_rate_rad_s, velocity.yaw_rate_variance_rad2_s2) == (0.35, None)


@pytest.mark.parametrize("element", [21, 35])
def test_a_yaw_rate_marked_as_not_measured_is_none(element: int) -> None:
    covariance = block_6x6(COVARIANCE)
    covariance[element] = -1.0
    assert decode(FixVelocity, twist_stamped(covariance).serialize()).yaw_rate_rad_s is None
    unknown = replace(FIX_VELOCITY, yaw_rate_rad_s=None, yaw_rate_variance_rad2_s2=None)
    assert ros.TwistWithCovarianceStamped.deserialize(encode(unknown)).twist.covariance[element] == -1.0


@pytest.mark.parametrize(
    "changes",
    [
        {"latitude": nan},
        {"latitude": 90.001},
        {"longitude": -180.001},
        {"altitude": inf},
        {"status": ros.NavSatStatus(status=-1, service=1)},
        {"position_covariance_type": 4},
        {"position_covariance": [nan] * 9},
        {"position_covariance": [1.0, 0.5, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 1.0]},
        {"position_covariance": [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]},
        {"position_covariance": [1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0]},
        {"position_covariance": [1.0, 0.9, -0.9, 0.9, 1.0, 0.9, -0.9, 0.9, 1.0]},
        {"header": ros.Header(stamp=ros.Time(sec=-1, nanosec=0), frame_id="")},
        {"header": ros.Header(stamp=ros.Time(sec=1, nanosec=1_000_000_000), frame_id="")},
    ],
    ids=str,
)
def test_a_fix_that_cannot_be_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(PayloadError):
        decode(Fix, nav_sat_fix(**changes).serialize())


def test_the_poles_and_the_date_line_are_places() -> None:
    fix = decode(Fix, nav_sat_fix(latitude=-90.0, longitude=180.0).serialize())
    assert (fix.latitude_rad, fix.longitude_rad) == (-pi / 2, pi)


@pytest.mark.parametrize(
    "changes",
    [
        {"orientation": ros.Quaternion(x=0.0, y=0.0, z=0.0, w=1.1)},
        {"orientation": ros.Quaternion(x=nan, y=0.0, z=0.0, w=1.0)},
        {"angular_velocity": ros.Vector3(x=0.0, y=inf, z=0.0)},
    ],
    ids=str,
)
def test_an_imu_that_cannot_be_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(PayloadError):
        decode(VehicleImu, imu(**changes).serialize())


def test_a_velocity_marked_as_not_measured_is_refused() -> None:
    with pytest.raises(PayloadError, match="not measured"):
        decode(FixVelocity, twist_stamped([-1.0, *[0.0] * 35]).serialize())


def test_a_pad_pose_needs_the_bodys_frame_and_a_covariance() -> None:
    assert decode(PadSighting, pad_pose("base_link", block_6x6(COVARIANCE))).position_flu_m == (0.4, -0.3, -5.0)
    with pytest.raises(PayloadError, match="frame 'base_link', not 'camera'"):
        decode(PadSighting, pad_pose("camera", block_6x6(COVARIANCE)))
    with pytest.raises(PayloadError, match="covariance"):
        decode(PadSighting, pad_pose("base_link", [0.0] * 36))


def test_rotor_speeds_must_be_four() -> None:
    payload = ros.JointState(header=HEADER, name=[], position=[], velocity=[1.0, 2.0, 3.0], effort=[]).serialize()
    with pytest.raises(PayloadError, match="must be 4, not 3"):
        decode(RotorTruth, payload)


@pytest.mark.parametrize(
    "message",
    [
        replace(FIX, altitude_m=nan),
        replace(FIX, t_ns=-1),
        replace(TRUTH, position_enu_m=(0.0, inf, 0.0)),
        replace(TRUTH, orientation_wxyz=(0.0, 0.0, 0.0, 0.0)),
        replace(SIGHTING, position_covariance_m2=(nan, *COVARIANCE[1:])),
        replace(ROTORS, speed_rad_s=(nan, 0.0, 0.0, 0.0)),
        replace(TICK, t_ns=2**31 * 1_000_000_000),
    ],
    ids=lambda message: type(message).__name__,
)
def test_what_must_not_be_sent_is_not_encoded(message: Message) -> None:
    with pytest.raises(PayloadError):
        encode(message)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_truncated_bytes_are_refused(message: Message) -> None:
    payload = encode(message)
    for length in range(len(payload)):
        with pytest.raises(PayloadError):
            decode(type(message), payload[:length])


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_bytes_too_many_are_refused(message: Message) -> None:
    with pytest.raises(PayloadError):
        decode(type(message), encode(message) + bytes(8))


def test_an_unknown_encapsulation_is_refused() -> None:
    payload = encode(FIX)
    for header in (b"\x00\x02\x00\x00", b"\x00\x07\x00\x00", b"\x01\x01\x00\x00"):
        with pytest.raises(PayloadError, match="encapsulation"):
            decode(Fix, header + payload[4:])


@pytest.mark.slow
@pytest.mark.parametrize("message_type", list(ROS_TYPES), ids=lambda message_type: message_type.__name__)
@given(payload=st.binary(max_size=1000), has_header=st.booleans())
def test_random_bytes_raise_nothing_but_payload_error(
    message_type: type[Message], payload: bytes, has_header: bool
) -> None:
    try:
        decode(message_type, b"\x00\x01\x00\x00" * has_header + payload)
    except PayloadError:
        return


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
@given(data=st.data())
def test_damaged_bytes_raise_nothing_but_payload_error(message: Message, data: st.DataObject) -> None:
    payload = bytearray(encode(message))
    for _ in range(data.draw(st.integers(1, 4))):
        payload[data.draw(st.integers(0, len(payload) - 1))] = data.draw(st.integers(0, 255))
    try:
        decode(type(message), bytes(payload))
    except PayloadError:
        return


def test_encoding_names_the_ros_type() -> None:
    assert encoding_of(Fix) == "application/cdr;sensor_msgs/msg/NavSatFix"
    assert encoding_of(BodyTruth) == "application/cdr;nav_msgs/msg/Odometry"
