"""What the sensors read of the turning model's state, which `imm_kernels` describes, compiled.

The vehicle's own sensors read the state as it was `c` earlier, for their clock is ahead by `c`; a tenth of a second at
most, over which the acceleration is taken as even. The pad is seen from the drone and dated by the drone's clock.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_kernels import BEND, CLOCK, LEAK, course
from companion.vehicle.imm_swing import (
    MOUNT,
    PITCH,
    PITCH_RATE,
    ROLL,
    ROLL_RATE,
    SIZE,
    UNIT_HEADING,
    antenna_swing,
    pad_swing,
)
from companion.vehicle.lever import turned

POSITION, VELOCITY, HEADING, YAW_RATE, PAD, COURSE, ACCELERATION, TILT, SURFACE = range(9)


@compiled_kernel
def horizontal_acceleration(x: Array) -> tuple[Array, Array]:
    """Return the horizontal acceleration (2,), m/s^2, of `x` and its Jacobian (2, 5) by `v`, `b` and `k`."""
    speed, ux, uy = course(x)
    k = x[6]
    G = np.zeros((2, 5))
    G[0, 0], G[0, 1], G[0, 2], G[0, 4] = -k * ux * x[3], -k * (uy * x[3] + speed), 1.0, -speed * x[3]
    G[1, 0], G[1, 1], G[1, 3], G[1, 4] = k * (ux * x[2] + speed), k * uy * x[2], 1.0, speed * x[2]
    return np.array([x[4] - k * speed * x[3], x[5] + k * speed * x[2]]), G


@compiled_kernel
def antenna_velocity(x: Array, lever: Array) -> tuple[Array, Array]:
    """Return the antenna's velocity (3,), m/s, and its Jacobian (3, 26).

    The pad's centre goes where the road goes; behind it by `lever` the antenna swings out as the vehicle turns, and
    is still lower where the road begins to climb; it swings as the body tilts.

    Args:
        x: state (26,).
        lever: (4,) from the antenna to the pad in V, and the pad's height above the axis of roll, m; zero where they
            have no known direction.
    """
    speed, ux, uy = course(x)
    arm_x, arm_y = turned(lever[0], lever[1], x[7])
    w = x[6] * speed
    hx, hy = math.cos(x[7]), math.sin(x[7])
    forward, climb = hx * x[2] + hy * x[3], x[9] - lever[0] * x[BEND]
    z, H = np.array([x[2] + w * arm_y, x[3] - w * arm_x, forward * climb + x[10]]), np.zeros((3, SIZE))
    H[0, 2], H[0, 3] = 1.0 + x[6] * ux * arm_y, x[6] * uy * arm_y
    H[1, 2], H[1, 3] = -x[6] * ux * arm_x, 1.0 - x[6] * uy * arm_x
    H[2, 2], H[2, 3], H[2, 7] = hx * climb, hy * climb, (hx * x[3] - hy * x[2]) * climb
    H[2, 9], H[2, 10], H[2, BEND] = forward, 1.0, -forward * lever[0]
    H[0, 6], H[1, 6] = speed * arm_y, -speed * arm_x
    H[0, 7], H[1, 7] = w * arm_x, w * arm_y
    swing, change = antenna_swing(x, ROLL_RATE, lever)
    return z + swing, H + change


@compiled_kernel
def observe(kind: int, x: Array, lever: Array, sees_heading: bool) -> tuple[Array, Array]:
    """Return what a sensor reads at `x`, `(m,)`, and its Jacobian `(m, 26)`.

    Args:
        kind: POSITION, VELOCITY, HEADING, YAW_RATE, PAD, ACCELERATION, TILT (roll, pitch and their rates), SURFACE (the
            pad's height) or COURSE (the course minus the heading).
        x: state (26,).
        lever: (4,) from the antenna to the pad in V, and the pad's height above the axis of roll, m.
        sees_heading: whether the heading is known, so that the lever arm has a direction.
    """
    known = lever if sees_heading else np.zeros(4)
    if kind == POSITION:
        z, H = read_position(x, known)
    elif kind == PAD:
        z, H = read_pad(x, lever, known[3], sees_heading)
    elif kind == VELOCITY:
        z, H = read_velocity(x, known)
    elif kind == HEADING:
        z, H = read_heading(x)
    elif kind == YAW_RATE:
        z, H = read_yaw_rate(x)
    elif kind == ACCELERATION:
        z, H = read_acceleration(x)
    elif kind == TILT:
        z, H = read_tilt(x)
    elif kind == SURFACE:
        place, change = read_pad(x, lever, known[3], sees_heading)
        z, H = place[2:].copy(), change[2:].copy()
    else:
        z, H = read_course(x)
    return z, H


@compiled_kernel
def pad_place(x: Array) -> tuple[Array, Array]:
    """Return the place (3,) that the state holds, m, and its Jacobian (3, 26)."""
    z, H = np.zeros(3), np.zeros((3, SIZE))
    z[0], z[1], z[2] = x[0], x[1], x[8]
    H[0, 0], H[1, 1], H[2, 8] = 1.0, 1.0, 1.0
    return z, H


@compiled_kernel
def read_position(x: Array, known: Array) -> tuple[Array, Array]:
    """Return what the vehicle's receiver reads of its antenna's place (3,), m, and the Jacobian (3, 26)."""
    z, H = pad_place(x)
    late, change = antenna_velocity(x, known)
    swing, turn = antenna_swing(x, ROLL, known)
    z += swing - x[12:15] - x[CLOCK] * late
    H += turn - x[CLOCK] * change
    H[:, CLOCK] = -late
    H[0, 12], H[1, 13], H[2, 14] = -1.0, -1.0, -1.0
    return z, H


@compiled_kernel
def read_pad(x: Array, lever: Array, above_m: float, sees_heading: bool) -> tuple[Array, Array]:
    """Return where the drone sees the pad's centre (3,), m, and the Jacobian (3, 26).

    Args:
        x: state (26,).
        lever: (4,) from the antenna to the pad in V.
        above_m: the pad's height above the axis of roll; 0 while the lever arm has no direction.
        sees_heading: whether it has one.
    """
    z, H = pad_place(x)
    arm_x, arm_y = turned(lever[0], lever[1], x[7])
    z[0] += arm_x
    z[1] += arm_y
    z[2] += lever[2] + lever[0] * x[9]
    H[2, 9] = lever[0]
    if sees_heading:
        H[0, 7], H[1, 7] = -arm_y, arm_x
    swing, turn = pad_swing(x, ROLL, above_m)
    z += swing
    H += turn
    return z, H


@compiled_kernel
def read_velocity(x: Array, known: Array) -> tuple[Array, Array]:
    """Return what the vehicle's receiver reads of its antenna's velocity (3,), m/s, and the Jacobian (3, 26)."""
    z, H = antenna_velocity(x, known)
    late, change = horizontal_acceleration(x)
    z[:2] -= x[CLOCK] * late
    H[:2, CLOCK] = -late
    H[:2, 2:7] -= x[CLOCK] * change
    return z, H


@compiled_kernel
def read_heading(x: Array) -> tuple[Array, Array]:
    """Return the heading (1,), rad, as the vehicle's unit tells it, and its Jacobian (1, 26)."""
    speed, ux, uy = course(x)
    z, H = np.zeros(1), np.zeros((1, SIZE))
    z[0] = x[7] + x[UNIT_HEADING] - x[CLOCK] * x[6] * speed
    H[0, 7], H[0, UNIT_HEADING] = 1.0, 1.0
    H[0, 6], H[0, CLOCK] = -x[CLOCK] * speed, -x[6] * speed
    H[0, 2], H[0, 3] = -x[CLOCK] * x[6] * ux, -x[CLOCK] * x[6] * uy
    return z, H


@compiled_kernel
def read_yaw_rate(x: Array) -> tuple[Array, Array]:
    """Return the yaw rate (1,), rad/s, and its Jacobian (1, 26)."""
    speed, ux, uy = course(x)
    z, H = np.zeros(1), np.zeros((1, SIZE))
    z[0], H[0, 6] = x[6] * speed, speed
    H[0, 2], H[0, 3] = x[6] * ux, x[6] * uy
    return z, H


@compiled_kernel
def read_acceleration(x: Array) -> tuple[Array, Array]:
    """Return what the accelerometer reads along V (1,), m/s^2, and its Jacobian (1, 26)."""
    z, H = np.zeros(1), np.zeros((1, SIZE))
    hx, hy = math.cos(x[7]), math.sin(x[7])
    z[0] = hx * x[4] + hy * x[5] + x[LEAK]
    H[0, 4], H[0, 5], H[0, 7], H[0, LEAK] = hx, hy, hx * x[5] - hy * x[4], 1.0
    return z, H


@compiled_kernel
def read_tilt(x: Array) -> tuple[Array, Array]:
    """Return roll, pitch, rad, and their rates, rad/s, (4,), as the vehicle's unit tells them; the Jacobian (4, 26).

    A road that climbs is nose up, which is negative, and the vehicle turns with it as the road bends.
    """
    z, H = np.zeros(4), np.zeros((4, SIZE))
    hx, hy = math.cos(x[7]), math.sin(x[7])
    forward = hx * x[2] + hy * x[3]
    z[0], z[1], z[2] = x[ROLL] + x[MOUNT], x[PITCH] - x[9] + x[MOUNT + 1], x[ROLL_RATE]
    z[3] = x[PITCH_RATE] - x[BEND] * forward
    H[3, BEND], H[3, 2], H[3, 3], H[3, 7] = -forward, -x[BEND] * hx, -x[BEND] * hy, -x[BEND] * (hx * x[3] - hy * x[2])
    H[0, ROLL], H[1, PITCH], H[1, 9], H[2, ROLL_RATE], H[3, PITCH_RATE] = 1.0, 1.0, -1.0, 1.0, 1.0
    H[0, MOUNT], H[1, MOUNT + 1] = 1.0, 1.0
    return z, H


@compiled_kernel
def read_course(x: Array) -> tuple[Array, Array]:
    """Return the course minus the heading (1,), rad, and its Jacobian (1, 26)."""
    speed = math.hypot(x[2], x[3])
    z, H = np.zeros(1), np.zeros((1, SIZE))
    z[0], H[0, 7] = math.atan2(x[3], x[2]) - x[7], -1.0
    H[0, 2], H[0, 3] = -x[3] / speed**2, x[2] / speed**2
    return z, H
