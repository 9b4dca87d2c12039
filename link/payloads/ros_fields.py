"""The parts that the ROS 2 messages share: stamps, vectors, quaternions and covariances, checked both ways."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys.stores import ros2_humble as ros

from link.messages import Matrix3, Quaternion, Vector3
from link.payloads.checks import (
    PayloadError,
    check_finite,
    checked_covariance,
    checked_quaternion,
    t_ns_of,
)
from link.units import NS_PER_S

Array = NDArray[np.float64]

_SECONDS_MAX = 2**31 - 1
_UNKNOWN_COVARIANCE = np.zeros(9)

WORLD_FRAME = "map"
BODY_FRAME = "base_link"
ANTENNA_FRAME = "gnss"


@dataclass(frozen=True, slots=True, kw_only=True)
class Conversion:
    """How a message becomes its ROS message and back; `from_ros` raises PayloadError."""

    to_ros: Callable[[Any], object]
    from_ros: Callable[[Any], object]


def to_time(t_ns: int) -> ros.builtin_interfaces__msg__Time:
    """Return UTC nanoseconds as a stamp, PayloadError if ROS cannot hold them."""
    seconds, nanoseconds = divmod(t_ns, NS_PER_S)
    if not 0 <= seconds <= _SECONDS_MAX:
        raise PayloadError(f"t_ns {t_ns} is out of range")
    return ros.builtin_interfaces__msg__Time(seconds, nanoseconds)


def to_header(t_ns: int, frame_id: str) -> ros.std_msgs__msg__Header:
    """Return the header of a message about the instant `t_ns`."""
    return ros.std_msgs__msg__Header(to_time(t_ns), frame_id)


def stamp_ns(header: ros.std_msgs__msg__Header) -> int:
    """Return a header's stamp as UTC nanoseconds, PayloadError if it is out of range."""
    return t_ns_of(header.stamp.sec, header.stamp.nanosec)


def to_vector(name: str, vector: Vector3) -> ros.geometry_msgs__msg__Vector3:
    """Return a Vector3, PayloadError if a component is not finite."""
    check_finite(name, vector)
    return ros.geometry_msgs__msg__Vector3(*vector)


def to_point(name: str, vector: Vector3) -> ros.geometry_msgs__msg__Point:
    """Return a Point, PayloadError if a component is not finite."""
    check_finite(name, vector)
    return ros.geometry_msgs__msg__Point(*vector)


def from_xyz(name: str, vector: ros.geometry_msgs__msg__Vector3 | ros.geometry_msgs__msg__Point) -> Vector3:
    """Return a received vector or point, PayloadError if a component is not finite."""
    values = (vector.x, vector.y, vector.z)
    check_finite(name, values)
    return values


def to_quaternion(quaternion: Quaternion) -> ros.geometry_msgs__msg__Quaternion:
    """Return a Quaternion (xyzw) from wxyz, PayloadError if its length is not 1."""
    w, x, y, z = checked_quaternion(quaternion)
    return ros.geometry_msgs__msg__Quaternion(x, y, z, w)


def from_quaternion(quaternion: ros.geometry_msgs__msg__Quaternion) -> Quaternion:
    """Return a received quaternion as wxyz, unchecked."""
    return (quaternion.w, quaternion.x, quaternion.y, quaternion.z)


def to_covariance(name: str, covariance: Matrix3 | None) -> Array:
    """Return a row-major 3x3 covariance, zeros for unknown, PayloadError if it is not finite."""
    if covariance is None:
        return _UNKNOWN_COVARIANCE
    check_finite(name, covariance)
    return np.array(covariance, dtype=np.float64)


def matrix3(values: Array) -> Matrix3:
    """Return nine array elements as a tuple of floats."""
    a, b, c, d, e, f, g, h, i = values.tolist()
    return (a, b, c, d, e, f, g, h, i)


def to_block_6x6(name: str, covariance: Matrix3 | None) -> Array:
    """Return a row-major 6x6 whose upper left block is `covariance`."""
    full = np.zeros((6, 6))
    full[:3, :3] = to_covariance(name, covariance).reshape(3, 3)
    return full.reshape(36)


def from_block_6x6(name: str, full: Array) -> Matrix3 | None:
    """Return the upper left 3x3 block of a received row-major 6x6, None for unknown."""
    return checked_covariance(name, matrix3(full.reshape(6, 6)[:3, :3].reshape(9)))
