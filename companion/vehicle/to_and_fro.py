"""How much, and how often, an antenna goes to and fro as its vehicle's body sways, by its receiver's velocities; pure.

A sway much larger than it is taken to be is explained by the filter's models of driving: as a brake, and a moment later
as its opposite. What the filter makes of it then does not tell how large it is (`body_sway`). But no driver does that
within the period of a body. Of velocities that are half of that period apart the third difference is eight times the
sway's; of an even acceleration or an even turn it is nothing, and of one that begins or ends it is something for one
and a half periods. So the lower quartile of two periods and more is the sway's, unless something begins or ends all the
time. How often the body sways is not known, so several periods are tried: with one that is too long or too short by a
third the third difference is a quarter as large or less. Of a sine the quartile tells the mean, of noise it is less:
the sway is at least as large. So it is with the heave, for which the road's grade is what driving is for the tilt.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from link.records import replace

_APART_MIN_S = 0.045  # of velocities that are kept: a fifteenth of the shortest period
_APART_MAX_S = 0.45  # between which a velocity is not known
_SEEN_S = 8.0
_SEEN_FROM = 4.0  # half periods
_SHARE = 0.25
_MEAN_PER_QUARTILE = 0.5 / math.sin(math.pi / 8.0) ** 2  # of a sine's square
_THIRD = np.array([1.0, -3.0, 3.0, -1.0])
_GAIN_2 = 64.0  # of its square for a sine, at half a period
_NOISE_GAIN_2 = 20.0  # of its variance: 1 + 9 + 9 + 1


class Shown(NamedTuple):
    """How large the variance of the sway's velocity is at least, and by which of the periods."""

    variance_m2_s2: float = 0.0
    period: int = 0


class ToAndFro(Struct, frozen=True, kw_only=True, eq=False):
    """What was told.

    Attributes:
        now_s: of its own clock.
        told: (n, 4) the velocities of the last moments, newest first: time, east, north and up.
        squares: (m, 1 + 3 k) of the sway's velocity in the last seconds, m^2/s^2, newest first: the time, along the
            course by each of k periods, across it and up; NaN of a period for which too little was told.
        along: what is shown along the course.
        across: what is shown across the course.
        up: what is shown upwards.
    """

    now_s: float = 0.0
    told: Array = np.empty((0, 4))
    squares: Array | None = None
    along: Shown = Shown()
    across: Shown = Shown()
    up: Shown = Shown()


def passed(seen: ToAndFro, dt_s: float) -> ToAndFro:
    """Return what was seen `dt_s` later."""
    if dt_s == 0.0:
        return seen
    return replace(seen, now_s=seen.now_s + dt_s)


def watch(seen: ToAndFro, velocity: Array, covariance: Array, half_periods_s: Sequence[float]) -> ToAndFro:
    """Return what was seen with what is told now.

    Args:
        seen: so far.
        velocity: (3,) of the antenna in W, m/s.
        covariance: (3, 3) of its error.
        half_periods_s: k that the body may have, rising.
    """
    now_s = seen.now_s
    if len(seen.told) and now_s - seen.told[0, 0] < _APART_MIN_S:
        return seen
    halves_s, kept_s = np.array(half_periods_s), 3.0 * half_periods_s[-1] + _APART_MAX_S
    told = np.vstack((np.append(now_s, velocity), seen.told[seen.told[:, 0] > now_s - kept_s]))
    level_m2_s2 = 0.5 * float(covariance[0, 0] + covariance[1, 1])
    noise_m2_s2 = np.repeat((level_m2_s2, level_m2_s2, covariance[2, 2]), len(halves_s))
    squares = np.append(now_s, _squares(told, halves_s, noise_m2_s2))[np.newaxis]
    if seen.squares is not None:
        squares = np.vstack((squares, seen.squares[seen.squares[:, 0] > now_s - _SEEN_S]))
    along, across, up = (_first_peak(one) for one in np.split(_least(squares, halves_s), 3))
    return ToAndFro(now_s=now_s, told=told, squares=squares, along=along, across=across, up=up)


def _squares(told: Array, half_periods_s: Array, noise_m2_s2: Array) -> Array:
    """Return (3 k,) the squares of the sway's velocity along the course, across it and up."""
    if len(told) < 2:
        return np.full(len(noise_m2_s2), np.nan)
    wanted_s, times_s = told[0, 0] - half_periods_s[:, np.newaxis] * np.arange(4.0), told[::-1, 0]
    after = times_s.searchsorted(wanted_s - 1e-9).clip(1, len(times_s) - 1)
    apart_s = times_s[after] - times_s[after - 1]
    known = (apart_s <= _APART_MAX_S).all(axis=1) & (wanted_s[:, -1] > times_s[0] - 1e-9)
    east, north, up = (np.interp(wanted_s, times_s, told[::-1, column]) for column in (1, 2, 3))
    speed, course_east, course_north = np.hypot(east, north), east.sum(axis=1), north.sum(axis=1)
    turned = np.arctan2(
        course_east[:, np.newaxis] * north - course_north[:, np.newaxis] * east,
        course_east[:, np.newaxis] * east + course_north[:, np.newaxis] * north,
    )
    velocities = np.concatenate((speed @ _THIRD, speed.mean(axis=1) * (turned @ _THIRD), up @ _THIRD))
    return np.where(np.tile(known, 3), (velocities**2 - _NOISE_GAIN_2 * noise_m2_s2) / _GAIN_2, np.nan)


def _least(squares: Array, half_periods_s: Array) -> Array:
    """Return (3 k,) how large the variance of the sway's velocity is at least, by each period."""
    times_s, values = squares[:, 0], squares[:, 1:]
    is_told = ~np.isnan(values)
    since_s = np.where(is_told, times_s[:, np.newaxis], times_s[0]).min(axis=0)
    ranked = np.sort(values, axis=0)  # what is not told comes last
    rank = (_SHARE * np.maximum(is_told.sum(axis=0) - 1, 0)).astype(np.intp)
    least = _MEAN_PER_QUARTILE * ranked[rank, np.arange(values.shape[1])]
    from_s = _SEEN_FROM * np.tile(half_periods_s, 3)
    return np.where((times_s[0] - since_s >= from_s) & (least > 0.0), least, 0.0)


def _first_peak(variances: Array) -> Shown:
    """Return the variance by the period that shows most, and which; three times as long a one shows as much."""
    peak, last = 0, len(variances) - 1
    while peak < last and variances[peak + 1] >= variances[peak]:
        peak += 1
    return Shown(float(variances[peak]), peak)
