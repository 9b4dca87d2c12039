"""The fastest way from a relative position and velocity to rest; from it follows the approach to a moving target.

One axis has the state `[e, w]`, relative position m and velocity m/s; its acceleration is +a, then 0 at the speed
limit, then -a. Source: the time-optimal control of the double integrator, Bryson and Ho 1975, section 3.9, with a
bound on w. All functions are compiled.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel

Rates = tuple[float, float, float, float, float]

TINY = 1e-12

RATE_RESERVE = 0.05
"""Share of a speed limit that an approach may use even when the target leaves less."""

SPLITS = 8
SPLIT_MIN_RAD = 0.2
SPLIT_MAX_RAD = 1.3
"""Angles at which the split of the acceleration norm is tried: the minor axis gets its sine, the major its cosine."""

SPLIT_SOFTNESS_S = 0.2
"""Splits whose summed times of both axes differ by less than this are mixed, so that the split does not jump."""


@compiled_kernel
def fastest_way(
    error: float, rate: float, push: float, slowest: float, fastest: float
) -> tuple[float, float, float, float]:
    """Return the velocity of the cruise and the durations of first phase, cruise and braking to rest at zero.

    Args:
        error: relative position.
        rate: relative velocity, allowed to start outside its bounds.
        push: magnitude of the acceleration, > 0.
        slowest: lower bound of the relative velocity, < 0.
        fastest: upper bound, > 0.
    """
    way = -1.0 if error + rate * abs(rate) / (2.0 * push) > 0.0 else 1.0
    ahead, speed = -way * error, way * rate
    bound = fastest if way > 0.0 else -slowest
    peak = math.sqrt(max(push * ahead + 0.5 * speed * speed, 0.0))
    cruise = min(peak, bound)
    first_s, last_s = abs(cruise - speed) / push, cruise / push
    cruise_s = 0.0
    if peak > bound:
        covered = 0.5 * (speed + cruise) * first_s + 0.5 * cruise * last_s
        cruise_s = max(ahead - covered, 0.0) / cruise
    return way * cruise, first_s, cruise_s, last_s


@compiled_kernel
def way_at(
    error: float, rate: float, way: tuple[float, float, float, float], t_s: float
) -> tuple[float, float, float, float]:
    """Return the integral of the position since the start, position, velocity and acceleration at `t_s` >= 0."""
    cruise, first_s, cruise_s, last_s = way
    sums = 0.0
    for span, change in ((first_s, cruise - rate), (cruise_s, 0.0), (last_s, -cruise)):
        dt = min(t_s, span)
        push = change / max(span, TINY)
        sums += (error + (rate / 2.0 + push * dt / 6.0) * dt) * dt
        error += (rate + 0.5 * push * dt) * dt
        rate += push * dt
        t_s -= dt
        if t_s <= 0.0 and dt < span:
            return sums, error, rate, push
    return sums, error, rate, 0.0


@compiled_kernel
def left_of(norm: float, used: float) -> float:
    """Return what one axis may use of a norm limit beside `used` on the other; never less than a fifth."""
    return math.sqrt(max(norm * norm - used * used, 0.04 * norm * norm))


@compiled_kernel
def rate_bounds(target_v: Array, limits: Rates) -> tuple[Array, Array]:
    """Return the bounds (3,) of the velocity relative to a target's for `limits`, see `approach`."""
    slowest, fastest = np.empty(3), np.empty(3)
    for axis in range(3):
        up = limits[1] if axis == 2 else left_of(limits[0], target_v[1 - axis])
        down = limits[2] if axis == 2 else up
        fastest[axis] = max(up - target_v[axis], RATE_RESERVE * up)
        slowest[axis] = -max(down + target_v[axis], RATE_RESERVE * down)
    return slowest, fastest


@compiled_kernel
def split_norm(error: Array, rate: Array, target_v: Array, limits: Rates, fraction: float) -> float:
    """Return the angle that splits the acceleration norm with the least sum of the times of both axes."""
    slowest, fastest = rate_bounds(target_v, limits)
    angles = np.linspace(SPLIT_MIN_RAD, SPLIT_MAX_RAD, SPLITS)
    times = np.zeros(SPLITS)
    for i in range(SPLITS):
        for axis in range(2):
            share = limits[3] * (math.cos(angles[i]) if axis == 0 else math.sin(angles[i]))
            way = fastest_way(error[axis], rate[axis], fraction * share, slowest[axis], fastest[axis])
            times[i] += way[1] + way[2] + way[3]
    least, mixed, total = times.min(), 0.0, 0.0
    for i in range(SPLITS):
        weight = math.exp((least - times[i]) / SPLIT_SOFTNESS_S)
        mixed += weight * angles[i]
        total += weight
    return mixed / total


@compiled_kernel
def approach_push(error: float, rate: float, push: float, push_max: float, time_min_s: float) -> float:
    """Return the acceleration of the approach on one axis.

    Near the target it shrinks with the error, such that no way is much shorter than `time_min_s`: the law becomes
    linear and does not chatter. When closing in it is at least what brakes to rest at the target, up to `push_max`.
    """
    gentle = 4.0 * abs(error) / time_min_s**2 + (1.0 + math.sqrt(2.0)) * abs(rate) / time_min_s
    chosen = min(push, max(gentle, 1e-9))
    if error * rate < 0.0:
        chosen = max(chosen, min(rate * rate / max(2.0 * abs(error), 1e-9), push_max))
    return chosen


@compiled_kernel
def approach(
    x: Array, node_s: Array, target: Array, floor: Array, limits: Rates, fraction: float, time_min_s: float
) -> Array:
    """Return the reference (3, 3, n - 1) of an approach from the state `x` at the nodes after now, ordered as `target`.

    Args:
        x: (2, 3) position and velocity per axis: major, minor, up.
        node_s: (n,) rising from 0.
        target: (3, 3, n) position, velocity, acceleration; axis; node.
        floor: (n,) the lowest height; the reference does not go below.
        limits: of speed, climb, descent, horizontal and vertical acceleration.
        fraction: of the acceleration limit that the approach is planned with.
        time_min_s: ways shorter than this are slowed down, see `approach_push`.
    """
    error, rate = np.empty(3), np.empty(3)
    for axis in range(3):
        error[axis], rate[axis] = x[0, axis] - target[0, axis, 0], x[1, axis] - target[1, axis, 0]
    split = split_norm(error, rate, target[1, :, 0], limits, fraction)
    slowest, fastest = rate_bounds(target[1, :, 0], limits)
    reference = np.empty((3, 3, len(node_s) - 1))
    for axis in range(3):
        share = limits[4] if axis == 2 else limits[3] * (math.cos(split) if axis == 0 else math.sin(split))
        push = approach_push(error[axis], rate[axis], fraction * share, share, time_min_s)
        way = fastest_way(error[axis], rate[axis], push, slowest[axis], fastest[axis])
        for node in range(1, len(node_s)):
            _, p, v, a = way_at(error[axis], rate[axis], way, node_s[node])
            reference[0, axis, node - 1] = target[0, axis, node] + p
            reference[1, axis, node - 1] = target[1, axis, node] + v
            reference[2, axis, node - 1] = target[2, axis, node] + a
    for node in range(1, len(node_s)):
        if reference[0, 2, node - 1] < floor[node]:
            reference[0, 2, node - 1] = floor[node]
            reference[1, 2, node - 1] = (floor[node] - floor[node - 1]) / (node_s[node] - node_s[node - 1])
            reference[2, 2, node - 1] = 0.0
    return reference
