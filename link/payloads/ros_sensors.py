"""The vehicle's and the drone's sensors as ROS 2 messages: degrees, covariance conventions and frame names.

Conventions, where ROS leaves a choice:
- A zero covariance is unknown (None). NavSatFix says so by `position_covariance_type` as well.
- Imu: -1 in a covariance's first element says that the quantity is not measured (sensor_msgs/Imu). An all-zero
  quaternion, which drivers without attitude leave behind, says the same.
- TwistWithCovarianceStamped: -1 as the variance of an angular rate says that it is not measured (as GNSS drivers
  do, about x); both the one about x and the one about z are read so and written so. The same mark on the
  variance of the vertical velocity says that only the horizontal one is measured. A zero variance is unknown.
- NavSatFix with STATUS_NO_FIX is no position and is refused.
- frame_id: `map` is the ENU world, `base_link` the body in FLU, `gnss` the antenna.
"""

from math import degrees, pi, radians

import numpy as np
from rosbags.typesys.stores import ros2_humble as ros

from link.messages import Fix, FixVelocity, Matrix3, PadSighting, Vector3, VehicleImu
from link.payloads.checks import PayloadError, check_finite, checked_covariance, checked_quaternion
from link.payloads.ros_fields import (
    ANTENNA_FRAME,
    BODY_FRAME,
    WORLD_FRAME,
    Array,
    Conversion,
    from_block_6x6,
    from_quaternion,
    from_xyz,
    matrix3,
    stamp_ns,
    to_block_6x6,
    to_covariance,
    to_header,
    to_point,
    to_quaternion,
    to_vector,
)

_NOT_MEASURED = -1.0
_VERTICAL_VARIANCE, _ROLL_RATE_VARIANCE, _YAW_RATE_VARIANCE = 14, 21, 35  # diagonal elements of a row-major 6x6
_VERTICAL_COVARIANCES = [2, 8, 12, 13, 14]  # of the vertical velocity with the three, in the same


def _fix_to_ros(fix: Fix) -> ros.sensor_msgs__msg__NavSatFix:
    check_finite("fix", (fix.latitude_rad, fix.longitude_rad, fix.altitude_m))
    known = ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_KNOWN
    unknown = ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_UNKNOWN
    status = ros.sensor_msgs__msg__NavSatStatus
    return ros.sensor_msgs__msg__NavSatFix(
        to_header(fix.t_ns, ANTENNA_FRAME),
        status(status.STATUS_FIX, status.SERVICE_GPS),
        degrees(fix.latitude_rad),
        degrees(fix.longitude_rad),
        fix.altitude_m,
        to_covariance("position covariance", fix.covariance_enu_m2),
        unknown if fix.covariance_enu_m2 is None else known,
    )


def _fix_from_ros(message: ros.sensor_msgs__msg__NavSatFix) -> Fix:
    t_ns = stamp_ns(message.header)
    if message.status.status == ros.sensor_msgs__msg__NavSatStatus.STATUS_NO_FIX:
        raise PayloadError("the receiver has no fix")
    if not (abs(message.latitude) <= 90.0 and abs(message.longitude) <= 180.0):
        raise PayloadError(f"{message.latitude}, {message.longitude} degrees is no place on earth")
    check_finite("altitude", (message.altitude,))
    covariance_type = message.position_covariance_type
    if covariance_type > ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_KNOWN:
        raise PayloadError(f"position_covariance_type {covariance_type} does not exist")
    covariance = None
    if covariance_type != ros.sensor_msgs__msg__NavSatFix.COVARIANCE_TYPE_UNKNOWN:
        covariance = checked_covariance("position covariance", matrix3(message.position_covariance))
    return Fix(
        t_ns=t_ns,
        latitude_rad=max(-0.5 * pi, min(0.5 * pi, radians(message.latitude))),
        longitude_rad=max(-pi, min(pi, radians(message.longitude))),
        altitude_m=message.altitude,
        covariance_enu_m2=covariance,
    )


def _fix_velocity_to_ros(message: FixVelocity) -> ros.geometry_msgs__msg__TwistWithCovarianceStamped:
    covariance = to_block_6x6("velocity covariance", message.velocity_covariance_enu_m2_s2)
    yaw_rate = 0.0 if message.yaw_rate_rad_s is None else message.yaw_rate_rad_s
    variance = message.yaw_rate_variance_rad2_s2 or 0.0
    check_finite("yaw rate", (yaw_rate, variance))
    covariance[_YAW_RATE_VARIANCE] = variance
    if not message.is_vertical_measured:
        covariance[_VERTICAL_COVARIANCES] = 0.0
        covariance[_VERTICAL_VARIANCE] = _NOT_MEASURED
    if message.yaw_rate_rad_s is None:
        covariance[_ROLL_RATE_VARIANCE] = covariance[_YAW_RATE_VARIANCE] = _NOT_MEASURED
    twist = ros.geometry_msgs__msg__Twist(
        to_vector("velocity", message.velocity_enu_m_s), ros.geometry_msgs__msg__Vector3(0.0, 0.0, yaw_rate)
    )
    return ros.geometry_msgs__msg__TwistWithCovarianceStamped(
        to_header(message.t_ns, WORLD_FRAME), ros.geometry_msgs__msg__TwistWithCovariance(twist, covariance)
    )


def _fix_velocity_from_ros(message: ros.geometry_msgs__msg__TwistWithCovarianceStamped) -> FixVelocity:
    t_ns = stamp_ns(message.header)
    covariance = message.twist.covariance
    if covariance[0] < 0.0:
        raise PayloadError("the velocity is marked as not measured")
    velocity = from_xyz("velocity", message.twist.twist.linear)
    is_vertical_measured = not covariance[_VERTICAL_VARIANCE] < 0.0
    if not is_vertical_measured:
        covariance = covariance.copy()
        covariance[_VERTICAL_COVARIANCES] = 0.0
    measured = not (covariance[_ROLL_RATE_VARIANCE] < 0.0 or covariance[_YAW_RATE_VARIANCE] < 0.0)
    yaw_rate, variance = message.twist.twist.angular.z, float(covariance[_YAW_RATE_VARIANCE])
    if measured:
        check_finite("yaw rate", (yaw_rate, variance))
    return FixVelocity(
        t_ns=t_ns,
        velocity_enu_m_s=velocity,
        velocity_covariance_enu_m2_s2=from_block_6x6("velocity covariance", covariance),
        is_vertical_measured=is_vertical_measured,
        yaw_rate_rad_s=yaw_rate if measured else None,
        yaw_rate_variance_rad2_s2=variance if measured and variance > 0.0 else None,
    )


def _measured_or_mark(name: str, measured: bool, covariance: Matrix3 | None) -> Array:
    if measured:
        return to_covariance(name, covariance)
    mark = np.zeros(9)
    mark[0] = _NOT_MEASURED
    return mark


def _imu_to_ros(imu: VehicleImu) -> ros.sensor_msgs__msg__Imu:
    q, rate, force = imu.orientation_wxyz, imu.angular_velocity_flu_rad_s, imu.specific_force_flu_m_s2
    return ros.sensor_msgs__msg__Imu(
        to_header(imu.t_ns, BODY_FRAME),
        to_quaternion(q or (1.0, 0.0, 0.0, 0.0)),
        _measured_or_mark("orientation covariance", q is not None, imu.orientation_covariance_rad2),
        to_vector("angular velocity", rate or (0.0, 0.0, 0.0)),
        _measured_or_mark("rate covariance", rate is not None, imu.angular_velocity_covariance_rad2_s2),
        to_vector("specific force", force or (0.0, 0.0, 0.0)),
        _measured_or_mark("force covariance", force is not None, imu.specific_force_covariance_m2_s4),
    )


def _imu_vector(
    name: str, vector: ros.geometry_msgs__msg__Vector3, covariance: Array
) -> tuple[Vector3 | None, Matrix3 | None]:
    if covariance[0] == _NOT_MEASURED:
        return None, None
    return from_xyz(name, vector), checked_covariance(f"{name} covariance", matrix3(covariance))


def _imu_from_ros(message: ros.sensor_msgs__msg__Imu) -> VehicleImu:
    orientation, orientation_covariance = None, None
    wxyz = from_quaternion(message.orientation)
    if message.orientation_covariance[0] != _NOT_MEASURED and any(wxyz):
        orientation = checked_quaternion(wxyz)
        orientation_covariance = checked_covariance("orientation covariance", matrix3(message.orientation_covariance))
    rate, rate_covariance = _imu_vector(
        "angular velocity", message.angular_velocity, message.angular_velocity_covariance
    )
    force, force_covariance = _imu_vector(
        "specific force", message.linear_acceleration, message.linear_acceleration_covariance
    )
    return VehicleImu(
        t_ns=stamp_ns(message.header),
        orientation_wxyz=orientation,
        orientation_covariance_rad2=orientation_covariance,
        angular_velocity_flu_rad_s=rate,
        angular_velocity_covariance_rad2_s2=rate_covariance,
        specific_force_flu_m_s2=force,
        specific_force_covariance_m2_s4=force_covariance,
    )


def _pad_sighting_to_ros(sighting: PadSighting) -> ros.geometry_msgs__msg__PoseWithCovarianceStamped:
    pose = ros.geometry_msgs__msg__Pose(
        to_point("pad position", sighting.position_flu_m), to_quaternion(sighting.orientation_wxyz)
    )
    covariance = to_block_6x6("pad covariance", sighting.position_covariance_m2)
    return ros.geometry_msgs__msg__PoseWithCovarianceStamped(
        to_header(sighting.t_ns, BODY_FRAME), ros.geometry_msgs__msg__PoseWithCovariance(pose, covariance)
    )


def _pad_sighting_from_ros(message: ros.geometry_msgs__msg__PoseWithCovarianceStamped) -> PadSighting:
    if message.header.frame_id != BODY_FRAME:
        raise PayloadError(f"a pad pose must be in frame {BODY_FRAME!r}, not {message.header.frame_id!r}")
    covariance = from_block_6x6("pad covariance", message.pose.covariance)
    if covariance is None:
        raise PayloadError("a pad pose must state its position covariance")
    return PadSighting(
        t_ns=stamp_ns(message.header),
        position_flu_m=from_xyz("pad position", message.pose.pose.position),
        orientation_wxyz=checked_quaternion(from_quaternion(message.pose.pose.orientation)),
        position_covariance_m2=covariance,
    )


CONVERSIONS: dict[type[object], Conversion] = {
    Fix: Conversion(to_ros=_fix_to_ros, from_ros=_fix_from_ros),
    FixVelocity: Conversion(to_ros=_fix_velocity_to_ros, from_ros=_fix_velocity_from_ros),
    VehicleImu: Conversion(to_ros=_imu_to_ros, from_ros=_imu_from_ros),
    PadSighting: Conversion(to_ros=_pad_sighting_to_ros, from_ros=_pad_sighting_from_ros),
}
"""The two directions of each message, by its type in `link.messages`."""
