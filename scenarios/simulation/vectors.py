"""Three-vectors as tuples of floats, and what the sensor models make of them."""

import math

from link.messages import Matrix3, Quaternion, Vector3


def diagonal(variance: float) -> Matrix3:
    """Return the covariance (3, 3), row by row, of three independent errors of that variance."""
    return (variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance)


def total(*vectors: Vector3) -> Vector3:
    """Return the sum of `vectors`."""
    return sum(v[0] for v in vectors), sum(v[1] for v in vectors), sum(v[2] for v in vectors)


def scaled(vector: Vector3, factor: float) -> Vector3:
    """Return `factor` times `vector`."""
    return factor * vector[0], factor * vector[1], factor * vector[2]


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the cross product of `a` and `b`."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def small_turn(rotation_vector_rad: Vector3) -> Quaternion:
    """Return the unit quaternion of a rotation vector."""
    angle_rad = math.hypot(*rotation_vector_rad)
    scale = 0.5 if angle_rad < 1e-9 else math.sin(0.5 * angle_rad) / angle_rad
    x, y, z = scaled(rotation_vector_rad, scale)
    return math.cos(0.5 * angle_rad), x, y, z
