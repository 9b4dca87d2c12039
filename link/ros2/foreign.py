"""Messages of other people's vehicles as our own: an odometry, a velocity without covariance, static transforms.

What is refused raises PayloadError.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from link.frames.geodesy import Datum, geodetic_from_enu
from link.frames.rotations import conjugate, multiply, rotate
from link.messages import Fix, FixVelocity, Matrix3, Quaternion, Vector3, VehicleImu
from link.payloads import cdr
from link.payloads.checks import PayloadError, checked_covariance, checked_quaternion
from link.payloads.ros_fields import from_quaternion, from_xyz, matrix3, stamp_ns

ODOMETRY = "nav_msgs/msg/Odometry"
TWIST = "geometry_msgs/msg/TwistStamped"
TRANSFORMS = "tf2_msgs/msg/TFMessage"

_YAW_RATE = 35  # of a row-major 6x6: the variance about z
Transforms = dict[str, tuple[str, Vector3, Quaternion]]
"""Of each frame its parent, and its place and attitude in that parent."""


def fix_of_odometry(payload: bytes, frame: str, origin: Datum) -> Fix:
    """Return where an odometry's body is.

    Args:
        payload: a nav_msgs/msg/Odometry in CDR.
        frame: that its pose must be in, with axes ENU.
        origin: of `frame`.
    """
    message = _odometry(payload, frame)
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(
        origin, from_xyz("position", message.pose.pose.position)
    )
    return Fix(
        t_ns=stamp_ns(message.header),
        latitude_rad=latitude_rad,
        longitude_rad=longitude_rad,
        altitude_m=altitude_m,
        covariance_enu_m2=_block(message.pose.covariance, 0),
    )


def velocity_of_odometry(payload: bytes, frame: str) -> FixVelocity:
    """Return an odometry's velocity, which it tells in its body, in ENU, and its yaw rate."""
    message = _odometry(payload, frame)
    q_WV = _orientation(message)
    twist = message.twist.twist
    covariance = _block(message.twist.covariance, 0)
    variance = float(message.twist.covariance[_YAW_RATE])
    return FixVelocity(
        t_ns=stamp_ns(message.header),
        velocity_enu_m_s=rotate(q_WV, from_xyz("velocity", twist.linear)),
        velocity_covariance_enu_m2_s2=None if covariance is None else _turned(q_WV, covariance),
        yaw_rate_rad_s=from_xyz("angular velocity", twist.angular)[2],
        yaw_rate_variance_rad2_s2=variance if variance > 0.0 else None,
    )


def imu_of_odometry(payload: bytes, frame: str) -> VehicleImu:
    """Return an odometry's attitude and angular velocity."""
    message = _odometry(payload, frame)
    return VehicleImu(
        t_ns=stamp_ns(message.header),
        orientation_wxyz=_orientation(message),
        orientation_covariance_rad2=_block(message.pose.covariance, 3),
        angular_velocity_flu_rad_s=from_xyz("angular velocity", message.twist.twist.angular),
        angular_velocity_covariance_rad2_s2=_block(message.twist.covariance, 3),
    )


def velocity_of_twist(payload: bytes) -> FixVelocity:
    """Return the velocity in a geometry_msgs/msg/TwistStamped, whose axes are ENU; its angular part is not read."""
    message: Any = cdr.decode_ros(TWIST, payload)
    return FixVelocity(t_ns=stamp_ns(message.header), velocity_enu_m_s=from_xyz("velocity", message.twist.linear))


def transforms_of(payload: bytes) -> Transforms:
    """Return the transforms in a tf2_msgs/msg/TFMessage."""
    message: Any = cdr.decode_ros(TRANSFORMS, payload)
    return {
        one.child_frame_id: (
            one.header.frame_id,
            from_xyz("translation", one.transform.translation),
            checked_quaternion(from_quaternion(one.transform.rotation)),
        )
        for one in message.transforms
    }


def lever(transforms: Transforms, vehicle: str, antenna: str, pad: str) -> Vector3 | None:
    """Return the way from the antenna to the pad in the axes of `vehicle`, None while transforms are missing."""
    places = [_place(transforms, vehicle, frame) for frame in (antenna, pad)]
    if places[0] is None or places[1] is None:
        return None
    (ax, ay, az), (px, py, pz) = places[0], places[1]
    return (px - ax, py - ay, pz - az)


def _place(transforms: Transforms, vehicle: str, frame: str) -> Vector3 | None:
    """Return where `frame` is in `vehicle`, over what both hang on."""
    in_root, vehicle_in_root = _pose(transforms, frame), _pose(transforms, vehicle)
    if in_root[0] != vehicle_in_root[0]:
        return None
    (_, place, _), (_, origin, q_RV) = in_root, vehicle_in_root
    return rotate(conjugate(q_RV), tuple(a - b for a, b in zip(place, origin, strict=True)))


def _pose(transforms: Transforms, frame: str) -> tuple[str, Vector3, Quaternion]:
    """Return the root that `frame` hangs on, and its place and attitude there."""
    place: Vector3 = (0.0, 0.0, 0.0)
    attitude: Quaternion = (1.0, 0.0, 0.0, 0.0)
    for _ in transforms:  # a chain is no longer than that; a ring ends here
        if frame not in transforms:
            break
        frame, translation, rotation = transforms[frame]
        x, y, z = rotate(rotation, place)
        place = (x + translation[0], y + translation[1], z + translation[2])
        attitude = multiply(rotation, attitude)
    return frame, place, attitude


def _odometry(payload: bytes, frame: str) -> Any:
    message: Any = cdr.decode_ros(ODOMETRY, payload)
    if message.header.frame_id != frame:
        raise PayloadError(f"the odometry is in frame {message.header.frame_id!r}, not {frame!r}")
    return message


def _orientation(message: Any) -> Quaternion:
    return checked_quaternion(from_quaternion(message.pose.pose.orientation))


def _block(covariance: NDArray[np.float64], first: int) -> Matrix3 | None:
    """Return the 3x3 block of a row-major 6x6 that begins at `first`, None for unknown."""
    block = covariance.reshape(6, 6)[first : first + 3, first : first + 3]
    return checked_covariance("covariance", matrix3(block.reshape(9)))


def _turned(q_WV: Quaternion, covariance: Matrix3) -> Matrix3:
    """Return a covariance in V as one in W."""
    R_WV = np.column_stack([rotate(q_WV, axis) for axis in np.eye(3).tolist()])
    turned = R_WV @ np.array(covariance).reshape(3, 3) @ R_WV.T
    return matrix3(0.5 * (turned + turned.T).reshape(9))
