"""Learns how a deck swings: frequency, damping and size of its heave, roll and pitch; pure.

Each is taken for a damped oscillator driven by noise, whose value and rate `z` the filter follows; of the heave these
are its rate and its acceleration, for what its place swings about is not known. Over pairs that lie
a lag apart the sums S0 of `z z'` and S1 of `z(later) z'` fade with `MEMORY_S`. The transition that fits best in the
least squares is A = S1 / S0, the first-order vector autoregression; its eigenvalues are
exp((-d +- i sqrt(1 - d^2)) w t). The sums begin as those of an ordinary deck that has been watched for
`PRIOR_PERIODS`. The value is taken against its mean, for a list, or a height that is not known apart, is no swinging.
Source: Lütkepohl, New Introduction to Multiple Time Series Analysis (2005), 3.2.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from companion.config.estimation import OscillatorConfig, SwingConfig
from companion.core.data import Array
from companion.vehicle.imm_swing import heave_step
from link.records import replace

MEMORY_S = 60.0  # some six waves; a road of one kind lasts longer
PRIOR_PERIODS = 2.0
_FREQUENCY_RANGE_RAD_S = (2.0 * math.pi * 0.03, 2.0 * math.pi * 5.0)  # from swell of 33 s to a stiff suspension
# A narrower band would tell the middle of a swing from a part of it: seas have bands of some 0.4 of their frequency
# (Longuet-Higgins 1975), bodies on wheels a damping of 0.2 and more.
_DAMPING_RANGE = (0.1, 0.95)
_SINGULAR = 1e-12  # of two variances: what is left by rounding where value and rate go together, or are all zero
_STD_MIN = (0.01, 0.001, 0.001)  # m/s, rad, rad: no receiver and no inertial unit tells less


class Axis(Struct, frozen=True, kw_only=True):
    """What has been seen of one of them: the mean, and S0 as (xx, xv, vv), S1 as (xx, xv, vx, vv), later one first."""

    last: tuple[float, float]
    weight: float
    lag_s: float
    mean: float
    at_once: tuple[float, float, float]
    later: tuple[float, float, float, float]


class DeckMotion(Struct, frozen=True, kw_only=True, eq=False):
    """What is known of a deck's swinging.

    Attributes:
        axes: of the heave's rate, roll and pitch.
        passed_s: since the newest pair.
        oscillators: (9,) angular frequency, rad/s, damping and standard deviation, m/s or rad, of each.
    """

    axes: tuple[Axis, ...]
    passed_s: float
    oscillators: Array


def rate_std_m_s(heave: OscillatorConfig) -> float:
    """Return the standard deviation of the rate of a heave that swings as configured."""
    return 2.0 * math.pi * heave.frequency_hz * heave.std


def first_motion(swing: SwingConfig) -> DeckMotion:
    """Return what is taken for granted of a deck that has not been watched."""
    heave_rate = swing.heave.model_copy(update={"std": rate_std_m_s(swing.heave)})
    heave, tilt = _first_axis(heave_rate, swing.lag_s), _first_axis(swing.tilt, swing.lag_s)
    configured = [(2.0 * math.pi * one.frequency_hz, one.damping, one.std) for one in (heave_rate, swing.tilt)]
    oscillators = _oscillators((heave, tilt, tilt), np.array([*configured, configured[1]]).ravel())
    return DeckMotion(axes=(heave, tilt, tilt), passed_s=0.0, oscillators=oscillators)


def _first_axis(oscillator: OscillatorConfig, lag_s: float) -> Axis:
    frequency_rad_s, std = 2.0 * math.pi * oscillator.frequency_hz, oscillator.std
    A, _ = heave_step(lag_s, frequency_rad_s, oscillator.damping, std)
    weight = PRIOR_PERIODS / (oscillator.frequency_hz * lag_s)
    place, rate = weight * std**2, weight * (std * frequency_rad_s) ** 2
    return Axis(
        last=(0.0, 0.0),
        weight=weight,
        lag_s=lag_s,
        mean=0.0,
        at_once=(place, 0.0, rate),
        later=(float(A[0, 0]) * place, float(A[0, 1]) * rate, float(A[1, 0]) * place, float(A[1, 1]) * rate),
    )


def passed(motion: DeckMotion, dt_s: float) -> DeckMotion:
    """Return the motion `dt_s` later."""
    return replace(motion, passed_s=motion.passed_s + dt_s)


def learn(motion: DeckMotion, mean: Sequence[float], lag_s: float) -> DeckMotion:
    """Return the motion with another pair, once a lag has passed.

    Args:
        motion: so far.
        mean: value and rate of the heave's rate, of roll and of pitch, as the filter has them.
        lag_s: least time between the two of a pair.
    """
    if motion.passed_s < lag_s:
        return motion
    # After a silence there is no pair, only a new beginning.
    is_pair = motion.passed_s < 2.0 * lag_s
    states = [(mean[0], mean[1]), (mean[2], mean[3]), (mean[4], mean[5])]
    axes = tuple(
        _with_pair(axis, state, motion.passed_s) if is_pair else replace(axis, last=state)
        for axis, state in zip(motion.axes, states, strict=True)
    )
    oscillators = _oscillators(axes, motion.oscillators) if is_pair else motion.oscillators
    return DeckMotion(axes=axes, passed_s=0.0, oscillators=oscillators)


def _with_pair(axis: Axis, state: tuple[float, float], lag_s: float) -> Axis:
    keep = math.exp(-lag_s / MEMORY_S)
    (before, v), (after, later_v) = axis.last, state
    xx, xv, vv = axis.at_once
    a, b, c, d = axis.later
    weight = keep * axis.weight + 1.0
    mean = axis.mean + (after - axis.mean) / weight
    x, later_x = before - mean, after - mean
    return Axis(
        last=state,
        weight=weight,
        lag_s=axis.lag_s + (lag_s - axis.lag_s) / weight,
        mean=mean,
        at_once=(keep * xx + x * x, keep * xv + x * v, keep * vv + v * v),
        later=(keep * a + later_x * x, keep * b + later_x * v, keep * c + later_v * x, keep * d + later_v * v),
    )


def _oscillators(axes: Sequence[Axis], before: Array) -> Array:
    """Return the oscillators (9,) that swing as was seen, as they were `before` where nothing was."""
    kept = before.reshape(3, 3)
    found = [_oscillator(axis, least) for axis, least in zip(axes, _STD_MIN, strict=True)]
    return np.array([kept[i] if one is None else one for i, one in enumerate(found)]).ravel()


def _oscillator(axis: Axis, std_min: float) -> tuple[float, float, float] | None:
    """Return angular frequency, damping and standard deviation of the oscillator that swings as was seen.

    None of a deck that lies so still, for hours, that nothing is left to compare.
    """
    xx, xv, vv = axis.at_once
    a, b, c, d = axis.later
    determinant = xx * vv - xv * xv
    if determinant <= _SINGULAR * xx * vv:
        return None
    p, q = (a * vv - b * xv) / determinant, (b * xx - a * xv) / determinant
    r, s = (c * vv - d * xv) / determinant, (d * xx - c * xv) / determinant
    left2 = min(max(p * s - q * r, 1e-6), 1.0)
    fade = -0.5 * math.log(left2) / axis.lag_s
    cosine = 0.5 * (p + s) / math.sqrt(left2)
    turning = math.acos(min(max(cosine, -1.0), 1.0)) / axis.lag_s
    least, most = _FREQUENCY_RANGE_RAD_S
    frequency = min(max(math.hypot(fade, turning), least), most)
    lowest, highest = _DAMPING_RANGE
    return frequency, min(max(fade / frequency, lowest), highest), max(math.sqrt(xx / axis.weight), std_min)
