"""How a deck's tilt swings and moves what is on it, compiled: six states of the model of `imm_kernels`.

State: 18 phi, 19 its rate, 20 theta, 21 its rate: roll (port up positive) and pitch (bow down positive) of V against
the road, rad and rad/s, each a damped oscillator; 22 and 23 what the vehicle's unit tells of roll and of pitch too
much, rad, as it is not mounted along the deck. The body tilts about an axis below the pad, on the road or the water.
Heave is that of the pad, so that what pitching lifts there is part of it.
The pad is followed to the first order in the tilt, the arm from it to the antenna to the second (`lever.tilted_arm`).
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.lever import tilted_arm, turned
from companion.vehicle.small_matrices import carried_through, times, white_jerk

HEAVE_RATE = 10
ROLL, ROLL_RATE, PITCH, PITCH_RATE, MOUNT = 18, 19, 20, 21, 22
OWN_RATE = 24  # the first state that is none of the deck's
UNIT_HEADING = 25
SIZE = 26


@compiled_kernel
def antenna_swing(x: Array, first: int, lever: Array) -> tuple[Array, Array]:
    """Return how far (3,) the tilt moves the antenna in W, or how fast, and its Jacobian (3, 26).

    Args:
        x: state (26,).
        first: `ROLL` for places, `ROLL_RATE` for velocities.
        lever: (4,) from the antenna to the pad in V, and the pad's height above the axis of roll, m.
    """
    out, H = pad_swing(x, first, lever[3])
    moved, by_tilt = tilted_arm(-lever[0], -lever[1], -lever[2], x[ROLL], x[PITCH])
    if first == ROLL_RATE:
        roll_rate, pitch_rate = x[ROLL_RATE], x[PITCH_RATE]
        moved = by_tilt[:, 0] * roll_rate + by_tilt[:, 1] * pitch_rate
        # what it changes by with the tilt itself: the arm's own length, to the second order
        put_turned(H, x, ROLL, (-lever[1] * pitch_rate, lever[1] * roll_rate, lever[2] * roll_rate))
        put_turned(H, x, PITCH, (lever[0] * pitch_rate - lever[1] * roll_rate, 0.0, lever[2] * pitch_rate))
    for i in range(2):
        put_turned(H, x, first + 2 * i, (by_tilt[0, i], by_tilt[1, i], by_tilt[2, i]))
    put_turned(H, x, 7, (-moved[1], moved[0], 0.0))
    east, north = turned(moved[0], moved[1], x[7])
    out[0] += east
    out[1] += north
    out[2] += moved[2]
    return out, H


@compiled_kernel
def put_turned(H: Array, x: Array, column: int, change: tuple[float, float, float]) -> None:
    """Add `change`, forward, left and up, to a column of a Jacobian (3, 26) in W."""
    east, north = turned(change[0], change[1], x[7])
    H[0, column] += east
    H[1, column] += north
    H[2, column] += change[2]


@compiled_kernel
def pad_swing(x: Array, first: int, above_m: float) -> tuple[Array, Array]:
    """Return how far (3,) the tilt moves what is `above_m` over the axis in W, and its Jacobian (3, 26).

    Args:
        x: state (26,).
        first: `ROLL` for places, `ROLL_RATE` for velocities.
        above_m: height.
    """
    c, s = math.cos(x[7]), math.sin(x[7])
    roll, pitch = x[first], x[first + 2]
    out, H = np.zeros(3), np.zeros((3, SIZE))
    out[0], out[1] = above_m * (c * pitch + s * roll), above_m * (s * pitch - c * roll)
    H[0, first], H[0, first + 2] = above_m * s, above_m * c
    H[1, first], H[1, first + 2] = -above_m * c, above_m * s
    H[0, 7], H[1, 7] = -out[1], out[0]
    return out, H


@compiled_kernel
def pad_swing_acceleration(x: Array, motion: Array) -> tuple[Array, Array]:
    """Return the horizontal acceleration (2,) of the pad by its swing, m/s^2, and its Jacobian (2, 26).

    Args:
        x: state (26,).
        motion: (18,) as `imm_mixing` has it.
    """
    y, H = x.copy(), np.zeros((2, SIZE))
    for first, k in ((ROLL, 10), (PITCH, 13)):
        stiffness, damping = motion[k] ** 2, 2.0 * motion[k + 1] * motion[k]
        y[first] = -stiffness * x[first] - damping * x[first + 1]
    out, change = pad_swing(y, ROLL, motion[8])
    for first, k in ((ROLL, 10), (PITCH, 13)):
        H[:, first] = -(motion[k] ** 2) * change[:2, first]
        H[:, first + 1] = -2.0 * motion[k + 1] * motion[k] * change[:2, first]
    H[:, 7] = change[:2, 7]
    return out[:2], H


_DOUBLINGS = 6


@compiled_kernel
def heave_step(dt_s: float, frequency_rad_s: float, damping: float, std_m: float) -> tuple[Array, Array]:
    """Return transition and noise, each (2, 2), of a damped oscillator driven by white noise to a steady `std_m`."""
    damped = frequency_rad_s * math.sqrt(1.0 - damping**2)
    fade = math.exp(-damping * frequency_rad_s * dt_s)
    c, s = math.cos(damped * dt_s), math.sin(damped * dt_s)
    ratio = damping * frequency_rad_s / damped
    A = np.empty((2, 2))
    A[0, 0], A[0, 1] = fade * (c + ratio * s), fade * (s / damped)
    A[1, 0], A[1, 1] = fade * (-(frequency_rad_s**2) / damped * s), fade * (c - ratio * s)
    place, rate = std_m**2, (std_m * frequency_rad_s) ** 2
    noise = np.empty((2, 2))
    noise[0, 0] = place - (A[0, 0] * place * A[0, 0] + A[0, 1] * rate * A[0, 1])
    noise[1, 1] = rate - (A[1, 0] * place * A[1, 0] + A[1, 1] * rate * A[1, 1])
    noise[0, 1] = noise[1, 0] = -(A[0, 0] * place * A[1, 0] + A[0, 1] * rate * A[1, 1])
    return A, noise


@compiled_kernel
def smooth_step(dt_s: float, frequency_rad_s: float, damping: float, std_m_s: float) -> tuple[Array, Array]:
    """Return transition and noise, each (3, 3), of a place whose rate is such an oscillator, to a steady `std_m_s`.

    The noise is that of a 64th of the step, where it is that of white jerk, added up by doubling.
    """
    psd = 4.0 * damping * frequency_rad_s**3 * std_m_s**2
    d = dt_s / 2**_DOUBLINGS
    A, noise = np.eye(3), np.empty((3, 3))
    A[1:, 1:], _ = heave_step(d, frequency_rad_s, damping, std_m_s)
    for i, started in enumerate(((1.0, 0.0), (0.0, 1.0))):  # integrate w'' + 2 d f w' + f^2 w = 0
        gained = A[2, 1 + i] - started[1] + 2.0 * damping * frequency_rad_s * (A[1, 1 + i] - started[0])
        A[0, 1 + i] = -gained / frequency_rad_s**2
    white = white_jerk(d)
    for i in range(3):
        for j in range(3):
            noise[i, j] = psd * white[i][j]
    for _ in range(_DOUBLINGS):
        noise = carried_through(A, noise) + noise
        A = times(A, A)
    return A, noise
