"""How a body on wheels dives when it brakes and leans in a bend, and moves the pad on its roof; compiled in part.

On its springs it follows the vehicle's acceleration a, along it and to its left, as a damped oscillator,

    r'' = w^2 (a - r) - 2 d w r'

and its deck slopes by c r: nose down by 1 to 3 degrees for each g of braking, to the outside of a bend by 3 to 7 for
each g. A pad h above the road, about which the body tilts, is at -h c r beside where it would be on a level one. So a
brake of 4 m/s^2 has a roof 2 m up run ahead of its wheels by up to 0.2 m/s.
Source: Gillespie, Fundamentals of Vehicle Dynamics, 1992, chapter 5; Milliken and Milliken, Race Car Vehicle Dynamics,
1995, of road cars.
"""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import GRAVITY_M_S2, Array
from companion.forecast.compiled import compiled_kernel

Spring = tuple[float, float, float, float]
"""How r - a and r' go on over a step: row by row, as `spring` returns it."""

_RAD_S = 2.0 * math.pi * 1.5  # at which bodies pitch and roll on their wheels
_DAMPING = 0.3  # of the critical one; dampers have 0.2 to 0.4
_GAINS_RAD_S2_M = np.radians([[1.0, 3.0], [3.0, 7.0]]) / GRAVITY_M_S2
"""The least and the greatest of a dive, and of a lean."""
_GAP_MAX_NS = 1_000_000_000  # of data, in which a body comes to rest


class BodyLean(Struct, frozen=True, kw_only=True):
    """How the body of a vehicle stands that does not tell it.

    Attributes:
        dive: r, m/s^2, and its rate, m/s^3, by the acceleration along the vehicle.
        lean: likewise, by that to its left.
        t_ns: of the newest datum that counts, UTC; None before the first.
    """

    dive: tuple[float, float] = (0.0, 0.0)
    lean: tuple[float, float] = (0.0, 0.0)
    t_ns: int | None = None


def update_body(body: BodyLean, t_ns: int, along_m_s2: float, left_m_s2: float) -> BodyLean:
    """Return the body at a newer datum, by the acceleration that it tells of; after an outage it stands in it."""
    since_ns = None if body.t_ns is None else t_ns - body.t_ns
    if since_ns is None or not 0 <= since_ns < _GAP_MAX_NS:
        return BodyLean(dive=(along_m_s2, 0.0), lean=(left_m_s2, 0.0), t_ns=t_ns)
    step = spring(since_ns * 1e-9)
    return BodyLean(dive=sprung(body.dive, along_m_s2, step), lean=sprung(body.lean, left_m_s2, step), t_ns=t_ns)


def gains_rad_s2_m(uniforms: Array) -> Array:
    """Return c of dive and lean (n, 2) of bodies that nothing more is known of, by (n, 2) uniform numbers."""
    least, greatest = _GAINS_RAD_S2_M.T
    return np.asarray(least + uniforms * (greatest - least))


@compiled_kernel
def spring(dt_s: float) -> Spring:
    """Return how a body goes on over `dt_s`, exact while the acceleration stays."""
    damped = _RAD_S * math.sqrt(1.0 - _DAMPING**2)
    fade = math.exp(-_DAMPING * _RAD_S * dt_s)
    c, s = fade * math.cos(damped * dt_s), fade * math.sin(damped * dt_s)
    ratio = _DAMPING * _RAD_S / damped
    return c + ratio * s, s / damped, -(_RAD_S**2) / damped * s, c - ratio * s


@compiled_kernel
def sprung(state: tuple[float, float], acceleration_m_s2: float, step: Spring) -> tuple[float, float]:
    """Return r and its rate after a step."""
    off, rate = state[0] - acceleration_m_s2, state[1]
    return acceleration_m_s2 + step[0] * off + step[1] * rate, step[2] * off + step[3] * rate
