"""Rotations and the axis conventions of aerial robotics, as plain arithmetic on tuples of floats.

Frames: ENU (east, north, up) and FLU (forward, left, up) inside the project; NED (north, east, down) and FRD
(forward, right, down) on MAVLink. Quaternions are Hamilton, order wxyz, unit; `q_WB` turns B's coordinates into W's.
Every function takes any three or four numbers (tuples, lists, arrays) and returns tuples of floats. Angles are in
radians.
Source: Diebel, Representing Attitude: Euler Angles, Unit Quaternions, and Rotation Vectors, 2006.
"""

from collections.abc import Sequence
from math import asin, atan2, copysign, cos, hypot, pi, remainder, sin, sqrt, tau

import numpy as np
from numpy.typing import NDArray

from link.messages import Quaternion, Vector3

Array = NDArray[np.float64]
Numbers = Sequence[float] | Array

_HALF_SQRT2 = sqrt(0.5)


def wrap_angle(angle_rad: float) -> float:
    """Return the same angle in (-pi, pi]."""
    wrapped = remainder(angle_rad, tau)
    return pi if wrapped <= -pi else wrapped


def ned_from_enu(vector: Numbers) -> Vector3:
    """Return an ENU vector in NED; the mapping is its own inverse."""
    east, north, up = vector
    return (north, east, -up)


def enu_from_ned(vector: Numbers) -> Vector3:
    """Return a NED vector in ENU."""
    north, east, down = vector
    return (east, north, -down)


def frd_from_flu(vector: Numbers) -> Vector3:
    """Return an FLU vector in FRD; the mapping is its own inverse."""
    forward, left, up = vector
    return (forward, -left, -up)


def flu_from_frd(vector: Numbers) -> Vector3:
    """Return an FRD vector in FLU."""
    forward, right, down = vector
    return (forward, -right, -down)


def yaw_ned_from_enu(yaw_rad: float) -> float:
    """Return a yaw counter-clockwise from east as a heading clockwise from north, in (-pi, pi]."""
    return wrap_angle(0.5 * pi - yaw_rad)


def yaw_enu_from_ned(yaw_rad: float) -> float:
    """Return a heading clockwise from north as a yaw counter-clockwise from east, in (-pi, pi]."""
    return wrap_angle(0.5 * pi - yaw_rad)


def quaternion_ned_frd_from_enu_flu(q_WB: Numbers) -> Quaternion:
    """Return `q_WB` between NED and FRD, as MAVLink has it, from the one between ENU and FLU.

    It is q_NED_ENU * q_WB * q_FLU_FRD: half turns about (x + y) / sqrt(2) and about x, multiplied out.
    """
    w, x, y, z = q_WB
    return canonical((_HALF_SQRT2 * (w + z), _HALF_SQRT2 * (x + y), _HALF_SQRT2 * (x - y), _HALF_SQRT2 * (w - z)))


def quaternion_enu_flu_from_ned_frd(q_WB: Numbers) -> Quaternion:
    """Return `q_WB` between ENU and FLU from MAVLink's, between NED and FRD.

    The two axis changes are half turns, so the mapping is the same as the other way.
    """
    return quaternion_ned_frd_from_enu_flu(q_WB)


def canonical(q: Numbers) -> Quaternion:
    """Return the one of `q` and `-q`, which are the same rotation, that has w >= 0."""
    w, x, y, z = q
    return (-w, -x, -y, -z) if w < 0.0 else (w, x, y, z)


def normalized(q: Numbers) -> Quaternion:
    """Return `q` scaled to unit length, with w >= 0.

    Raises:
        ValueError: If its length is zero or not finite.
    """
    w, x, y, z = q
    length = hypot(w, x, y, z)
    if not 0.0 < length < float("inf"):
        raise ValueError(f"a quaternion needs a finite length above 0, got {(w, x, y, z)}")
    return canonical((w / length, x / length, y / length, z / length))


def conjugate(q: Numbers) -> Quaternion:
    """Return the inverse rotation of a unit quaternion."""
    w, x, y, z = q
    return (w, -x, -y, -z)


def multiply(p: Numbers, q: Numbers) -> Quaternion:
    """Return the Hamilton product `p q`: first `q`, then `p`."""
    pw, px, py, pz = p
    qw, qx, qy, qz = q
    return (
        pw * qw - px * qx - py * qy - pz * qz,
        pw * qx + px * qw + py * qz - pz * qy,
        pw * qy - px * qz + py * qw + pz * qx,
        pw * qz + px * qy - py * qx + pz * qw,
    )


def rotate(q_AB: Numbers, vector: Numbers) -> Vector3:
    """Return in A a vector given in B."""
    w, x, y, z = q_AB
    vx, vy, vz = vector
    # v + 2 w (u x v) + 2 u x (u x v), with u the vector part
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def quaternion_from_yaw(yaw_rad: float) -> Quaternion:
    """Return the turn by `yaw_rad` about z, with w >= 0."""
    return canonical((cos(0.5 * yaw_rad), 0.0, 0.0, sin(0.5 * yaw_rad)))


def yaw_of(q_WB: Numbers) -> float:
    """Return the direction of B's x axis seen along W's z, from W's x axis, in (-pi, pi]."""
    w, x, y, z = q_WB
    return atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def quaternion_from_roll_pitch_yaw(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Quaternion:
    """Return the attitude reached by turning about z, the new y and the new x (ZYX), with w >= 0."""
    cr, sr = cos(0.5 * roll_rad), sin(0.5 * roll_rad)
    cp, sp = cos(0.5 * pitch_rad), sin(0.5 * pitch_rad)
    cy, sy = cos(0.5 * yaw_rad), sin(0.5 * yaw_rad)
    return canonical(
        (
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )
    )


def roll_pitch_yaw_of(q_WB: Numbers) -> Vector3:
    """Return roll and yaw in (-pi, pi] and pitch in [-pi/2, pi/2] (ZYX).

    At a pitch of +-pi/2 roll and yaw are not told apart; their split is then arbitrary.
    """
    w, x, y, z = q_WB
    roll = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    sin_pitch = 2.0 * (w * y - z * x)
    # rounding may carry the sine of a vertical attitude past 1
    pitch = asin(sin_pitch) if abs(sin_pitch) < 1.0 else copysign(0.5 * pi, sin_pitch)
    return (roll, pitch, yaw_of((w, x, y, z)))


def matrix_from_quaternion(q_AB: Numbers) -> Array:
    """Return R_AB (3, 3), which turns B's coordinates into A's."""
    return np.column_stack([rotate(q_AB, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))])


def quaternion_from_matrix(R_AB: Array) -> Quaternion:
    """Return the unit quaternion, w >= 0, of a rotation matrix (3, 3).

    The largest of its four components comes first, so none is divided by a small one. Source: Shepperd 1978.
    """
    (a, b, c), (d, e, f), (g, h, i) = np.asarray(R_AB, np.float64).tolist()
    choices = (
        (1.0 + a + e + i, (1.0 + a + e + i, h - f, c - g, d - b)),
        (1.0 + a - e - i, (h - f, 1.0 + a - e - i, b + d, c + g)),
        (1.0 - a + e - i, (c - g, b + d, 1.0 - a + e - i, f + h)),
        (1.0 - a - e + i, (d - b, c + g, f + h, 1.0 - a - e + i)),
    )
    return normalized(max(choices, key=lambda choice: choice[0])[1])
