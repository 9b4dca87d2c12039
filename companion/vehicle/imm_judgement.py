"""Compiled steps that change the modes by a reading, and judge by it which of them the vehicle is in.

`Modes` are as `imm_mixing` has them: the steady model first, those of manoeuvres after it.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.angle import short_way_round
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_kernels import HEADING as HEADING_STATE
from companion.vehicle.imm_kernels import UNKNOWN_HEADING_VARIANCE
from companion.vehicle.imm_mixing import Modes, combine, is_heading_known, switching
from companion.vehicle.imm_noise import process_noise
from companion.vehicle.imm_sensors import COURSE, HEADING, PAD, POSITION, VELOCITY, observe
from companion.vehicle.small_matrices import carried_through, correct, inverse_of

WEIGHT_MIN = 1e-12  # a mode that rounding has ruled out could never come back
FIT_MAX = 700.0  # of a logarithm whose exponential is a number
SIDEWAYS_RAD = 1.0  # so far from its heading, or from the opposite, no vehicle goes that is known well


@compiled_kernel
def residual_of(kind: int, value: Array, expected: Array) -> Array:
    """Return measured minus expected, the short way round for angles."""
    residual = value - expected
    if kind in (HEADING, COURSE):
        residual[0] = short_way_round(residual[0])
    return residual


@compiled_kernel
def expect_manoeuvres(modes: Modes, unmeasured_s: float, begins_after_s: Array, noises: Array) -> Modes:
    """Return the filter with the manoeuvres that may have begun since the vehicle's motion was measured last.

    Yaw rates come fifty times a second. Those of a straight road all but rule the manoeuvre models out, and leave them
    mixed with the steady one of the instant before; yet of a brake, in the tenths of a second from one velocity to the
    next, they say nothing. So each fix or velocity is asked anew with the probability that the vehicle alone has.

    Args:
        modes: the filter at the time of the reading.
        unmeasured_s: time since the last fix or velocity.
        begins_after_s: (n,) as `switching` takes it.
        noises: (n, 18) of the modes.
    """
    means, covariances, weights = modes[0].copy(), modes[1].copy(), modes[2].copy()
    _, begun = switching(begins_after_s, unmeasured_s)
    begun[0] = 0.0
    raised = weights < begun
    mean, covariance = combine(modes[0], modes[1], modes[2])
    for j in range(1, len(weights)):
        if not raised[j]:
            continue
        ends_after_s = 1.0 / ((1.0 / begins_after_s).sum() - 1.0 / begins_after_s[j])
        lasted_s = min(unmeasured_s, ends_after_s)
        grown = process_noise(mean, lasted_s, noises[j], np.zeros((2, 2)), np.zeros((2, 2, 2)))
        share = weights[j] / begun[j]
        candidates = np.stack((mean, means[j])), np.stack((covariance + grown, covariances[j]))
        means[j], covariances[j] = combine(candidates[0], candidates[1], np.array([1.0 - share, share]))
    left = np.where(raised, 0.0, weights)
    weights = np.where(raised, begun, left * (1.0 - begun[raised].sum()) / left.sum())
    return means, covariances, weights


@compiled_kernel
def update_modes(
    modes: Modes, reading: tuple[int, Array, Array], lever: Array, sees_heading: bool
) -> tuple[Modes, float, float]:
    """Return the filter after a measurement, the mixture's NIS, and the smallest of the modes' NIS.

    The mixture's NIS tells consistency; an outlier is what even the mode with the widest noise does not expect.
    Anything but a velocity counts as one component in favour of a mode: receivers state the errors of their axes as
    independent, but where they are one and the same (a common delay, a reflection) it would count m times over.
    Velocities are of Doppler, which has no such errors.

    Args:
        modes: the filter.
        reading: kind as `observe` takes it, value (m,), covariance (m, m).
        lever: (4,) from the antenna to the pad in V, and the pad's height above the axis of roll, m.
        sees_heading: whether the heading is known, so that the lever arm has a direction.
    """
    means, covariances, weights = modes
    kind, value, R = reading
    m = len(value)
    xs, Ps = np.empty_like(means), np.empty_like(covariances)
    n = len(weights)
    fits, nis = np.empty(n), np.empty(n)
    residuals, spreads = np.empty((n, m)), np.empty((n, m, m))
    for j in range(n):
        expected, H = observe(kind, means[j], lever, sees_heading)
        residuals[j] = residual_of(kind, value, expected)
        spreads[j] = carried_through(H, covariances[j]) + R
        xs[j], Ps[j], nis[j], fits[j] = correct(means[j], covariances[j], residuals[j], H, R)
    components = 1 if kind == VELOCITY else m
    fits = (fits - fits.max()) / components
    after = np.maximum(weights, WEIGHT_MIN) * np.exp(np.maximum(fits, -FIT_MAX))
    after /= after.sum()
    residual, spread = combine(residuals, spreads, weights)
    inverse, _ = inverse_of(spread)
    mixture_nis = (residual * inverse * residual.reshape(m, 1)).sum()
    return (xs, Ps, after), float(mixture_nis), float(nis.min())


@compiled_kernel
def align_modes(means: Array, covariances: Array, course: Array) -> tuple[Array, Array]:
    """Return the modes after the rule that a driving vehicle heads where it goes.

    One that is known to head against its course drives backwards. Nothing is learnt while it is slow, or while the
    course itself is vague. Where sensors tell that it turns, one that goes sideways is believed to skid or to drift;
    else its heading was learnt from its course alone, and was wrong: no vehicle that drives on begins to go backwards.

    Args:
        means: (n, 26) of the modes.
        covariances: (n, 26, 26) of the modes.
        course: (4,) speed from which on a course is one, m/s, variances of the heading about it and of a heading that
            is known, rad^2, and 1 where sensors tell the heading or how it turns.
    """
    speed_min_m_s, course_variance, known_variance, told = course
    xs, Ps = means.copy(), covariances.copy()
    lever, zero = np.zeros(4), np.zeros(1)
    for j in range(len(means)):
        x, P = means[j], covariances[j]
        speed = math.hypot(x[2], x[3])
        if speed < speed_min_m_s or P[2, 2] + P[3, 3] > (0.3 * speed) ** 2:
            continue
        known = P[HEADING_STATE, HEADING_STATE] < known_variance
        expected, H = observe(COURSE, x, lever, False)
        residual = residual_of(COURSE, zero, expected)
        if known and abs(residual[0]) > math.pi - SIDEWAYS_RAD:
            residual[0] -= math.copysign(math.pi, residual[0])
        if known and abs(residual[0]) > SIDEWAYS_RAD:
            if told == 0.0:
                Ps[j, HEADING_STATE, :] = Ps[j, :, HEADING_STATE] = 0.0
                Ps[j, HEADING_STATE, HEADING_STATE] = UNKNOWN_HEADING_VARIANCE
            continue
        R = np.array([[course_variance if known else min(course_variance, 0.01)]])
        xs[j], Ps[j], _, _ = correct(x, P, residual, H, R)
    return xs, Ps


@compiled_kernel
def take_reading(
    modes: Modes, reading: tuple[int, Array, Array], lever: Array, course: Array
) -> tuple[Modes, float, float]:
    """Return what `update_modes` does, with the heading judged and, after a fix or a velocity, aligned.

    Args:
        modes: the filter.
        reading: kind as `observe` takes it, value (m,), covariance (m, m).
        lever: (4,) from the antenna to the pad in V, and the pad's height above the axis of roll, m.
        course: (4,) as `align_modes` takes it.
    """
    kind, value, R = reading
    known = is_heading_known(modes, course[2])
    if kind == PAD and not known:
        arm2 = math.hypot(lever[0], lever[1]) ** 2
        R = R.copy()
        R[0, 0] += arm2
        R[1, 1] += arm2
    (means, covariances, weights), nis, gate_nis = update_modes(modes, (kind, value, R), lever, known)
    if kind in (POSITION, VELOCITY):
        means, covariances = align_modes(means, covariances, course)
    return (means, covariances, weights), nis, gate_nis
