"""Compiled steps of interacting turning models that differ in their noise only (Blom and Bar-Shalom 1988).

`Modes` are means (n, 26), covariances (n, 26, 26) and probabilities (n,). Between measurements the vehicle may change
from any mode to any other as a continuous Markov chain in which each begins at a rate of its own. `motion` (18,) is the
time constant of the acceleration, s, the heave's angular frequency, rad/s, damping and standard deviation of its rate,
m/s, the time constant of the clock's difference, s, the lever arm (3,) from the antenna to the pad in V and the pad's
height above the axis of roll, m, the time constant of what the accelerometer reads too much, s, the same three numbers
of roll and of pitch as of heave, rad, and the time constants of the rate of the drone's own height and of what the
unit tells of the heading too much, s.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_kernels import BEND, CLOCK, LEAK, advance
from companion.vehicle.imm_noise import bend_step, curvature_left, process_noise
from companion.vehicle.imm_swing import OWN_RATE, SIZE, UNIT_HEADING, heave_step, smooth_step
from companion.vehicle.lever import turned
from companion.vehicle.small_matrices import carried_through

Modes = tuple[Array, Array, Array]
Steps = tuple[int, float, Array, Array, Array, Array]
"""Their number and length, s, and transition and noise of the heave, (3, 3), and of roll and pitch, (2, 2, 2)."""

STEP_MAX_S = 0.1  # 0.04 rad at 10 m/s with 4 m/s^2 to the side


@compiled_kernel
def switching(begins_after_s: Array, dt_s: float) -> tuple[float, Array]:
    """Return the probability that no mode has begun in `dt_s`, and those `(n,)` that each is the one that began last.

    From row to column the modes change with `unchanged * np.eye(n) + begun`.

    Args:
        begins_after_s: (n,) mean time after which each mode begins in any other.
        dt_s: time that passes.
    """
    rates = 1.0 / begins_after_s
    total = rates.sum()
    unchanged = math.exp(-dt_s * total)
    return unchanged, (1.0 - unchanged) / total * rates


@compiled_kernel
def combine(means: Array, covariances: Array, weights: Array) -> tuple[Array, Array]:
    """Return mean and covariance of the mixture; the weights add up to one."""
    mean, covariance = np.zeros_like(means[0]), np.zeros_like(covariances[0])
    n = len(mean)
    for j in range(len(weights)):
        mean += weights[j] * means[j]
    for j in range(len(weights)):
        off = means[j] - mean
        for i in range(n):
            for k in range(n):
                covariance[i, k] += weights[j] * (covariances[j, i, k] + off[i] * off[k])
    return mean, covariance


@compiled_kernel
def mix(modes: Modes, unchanged: float, begun: Array) -> Modes:
    """Return the filter after the modes may have changed.

    Whatever the vehicle did before, a mode that has begun is as likely, so each becomes a mixture of two: of itself,
    and of all of them together.

    Args:
        modes: the filter before; its weights add up to one.
        unchanged: probability that no mode has begun, as `switching` has it.
        begun: (n,) probabilities that each mode is the one that began last, as `switching` has them.
    """
    means, covariances, weights = modes
    n = len(weights)
    after = unchanged * weights + begun
    mean, covariance = combine(means, covariances, weights)
    mixed_means, mixed_covariances = np.empty_like(means), np.empty_like(covariances)
    for j in range(n):
        own = unchanged * weights[j] / after[j]
        off = means[j] - mean
        mixed_means[j] = mean + own * off
        for i in range(SIZE):
            for k in range(SIZE):
                mixed_covariances[j, i, k] = own * covariances[j, i, k] + (1.0 - own) * (
                    covariance[i, k] + own * (off[i] * off[k])
                )
    return mixed_means, mixed_covariances, after


@compiled_kernel
def shifted(x: Array, P: Array, lever: Array, sign: float) -> tuple[Array, Array]:
    """Return mean and covariance with the position moved by `sign` times `lever` of V.

    The heading turns it, and the grade raises what is in front. Its upright part is left out, for it is the same at all
    times; that it leans with the grade, too, is a tenth of it at most.
    """
    arm_x, arm_y = turned(lever[0], lever[1], x[7])
    y, S = x.copy(), P.copy()
    y[0] += sign * arm_x
    y[1] += sign * arm_y
    y[8] += sign * lever[0] * x[9]
    for i in range(SIZE):
        S[0, i] -= sign * arm_y * S[7, i]
        S[1, i] += sign * arm_x * S[7, i]
        S[8, i] += sign * lever[0] * S[9, i]
    for i in range(SIZE):
        S[i, 0] -= sign * arm_y * S[i, 7]
        S[i, 1] += sign * arm_x * S[i, 7]
        S[i, 8] += sign * lever[0] * S[i, 9]
    return y, S


@compiled_kernel
def steps_of(dt_s: float, motion: Array) -> Steps:
    """Return in how many equal steps `dt_s` passes, and how the deck swings in one of them.

    Args:
        dt_s: time to pass.
        motion: (18,), see the module.
    """
    count = max(math.ceil(dt_s / STEP_MAX_S - 1e-9), 1)
    step_s = dt_s / count
    heave, heave_noise = smooth_step(step_s, motion[1], motion[2], motion[3])
    tilt, tilt_noise = np.empty((2, 2, 2)), np.empty((2, 2, 2))
    for i in range(2):
        tilt[i], tilt_noise[i] = heave_step(step_s, motion[10 + 3 * i], motion[11 + 3 * i], motion[12 + 3 * i])
    return count, step_s, heave, heave_noise, tilt, tilt_noise


@compiled_kernel
def glide(x: Array, P: Array, steps: Steps, noise: Array, motion: Array) -> tuple[Array, Array]:
    """Return mean and covariance of one mode after `steps`.

    It is the pad's centre that moves as `advance` says, and the antenna swings about it.

    Args:
        x: mean (26,).
        P: covariance (26, 26).
        steps: as `steps_of` has them; the same for all modes.
        noise: (18,) as `process_noise` takes it.
        motion: (18,), see the module; a lever arm of zero where it has no known direction.
    """
    count, step_s, heave, heave_noise, tilt, tilt_noise = steps
    clock_left, leak_left = math.exp(-step_s / motion[4]), math.exp(-step_s / motion[9])
    own_rate_left, unit_left = math.exp(-step_s / motion[16]), math.exp(-step_s / motion[17])
    x, P = shifted(x, P, motion[5:8], 1.0)
    for _ in range(count):
        Q = process_noise(x, step_s, noise, heave_noise, tilt_noise)
        turn_left = curvature_left(math.hypot(x[2], x[3]), step_s, noise)
        bend_left, _ = bend_step(x, step_s, noise)
        x, F = advance(x, step_s, motion[0], heave, tilt)
        x[6] *= turn_left
        F[6, 6] = turn_left
        x[BEND] *= bend_left
        F[BEND, BEND] = bend_left
        x[CLOCK] *= clock_left
        F[CLOCK, CLOCK] = clock_left
        x[LEAK] *= leak_left
        F[LEAK, LEAK] = leak_left
        x[OWN_RATE] *= own_rate_left
        F[OWN_RATE, OWN_RATE] = own_rate_left
        x[UNIT_HEADING] *= unit_left
        F[UNIT_HEADING, UNIT_HEADING] = unit_left
        P = carried_through(F, P) + Q
    x, P = shifted(x, P, motion[5:8], -1.0)
    return x, 0.5 * (P + P.T)


@compiled_kernel
def heading_variance(modes: Modes) -> float:
    """Return the mean of the modes' variances of the heading, rad^2."""
    _, covariances, weights = modes
    return float((weights * covariances[:, 7, 7]).sum())


@compiled_kernel
def is_heading_known(modes: Modes, known_variance: float) -> bool:
    """Return whether the heading of the mixture is known better than `known_variance`, rad^2."""
    return heading_variance(modes) < known_variance


@compiled_kernel
def with_direction(motion: Array, modes: Modes, known_variance: float) -> Array:
    """Return `motion` without its lever arm where the heading is not known better than `known_variance`, rad^2."""
    directed = motion.copy()
    if not is_heading_known(modes, known_variance):
        directed[5:9] = 0.0
    return directed


@compiled_kernel
def predict_modes(
    modes: Modes, dt_s: float, noises: Array, begins_after_s: Array, motion: Array, known_variance: float
) -> Modes:
    """Return the filter `dt_s` later; `noises` (n, 18), the others as `switching` and `with_direction` have them."""
    directed = with_direction(motion, modes, known_variance)
    means, covariances, weights = mix(modes, *switching(begins_after_s, dt_s))
    steps = steps_of(dt_s, directed)
    for j in range(len(weights)):
        means[j], covariances[j] = glide(means[j], covariances[j], steps, noises[j], directed)
    return means, covariances, weights
