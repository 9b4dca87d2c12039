"""The manoeuvres of an identification: steps, ramps, reversals and a circle, as ways to be followed; pure numerics.

Each begins at rest against the one before, where that one ends. Place (m), velocity (m/s) and acceleration (m/s^2) are
in W from where the first begins.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from itertools import accumulate
from math import copysign, cos, sin

from link.messages import Vector3

Wish = tuple[Vector3, Vector3, Vector3]
"""Position, velocity and acceleration."""
_NONE: Vector3 = (0.0, 0.0, 0.0)
_X, _Z = 0, 2
CIRCLE_RADIUS_M, CIRCLE_SPEED_M_S = 20.0, 5.0
_CIRCLE_START_S = 3.0
"""In which the speed on the circle grows evenly."""


class Name(Enum):
    """Of a manoeuvre."""

    SETTLE = "settle"
    HEIGHT_STEP = "height step"
    HEIGHT_BACK = "height back"
    POSITION_STEP = "position step"
    POSITION_BACK = "position back"
    RAMP = "ramp"
    REVERSAL = "reversal"
    STOP = "stop"
    CLIMB = "climb"
    SINK = "vertical reversal"
    LEVEL = "level"
    CIRCLE = "circle"


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """A way, as a function of the time since it began, and for how long it is flown."""

    name: Name
    duration_s: float
    way: Callable[[float], Wish]


def _along(axis: int, value: float) -> Vector3:
    return (value, 0.0, 0.0) if axis == _X else (0.0, 0.0, value)


def _step(axis: int, offset_m: float) -> Callable[[float], Wish]:
    return lambda _: (_along(axis, offset_m), _NONE, _NONE)


def _ramp(axis: int, before_m_s: float, after_m_s: float, acceleration_m_s2: float) -> Callable[[float], Wish]:
    """From one speed to another by a constant acceleration, and on."""
    ends_s = abs(after_m_s - before_m_s) / acceleration_m_s2
    rate = copysign(acceleration_m_s2, after_m_s - before_m_s)

    def way(t_s: float) -> Wish:
        ramp_s = min(t_s, ends_s)
        place = before_m_s * ramp_s + 0.5 * rate * ramp_s**2 + after_m_s * (t_s - ramp_s)
        speed = before_m_s + rate * ramp_s
        return _along(axis, place), _along(axis, speed), _along(axis, rate if t_s < ends_s else 0.0)

    return way


def _circle(t_s: float) -> Wish:
    radius, speed = CIRCLE_RADIUS_M, CIRCLE_SPEED_M_S
    share = min(t_s / _CIRCLE_START_S, 1.0)
    arc = 0.5 * speed * share * min(t_s, _CIRCLE_START_S) + speed * max(0.0, t_s - _CIRCLE_START_S)
    c, s, now, gain = cos(arc / radius), sin(arc / radius), speed * share, speed / _CIRCLE_START_S * (share < 1.0)
    inward = now * now / radius
    place = (radius * s, radius * (1.0 - c), 0.0)
    return place, (now * c, now * s, 0.0), (gain * c - inward * s, gain * s + inward * c, 0.0)


MANOEUVRES = (
    Manoeuvre(Name.SETTLE, 4.0, _step(_X, 0.0)),
    Manoeuvre(Name.HEIGHT_STEP, 7.0, _step(_Z, 2.0)),
    Manoeuvre(Name.HEIGHT_BACK, 7.0, _step(_Z, -2.0)),
    Manoeuvre(Name.POSITION_STEP, 9.0, _step(_X, 5.0)),
    Manoeuvre(Name.POSITION_BACK, 9.0, _step(_X, -5.0)),
    Manoeuvre(Name.RAMP, 10.0, _ramp(_X, 0.0, 5.0, 2.0)),
    Manoeuvre(Name.REVERSAL, 10.0, _ramp(_X, 5.0, -5.0, 2.5)),
    Manoeuvre(Name.STOP, 8.0, _ramp(_X, -5.0, 0.0, 2.5)),
    Manoeuvre(Name.CLIMB, 2.5, _ramp(_Z, 0.0, 1.5, 2.0)),
    Manoeuvre(Name.SINK, 3.5, _ramp(_Z, 1.5, -1.0, 2.0)),
    Manoeuvre(Name.LEVEL, 5.0, _ramp(_Z, -1.0, 0.0, 2.0)),
    Manoeuvre(Name.CIRCLE, 22.0, _circle),
)
"""Accelerations a little below what the advised parameters allow; heights stay within 3 m of the first."""

_ENDS_S = tuple(accumulate(one.duration_s for one in MANOEUVRES))
DURATION_S = _ENDS_S[-1]


def span_s(name: Name) -> tuple[float, float]:
    """Return when a manoeuvre begins and ends."""
    index = next(i for i, one in enumerate(MANOEUVRES) if one.name is name)
    return _ENDS_S[index] - MANOEUVRES[index].duration_s, _ENDS_S[index]


def _starts() -> tuple[Vector3, ...]:
    starts = [_NONE]
    for one in MANOEUVRES:
        starts.append(_add(starts[-1], one.way(one.duration_s)[0]))
    return tuple(starts)


def _add(a: Vector3, b: Vector3) -> Vector3:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


_STARTS = _starts()


def wish_at(t_s: float) -> Wish:
    """Return what is asked for, `t_s` after the first manoeuvre began; before, and after the last, its end."""
    t_s = min(max(t_s, 0.0), DURATION_S)
    index = next((i for i, end_s in enumerate(_ENDS_S) if t_s < end_s), len(_ENDS_S) - 1)
    one = MANOEUVRES[index]
    place, velocity, acceleration = one.way(t_s - (_ENDS_S[index] - one.duration_s))
    return _add(_STARTS[index], place), velocity, acceleration
