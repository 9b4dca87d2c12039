"""Motion as ROS 2 messages: true motion and rotor speeds, the planned path, and the simulator's clock.

Covariances of truth are zero. frame_id: `map` is the ENU world, `base_link` the body in FLU.
"""

import numpy as np
from rosbags.typesys.stores import ros2_humble as ros

from link.frames.rotations import quaternion_from_yaw, yaw_of
from link.messages import BodyTruth, Plan, PlannedPose, RotorTruth
from link.payloads.checks import PayloadError, check_finite, checked_quaternion, t_ns_of
from link.payloads.ros_fields import (
    BODY_FRAME,
    WORLD_FRAME,
    Conversion,
    from_quaternion,
    from_xyz,
    stamp_ns,
    to_header,
    to_point,
    to_quaternion,
    to_time,
    to_vector,
)
from link.program.clock import ClockTick

_ROTOR_NAMES = ["rotor_0", "rotor_1", "rotor_2", "rotor_3"]
_ZERO_COVARIANCE_6X6 = np.zeros(36)


def _truth_to_ros(truth: BodyTruth) -> ros.nav_msgs__msg__Odometry:
    pose = ros.geometry_msgs__msg__Pose(
        to_point("position", truth.position_enu_m), to_quaternion(truth.orientation_wxyz)
    )
    twist = ros.geometry_msgs__msg__Twist(
        to_vector("velocity", truth.velocity_flu_m_s),
        to_vector("angular velocity", truth.angular_velocity_flu_rad_s),
    )
    return ros.nav_msgs__msg__Odometry(
        to_header(truth.t_ns, WORLD_FRAME),
        BODY_FRAME,
        ros.geometry_msgs__msg__PoseWithCovariance(pose, _ZERO_COVARIANCE_6X6),
        ros.geometry_msgs__msg__TwistWithCovariance(twist, _ZERO_COVARIANCE_6X6),
    )


def _truth_from_ros(message: ros.nav_msgs__msg__Odometry) -> BodyTruth:
    pose, twist = message.pose.pose, message.twist.twist
    return BodyTruth(
        t_ns=stamp_ns(message.header),
        position_enu_m=from_xyz("position", pose.position),
        orientation_wxyz=checked_quaternion(from_quaternion(pose.orientation)),
        velocity_flu_m_s=from_xyz("velocity", twist.linear),
        angular_velocity_flu_rad_s=from_xyz("angular velocity", twist.angular),
    )


def _rotors_to_ros(rotors: RotorTruth) -> ros.sensor_msgs__msg__JointState:
    check_finite("rotor speed", rotors.speed_rad_s)
    return ros.sensor_msgs__msg__JointState(
        to_header(rotors.t_ns, BODY_FRAME), _ROTOR_NAMES, np.empty(0), np.array(rotors.speed_rad_s), np.empty(0)
    )


def _rotors_from_ros(message: ros.sensor_msgs__msg__JointState) -> RotorTruth:
    if len(message.velocity) != len(_ROTOR_NAMES):
        raise PayloadError(f"rotor speeds must be {len(_ROTOR_NAMES)}, not {len(message.velocity)}")
    a, b, c, d = message.velocity.tolist()
    check_finite("rotor speed", (a, b, c, d))
    return RotorTruth(t_ns=stamp_ns(message.header), speed_rad_s=(a, b, c, d))


def _planned_pose_to_ros(planned: PlannedPose) -> ros.geometry_msgs__msg__PoseStamped:
    check_finite("yaw", (planned.yaw_rad,))
    pose = ros.geometry_msgs__msg__Pose(
        to_point("planned position", planned.position_enu_m), to_quaternion(quaternion_from_yaw(planned.yaw_rad))
    )
    return ros.geometry_msgs__msg__PoseStamped(to_header(planned.t_ns, WORLD_FRAME), pose)


def _planned_pose_from_ros(message: ros.geometry_msgs__msg__PoseStamped) -> PlannedPose:
    return PlannedPose(
        t_ns=stamp_ns(message.header),
        position_enu_m=from_xyz("planned position", message.pose.position),
        yaw_rad=yaw_of(checked_quaternion(from_quaternion(message.pose.orientation))),
    )


def _plan_to_ros(plan: Plan) -> ros.nav_msgs__msg__Path:
    return ros.nav_msgs__msg__Path(
        to_header(plan.t_ns, WORLD_FRAME), [_planned_pose_to_ros(planned) for planned in plan.poses]
    )


def _plan_from_ros(message: ros.nav_msgs__msg__Path) -> Plan:
    poses = tuple(_planned_pose_from_ros(pose) for pose in message.poses)
    return Plan(t_ns=stamp_ns(message.header), poses=poses)


def _tick_to_ros(tick: ClockTick) -> ros.rosgraph_msgs__msg__Clock:
    return ros.rosgraph_msgs__msg__Clock(to_time(tick.t_ns))


def _tick_from_ros(message: ros.rosgraph_msgs__msg__Clock) -> ClockTick:
    return ClockTick(t_ns=t_ns_of(message.clock.sec, message.clock.nanosec))


CONVERSIONS: dict[type[object], Conversion] = {
    BodyTruth: Conversion(to_ros=_truth_to_ros, from_ros=_truth_from_ros),
    RotorTruth: Conversion(to_ros=_rotors_to_ros, from_ros=_rotors_from_ros),
    Plan: Conversion(to_ros=_plan_to_ros, from_ros=_plan_from_ros),
    ClockTick: Conversion(to_ros=_tick_to_ros, from_ros=_tick_from_ros),
}
"""The two directions of each message, by its type in `link.messages`."""
