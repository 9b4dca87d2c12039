"""The way down to the pad from where the virtual model is and how it moves: a path that it can fly; compiled.

Heights h (m) over the pad, rates w = h' (m/s, upwards) and accelerations b = w' (m/s^2) are against it. The wanted rate
is a field over the height: w* = -g h, between the slowest and the fastest sink rate, and -(J / 2A) (h - h_lowest) where
that is slower. The path goes from (h, w, b) into that field with bounded acceleration A and jerk J,

    b* = (J / A) (w* - w) + w dw*/dh, at most A;      b goes towards b* by at most J dt

A plan that follows it is the rest of itself when it is made anew a step later. One that follows the field alone, as if
its rate could be had at once, is late for it in every step and sinks faster than the field to make up for that.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel

_STEP_S = 0.02


@compiled_kernel
def descent_path(
    state: tuple[float, float, float],
    field: tuple[float, float, float, float],
    bounds: tuple[float, float],
    offset_s: Array,
) -> Array:
    """Return heights, rates and accelerations (3, n) at `offset_s`.

    Args:
        state: height, rate and acceleration now.
        field: gain (1/s), fastest and slowest sink rate (m/s, downwards), lowest height (m).
        bounds: of acceleration (m/s^2) and jerk (m/s^3).
        offset_s: (n,) after now, rising.
    """
    h, w, b = state
    gain, fast, slow, lowest = field
    most, jerk = bounds
    slope, ending = jerk / most, 0.5 * jerk / most
    path = np.empty((3, len(offset_s)))
    t = 0.0
    for sample in range(len(offset_s)):
        steps = math.ceil((offset_s[sample] - t) / _STEP_S - 1e-9)
        for _ in range(steps):
            dt = (offset_s[sample] - t) / steps
            sink, bend = min(max(gain * h, slow), fast), gain if slow < gain * h < fast else 0.0
            if ending * (h - lowest) < sink:
                sink, bend = max(ending * (h - lowest), -fast), ending
            wanted = min(max(slope * (-sink - w) - bend * w, -most), most)
            b += min(max(wanted - b, -jerk * dt), jerk * dt)
            h += (w + 0.5 * b * dt) * dt
            w += b * dt
        t = offset_s[sample]
        path[0, sample], path[1, sample], path[2, sample] = h, w, b
    return path
