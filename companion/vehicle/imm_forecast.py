"""What the interacting turning models tell: the antenna's motion now and over the horizon, compiled.

`motion` (18,) is as `imm_mixing` has it.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_kernels import BEND, course
from companion.vehicle.imm_mixing import (
    Modes,
    combine,
    glide,
    heading_variance,
    is_heading_known,
    shifted,
    steps_of,
    with_direction,
)
from companion.vehicle.imm_noise import AFLOAT, BEND_ACCELERATION_STD, BEND_STD
from companion.vehicle.imm_sensors import antenna_velocity, horizontal_acceleration
from companion.vehicle.imm_swing import MOUNT, OWN_RATE, ROLL, SIZE, antenna_swing, pad_swing, pad_swing_acceleration
from companion.vehicle.small_matrices import carried_through, times

SAME_S = 1e-9  # of two steps that differ by rounding only
_REVERSES_M_S = 0.5  # slower than this backwards, a vehicle that is pushed backwards is one that brakes
_SLIPS_M_S = 0.3  # aside: more is no error of a receiver


@compiled_kernel
def kinematics(states: Array, motion: Array) -> tuple[Array, Array, Array]:
    """Return the antenna's position and velocity and the pad's acceleration in W, each (n, 3), of `states` (n, 26)."""
    n = len(states)
    position, velocity, acceleration = np.empty((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    for i in range(n):
        x = states[i]
        swing, _ = antenna_swing(x, ROLL, motion[5:9])
        position[i, 0], position[i, 1], position[i, 2] = x[0] + swing[0], x[1] + swing[1], x[8] + swing[2]
        velocity[i], _ = antenna_velocity(x, motion[5:9])
        acceleration[i, :2], _ = horizontal_acceleration(x)
        shaken, _ = pad_swing_acceleration(x, motion)
        acceleration[i, :2] += shaken
        hx, hy = np.cos(x[7]), np.sin(x[7])
        forward, pull = hx * x[2] + hy * x[3], hx * x[4] + hy * x[5]
        climbing = pull * x[9] + forward**2 * x[BEND]
        acceleration[i, 2] = climbing + x[11]
    return position, velocity, acceleration


@compiled_kernel
def kinematics_jacobian(x: Array, motion: Array) -> Array:
    """Return the Jacobian `(9, 26)` of position, velocity and acceleration."""
    G = np.zeros((9, SIZE))
    G[0, 0], G[1, 1], G[2, 8], G[8, 11] = 1.0, 1.0, 1.0, 1.0
    _, turn = antenna_swing(x, ROLL, motion[5:9])
    G[0:3] += turn
    _, G[3:6] = antenna_velocity(x, motion[5:9])
    _, G[6:8, 2:7] = horizontal_acceleration(x)
    _, shaking = pad_swing_acceleration(x, motion)
    G[6:8] += shaking
    hx, hy = np.cos(x[7]), np.sin(x[7])
    forward, pull = hx * x[2] + hy * x[3], hx * x[4] + hy * x[5]
    G[8, 2], G[8, 3] = 2.0 * forward * x[BEND] * hx, 2.0 * forward * x[BEND] * hy
    G[8, 4], G[8, 5], G[8, 9], G[8, BEND] = x[9] * hx, x[9] * hy, pull, forward**2
    G[8, 7] = x[9] * (hx * x[5] - hy * x[4]) + 2.0 * forward * x[BEND] * (hx * x[3] - hy * x[2])
    return G


@compiled_kernel
def braked_straight(x: Array, within_s: float, tau_s: float, knows_heading: bool) -> Array:
    """Return the state (26,) with what moves it aside taken off, as far as it brakes to a standstill `within_s`.

    What accelerates a vehicle aside without turning it is an error of the filter. It would turn a velocity that fades
    about, and a vehicle that brakes to a stop would be forecast to drive backwards, as one would that stands by now.

    Args:
        x: state (26,).
        within_s: time to look ahead.
        tau_s: time constant of the acceleration.
        knows_heading: whether the heading says where ahead is; if not, the course does.
    """
    _, ux, uy = course(x)
    if knows_heading:
        ux, uy = math.cos(x[7]), math.sin(x[7])
        if ux * x[2] + uy * x[3] < -_REVERSES_M_S:
            ux, uy = -ux, -uy
    ahead, aside = ux * x[2] + uy * x[3], ux * x[3] - uy * x[2]
    push, push_aside = ux * x[4] + uy * x[5], ux * x[5] - uy * x[4]
    brakes_m_s = -push * tau_s * (1.0 - math.exp(-within_s / tau_s))
    y = x.copy()
    if ux == 0.0 and uy == 0.0:  # at rest, and nothing says where ahead is
        return y
    if brakes_m_s > max(-ahead, 0.0) and ahead <= 0.0 and abs(aside) < _SLIPS_M_S:
        y[2:6] = 0.0
        return y
    share = min(max(2.0 - 2.0 * brakes_m_s / max(ahead, 1e-6), 0.0), 1.0)  # of what is aside: none where it stops
    push_aside *= share
    if abs(aside) < _SLIPS_M_S:
        aside *= share
    y[2], y[3] = ahead * ux - aside * uy, ahead * uy + aside * ux
    y[4], y[5] = push * ux - push_aside * uy, push * uy + push_aside * ux
    return y


@compiled_kernel
def horizon(x: Array, P: Array, offset_s: Array, noise: Array, motion: Array) -> tuple[Array, Array]:
    """Return the means `(n, 26)` and variances `(n, 8)` at `offset_s` (n,), not falling.

    Of the pad's place, because a heading that is not well known moves it about an antenna that is; of its rate upwards;
    and of the roll, its rate, the pitch and its rate.
    """
    n = len(offset_s)
    means, variances = np.empty((n, SIZE)), np.empty((n, 8))
    passed_s, glides_s = 0.0, offset_s[n - 1] - offset_s[max(n - 2, 0)]  # most horizons are even
    steps = steps_of(glides_s, motion)
    for i in range(n):
        ahead_s = offset_s[i] - passed_s
        if ahead_s > 0.0:
            if abs(ahead_s - glides_s) > SAME_S:
                glides_s, steps = ahead_s, steps_of(ahead_s, motion)
            x, P = glide(x, P, steps, noise, motion)
            passed_s = offset_s[i]
        means[i] = x
        _, S = shifted(x, P, motion[5:8], 1.0)
        variances[i, 0], variances[i, 1] = S[0, 0], S[1, 1]
        _, rising = antenna_velocity(x, np.zeros(4))
        variances[i, 2], variances[i, 3] = S[8, 8], (times(rising[2:3], S) @ rising[2])[0]
        for j in range(4):
            variances[i, 4 + j] = P[ROLL + j, ROLL + j]
        if motion[12] > 0.0:
            _, H = pad_swing(x, ROLL, motion[8])
            H[:, 7] = 0.0
            H[0, 0], H[1, 1] = 1.0, 1.0
            for axis in range(2):
                variances[i, axis] = (times(H[axis : axis + 1], S) @ H[axis])[0]
    return means, variances


@compiled_kernel
def forecast_modes(
    modes: Modes, offset_s: Array, noises: Array, motion: Array, known_variance: float
) -> tuple[Array, Array, Array, Array, Array, Array, Array, float]:
    """Return the mixture over the horizon.

    Args:
        modes: the filter.
        offset_s: (n,) not falling.
        noises: (n, 18) of the modes.
        motion: its numbers.
        known_variance: of a heading that is known, rad^2; without one the lever arm has no direction.

    Returns:
        Position, velocity and acceleration, each (n, 3), heading and grade, each (n,), the tilt (n, 4) as
        `imm_swing` has it, the deviations (n, 8) as `horizon` has them, and the present variance of the heading,
        rad^2.
    """
    directed = with_direction(motion, modes, known_variance)
    x, P = combine(modes[0], modes[1], modes[2])
    x[OWN_RATE] = 0.0  # the drone goes with its own height
    knows_heading = is_heading_known(modes, known_variance)
    if noises[0, AFLOAT] == 0.0:  # a vessel drifts
        x = braked_straight(x, offset_s[-1], motion[0], knows_heading)
    noise = (modes[2].reshape(-1, 1) * noises).sum(axis=0)
    for std in (BEND_STD, BEND_ACCELERATION_STD):  # the others in which the modes differ are densities
        noise[std] = math.sqrt((modes[2] * noises[:, std] ** 2).sum())
    means, variances = horizon(x, P, offset_s, noise, directed)
    position, velocity, acceleration = kinematics(means, directed)
    yaw, grade, tilt = means[:, 7].copy(), means[:, 9].copy(), means[:, ROLL:MOUNT].copy()
    return position, velocity, acceleration, yaw, grade, tilt, np.sqrt(variances), heading_variance(modes)


@compiled_kernel
def describe_modes(modes: Modes, motion: Array, known_variance: float) -> tuple[Array, Array, Array, float]:
    """Return the mixture now.

    Args:
        modes: the filter.
        motion: its numbers.
        known_variance: of a heading that is known, rad^2; without one the lever arm has no direction.

    Returns:
        The mean (26,); position, velocity and acceleration (9,) and their covariance (9, 9); and the variance of the
        heading, rad^2.
    """
    directed = with_direction(motion, modes, known_variance)
    x, P = combine(modes[0], modes[1], modes[2])
    told = np.empty((1, 9))
    told[:, :3], told[:, 3:6], told[:, 6:] = kinematics(x.reshape(1, SIZE), directed)
    return x, told[0], carried_through(kinematics_jacobian(x, directed), P), heading_variance(modes)


@compiled_kernel
def describe_pad(modes: Modes, motion: Array, known_variance: float) -> tuple[Array, Array]:
    """Return how far each mode has the pad off the mixture, (n, 9), and its covariance, (n, 9, 9).

    Place, velocity and acceleration are of the pad's centre; without a known heading that is where the antenna is.

    Args:
        modes: the filter.
        motion: its numbers.
        known_variance: of a heading that is known, rad^2; without one the lever arm has no direction.
    """
    lever = with_direction(motion, modes, known_variance)[5:8]
    means, covariances, weights = modes
    at_pad, known = means.copy(), covariances.copy()
    for j in range(len(weights)):
        at_pad[j], known[j] = shifted(means[j], covariances[j], lever, 1.0)
    x, _ = combine(at_pad, known, weights)
    without_arm = motion.copy()
    without_arm[5:9] = 0.0
    n = len(weights)
    told, spread = np.empty((n + 1, 9)), np.empty((n, 9, 9))
    told[:, :3], told[:, 3:6], told[:, 6:] = kinematics(np.concatenate((x.reshape(1, SIZE), at_pad)), without_arm)
    for j in range(n):
        spread[j] = carried_through(kinematics_jacobian(at_pad[j], without_arm), known[j])
    return told[1:] - told[0], spread
