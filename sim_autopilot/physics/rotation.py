"""Rotations: Hamilton quaternions wxyz, matrices flat in row order, ZYX Euler angles, radians."""

import math

import numpy as np

from link.compiled import kernel
from sim_autopilot.core.data import Array


@kernel
def fill_matrix(q: Array, out: Array) -> None:
    """Write R of the unit quaternion `q` (4,) into `out` (9,), row by row."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0] = 1.0 - 2.0 * (y * y + z * z)
    out[1] = 2.0 * (x * y - w * z)
    out[2] = 2.0 * (x * z + w * y)
    out[3] = 2.0 * (x * y + w * z)
    out[4] = 1.0 - 2.0 * (x * x + z * z)
    out[5] = 2.0 * (y * z - w * x)
    out[6] = 2.0 * (x * z - w * y)
    out[7] = 2.0 * (y * z + w * x)
    out[8] = 1.0 - 2.0 * (x * x + y * y)


@kernel
def fill_turned(q: Array, rotation_vector: tuple[float, float, float], out: Array) -> None:
    """Write into `out` (4,) the quaternion `q` turned by `rotation_vector`, rad, in the outer frame."""
    rx, ry, rz = rotation_vector
    angle = math.sqrt(rx * rx + ry * ry + rz * rz)
    scale = 0.5 if angle < 1e-9 else math.sin(0.5 * angle) / angle
    w, x, y, z = math.cos(0.5 * angle), scale * rx, scale * ry, scale * rz
    out[0] = w * q[0] - x * q[1] - y * q[2] - z * q[3]
    out[1] = w * q[1] + x * q[0] + y * q[3] - z * q[2]
    out[2] = w * q[2] - x * q[3] + y * q[0] + z * q[1]
    out[3] = w * q[3] + x * q[2] - y * q[1] + z * q[0]


@kernel
def euler_angles(matrix: Array) -> tuple[float, float, float]:
    """Return roll, pitch, yaw of `matrix` (9,), rad."""
    pitch = math.asin(min(1.0, max(-1.0, -matrix[6])))
    return math.atan2(matrix[7], matrix[8]), pitch, math.atan2(matrix[3], matrix[0])


@kernel
def wrapped(angle_rad: float) -> float:
    """Return the angle in [-pi, pi)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


def quaternion_from_yaw(yaw_rad: float) -> Array:
    """Return q (4,), w >= 0, of a turn about z."""
    half = 0.5 * yaw_rad
    sign = math.copysign(1.0, math.cos(half))
    return np.array([sign * math.cos(half), 0.0, 0.0, sign * math.sin(half)])
