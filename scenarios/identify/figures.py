"""What a flight of the manoeuvres tells of an autopilot: rise, overshoot, lag, and what it can do vertically."""

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array
from scenarios.identify.manoeuvres import CIRCLE_RADIUS_M, DURATION_S, Name, span_s, wish_at
from scenarios.identify.pilot import Flight

_X, _Z = 0, 2
_LAST_S = 2.0
"""The end of a manoeuvre, over which a steady deviation is averaged."""
_SOON_S = 5.5
"""After the ramp began: 3 s after it ended."""
_CIRCLE_FROM_S = 10.0
_SLOPE_S = 0.1
"""Over which a velocity's slope is taken, for acceleration and jerk."""


def figures(flight: Flight) -> dict[str, float]:
    """Return each figure by its name, which has its unit."""
    found: dict[str, float] = {}
    for name in (Name.HEIGHT_STEP, Name.HEIGHT_BACK):
        found |= _step_figures(flight, name, _Z)
    for name in (Name.POSITION_STEP, Name.POSITION_BACK):
        found |= _step_figures(flight, name, _X)
    found |= _lag_figures(flight)
    for name, label in ((Name.CLIMB, "climb"), (Name.SINK, "vertical reversal")):
        _, off_m = _deviation(flight, name, _Z)
        found[f"{label}: off at most m"] = float(np.max(np.abs(off_m)))
    return found | _circle_figures(flight) | _vertical_figures(flight)


def _part(flight: Flight, name: Name) -> tuple[Array, NDArray[np.bool_]]:
    """Return the reports of a manoeuvre: the times since it began (n,), and whether each of all belongs to it."""
    begin_s, end_s = span_s(name)
    inside = (flight.t_s >= begin_s) & (flight.t_s < end_s)
    return flight.t_s[inside] - begin_s, inside


def _deviation(flight: Flight, name: Name, axis: int) -> tuple[Array, Array]:
    """Return times (n,) since it began, and by how much the drone was beyond what was asked (n,)."""
    t_s, inside = _part(flight, name)
    begin_s, _ = span_s(name)
    asked_m = np.array([wish_at(begin_s + t)[0][axis] for t in t_s])
    return t_s, flight.position_m[inside, axis] - asked_m


def _step_figures(flight: Flight, name: Name, axis: int) -> dict[str, float]:
    t_s, off_m = _deviation(flight, name, axis)
    begin_s, _ = span_s(name)
    before = (flight.t_s >= begin_s - 0.5) & (flight.t_s < begin_s)
    start_m = float(np.mean(flight.position_m[before, axis]))
    way_m = wish_at(begin_s + 0.1)[0][axis] - start_m
    share = 1.0 + off_m / way_m
    beyond_m = float(np.max(share) - 1.0) * abs(way_m)
    return {
        f"{name.value}: 63 % after s": float(t_s[np.argmax(share > 0.63)]),
        f"{name.value}: 90 % after s": float(t_s[np.argmax(share > 0.9)]),
        f"{name.value}: overshoot m": max(0.0, beyond_m),
    }


def _lag_figures(flight: Flight) -> dict[str, float]:
    t_s, off_m = _deviation(flight, Name.RAMP, _X)
    soon = np.abs(t_s - _SOON_S) < 0.5
    last = t_s > t_s[-1] - _LAST_S
    _, turned_m = _deviation(flight, Name.REVERSAL, _X)
    _, stopped_m = _deviation(flight, Name.STOP, _X)
    return {
        "0 to 5 m/s: behind at most m": float(-np.min(off_m)),
        "at 5 m/s: behind after 3 s m": float(-np.mean(off_m[soon])),
        "at 5 m/s: behind in the end m": float(-np.mean(off_m[last])),
        "5 to -5 m/s: off at most m": float(np.max(np.abs(turned_m))),
        "stop from 5 m/s: past it m": float(-np.min(stopped_m)),
    }


def _circle_figures(flight: Flight) -> dict[str, float]:
    t_s, inside = _part(flight, Name.CIRCLE)
    begin_s, _ = span_s(Name.CIRCLE)
    centre = np.add(wish_at(begin_s + 1e-6)[0][:2], (0.0, CIRCLE_RADIUS_M))
    late = t_s > _CIRCLE_FROM_S
    asked = np.array([wish_at(begin_s + t)[0][:2] for t in t_s[late]]) - centre
    flown = flight.position_m[inside, :2][late] - centre
    outward_m = np.hypot(*flown.T) - CIRCLE_RADIUS_M
    turn = np.arctan2(asked[:, 0] * flown[:, 1] - asked[:, 1] * flown[:, 0], np.sum(asked * flown, axis=1))
    return {
        "circle of 20 m at 5 m/s: outward m": float(np.mean(outward_m)),
        "circle of 20 m at 5 m/s: behind m": float(-np.mean(turn) * CIRCLE_RADIUS_M),
    }


def _vertical_figures(flight: Flight) -> dict[str, float]:
    """Return the largest vertical acceleration and jerk of the height steps and climbs."""
    grid_s = np.arange(0.0, DURATION_S, _SLOPE_S)
    climbing = np.interp(grid_s, flight.t_s, flight.velocity_m_s[:, _Z])
    acceleration = np.gradient(climbing, _SLOPE_S)
    jerk = np.gradient(acceleration, _SLOPE_S)
    begin_s, end_s = span_s(Name.HEIGHT_STEP)[0], span_s(Name.HEIGHT_BACK)[1]
    steps = (grid_s >= begin_s) & (grid_s < end_s)
    return {
        "height steps: largest acceleration m/s^2": float(np.percentile(np.abs(acceleration[steps]), 98)),
        "height steps: largest jerk m/s3": float(np.percentile(np.abs(jerk[steps]), 98)),
    }
