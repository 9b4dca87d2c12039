"""How much an antenna goes to and fro as its vehicle's body sways, by the velocities that its receiver tells; pure.

A sway much larger than it is taken to be is explained by the filter's models of driving: as a brake, and a moment later
as its opposite. What the filter makes of it then does not tell how large it is (`body_sway`). But no driver does that
within the period of a body. Of velocities that are half of that period apart the third difference is eight times the
sway's; of an even acceleration or an even turn it is nothing, and of one that begins or ends it is something for a
second. So the median over some seconds is the sway's, unless something begins or ends all the time. Of a sine the
median of the squares is their mean, of noise it is less: the sway is at least as large.
"""

import math
from statistics import median

import numpy as np
from msgspec import Struct

from companion.core.data import Array

_APART_MIN_S = 0.045  # of velocities that are kept: a fifteenth of a period
_APART_MAX_S = 0.45  # between which a velocity is not known
_KEPT_S = 1.5  # more than the three halves of a period and one gap
_MEDIAN_OVER_S = 5.0
_MEDIAN_FROM_S = 1.0
_GAIN = 8.0  # of the third difference, at half a period
_NOISE_GAIN = 20.0  # of its variance: 1 + 9 + 9 + 1

Entries = tuple[tuple[float, float, float], ...]
"""Times, s, and two numbers of each, newest first."""


class ToAndFro(Struct, frozen=True, kw_only=True):
    """What was told.

    Attributes:
        now_s: of its own clock.
        velocities_m_s: of the last moments, east and north.
        squares_m2_s2: of the sway's velocity along the course and across it, of the last seconds.
    """

    now_s: float = 0.0
    velocities_m_s: Entries = ()
    squares_m2_s2: Entries = ()


def passed(seen: ToAndFro, dt_s: float) -> ToAndFro:
    """Return what was seen `dt_s` later."""
    if dt_s == 0.0:
        return seen
    return ToAndFro(now_s=seen.now_s + dt_s, velocities_m_s=seen.velocities_m_s, squares_m2_s2=seen.squares_m2_s2)


def watch(seen: ToAndFro, velocity: Array, covariance: Array, half_period_s: float) -> ToAndFro:
    """Return what was seen with what is told now.

    Args:
        seen: so far.
        velocity: (3,) of the antenna in W, m/s.
        covariance: (3, 3) of its error.
        half_period_s: of the body.
    """
    now_s, before = seen.now_s, seen.velocities_m_s
    if before and now_s - before[0][0] < _APART_MIN_S:
        return seen
    velocities = ((now_s, float(velocity[0]), float(velocity[1])), *_since(before, now_s - _KEPT_S))
    squares = _since(seen.squares_m2_s2, now_s - _MEDIAN_OVER_S)
    told = [_told_at(velocities, now_s - i * half_period_s) for i in range(4)]
    known = [one for one in told if one is not None]
    if len(known) == len(told):
        noise_m2_s2 = _NOISE_GAIN * 0.5 * float(covariance[0, 0] + covariance[1, 1])
        squares = ((now_s, *_squares(np.array(known), noise_m2_s2)), *squares)
    return ToAndFro(now_s=now_s, velocities_m_s=velocities, squares_m2_s2=squares)


def least_variances_m2_s2(seen: ToAndFro) -> tuple[float, float]:
    """Return how large the variance of the sway's velocity is at least, along the course and across it."""
    squares = seen.squares_m2_s2
    if not squares or squares[0][0] - squares[-1][0] < _MEDIAN_FROM_S:
        return 0.0, 0.0
    return max(median(one[1] for one in squares), 0.0), max(median(one[2] for one in squares), 0.0)


def _since(entries: Entries, from_s: float) -> Entries:
    kept = len(entries)
    while kept and entries[kept - 1][0] < from_s:
        kept -= 1
    return entries[:kept]


def _told_at(velocities: Entries, t_s: float) -> tuple[float, float] | None:
    """Return the velocity at a time, evenly between the two about it; None where nothing was told."""
    for i, (before_s, east, north) in enumerate(velocities):
        if before_s > t_s + 1e-9:
            continue
        after_s, after_east, after_north = velocities[max(i - 1, 0)]
        apart_s = after_s - before_s
        if apart_s > _APART_MAX_S:
            return None
        share = (t_s - before_s) / apart_s if apart_s > 0.0 else 0.0
        return east + share * (after_east - east), north + share * (after_north - north)
    return None


def _squares(told: Array, noise_m2_s2: float) -> tuple[float, float]:
    """Return the squares of the sway's velocity along and across the course, of four velocities (4, 2)."""
    third = np.array([1.0, -3.0, 3.0, -1.0])
    along = float(third @ np.hypot(told[:, 0], told[:, 1]))
    east, north = told.sum(axis=0).tolist()
    change_east, change_north = (third @ told).tolist()
    across = (east * change_north - north * change_east) / max(math.hypot(east, north), 1e-9)
    return (along**2 - noise_m2_s2) / _GAIN**2, (across**2 - noise_m2_s2) / _GAIN**2
