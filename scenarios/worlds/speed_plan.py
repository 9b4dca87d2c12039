"""The speed that the driver of a world plans along its road, on a grid of places.

No faster than the driver's wandering wish and than bends and humps allow, braking comfortably ahead of each.
"""

import math
from dataclasses import dataclass

import numpy as np

from scenarios.simulation.noise import Seed, named_rng
from scenarios.tracks.suspension import Array
from scenarios.worlds.draws import Draws
from scenarios.worlds.road import RoadPlan
from sim_autopilot.physics.airframe import GRAVITY_M_S2

_CELL_S = 0.05  # at cruising speed
_CELL_MIN_M, _CELL_MAX_M = 0.2, 1.0
_WISH_MIN, _WISH_MAX = 0.7, 1.15  # of the wandering wish; a choice


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """Places `step_m` apart: the planned speed at each, and the curvature of the cell behind it.

    Attributes:
        step_m: from one place to the next.
        caps_m_s: planned at each place.
        curvatures_per_m: the greatest in the cell behind each place; events add to it.
        speeding_m_s2: with which this driver speeds up.
        grip_m_s2: radius of the friction circle.
    """

    step_m: float
    speeding_m_s2: float
    grip_m_s2: float
    caps_m_s: list[float]
    curvatures_per_m: list[float]


def plan_speed(draws: Draws, seed: Seed, road: RoadPlan, *, cruise_m_s: float, length_m: float) -> Grid:
    """Return the grid with the speeds that the driver plans."""
    step_m = min(_CELL_MAX_M, max(_CELL_MIN_M, cruise_m_s * _CELL_S))
    count = int(length_m / step_m)
    caps_m_s = _wishes(draws, seed, cruise_m_s, step_m, count)
    for limit in road.limits:
        first, last = int(limit.from_m / step_m), math.ceil(limit.to_m / step_m)
        caps_m_s[first : last + 1] = np.minimum(caps_m_s[first : last + 1], limit.speed_m_s)
    slowing_m_s2 = draws.number("driver.deceleration_m_s2")
    caps = caps_m_s.tolist()
    for i in range(count - 2, -1, -1):
        caps[i] = min(caps[i], math.sqrt(caps[i + 1] ** 2 + 2.0 * slowing_m_s2 * step_m))
    return Grid(
        step_m=step_m,
        caps_m_s=caps,
        curvatures_per_m=_cell_curvatures(road, step_m, count),
        speeding_m_s2=draws.number("driver.acceleration_m_s2"),
        grip_m_s2=draws.number("road.friction") * GRAVITY_M_S2,
    )


def _wishes(draws: Draws, seed: Seed, cruise_m_s: float, step_m: float, count: int) -> Array:
    """Return the speed (count,) that the driver would like: an Ornstein-Uhlenbeck process about his cruising speed.

    Its square is linear in the place between knots, so the acceleration is constant there.
    """
    share, tau_s = draws.number("driver.wander_share"), draws.number("driver.wander_s")
    knot_s = 0.5 * tau_s
    knots = 2 + int(count * step_m / (knot_s * cruise_m_s * _WISH_MIN))
    decay = math.exp(-knot_s / tau_s)
    value, wishes = 0.0, []
    for kick in named_rng(seed, "world driver wander").standard_normal(knots).tolist():
        wishes.append(cruise_m_s * min(_WISH_MAX, max(_WISH_MIN, 1.0 + share * value)))
        value = decay * value + math.sqrt(1.0 - decay**2) * kick
    places_m = np.arange(knots) * knot_s * cruise_m_s
    squares: Array = np.interp(np.arange(count) * step_m, places_m, np.square(wishes))
    return np.sqrt(squares)


def _cell_curvatures(road: RoadPlan, step_m: float, count: int) -> list[float]:
    """Return the greatest curvature in each of `count` cells."""
    sharpest = np.zeros(count)
    begins_m = 0.0
    for stretch_m, begin_per_m, end_per_m in road.stretches:
        first, last = int(begins_m / step_m), math.ceil((begins_m + stretch_m) / step_m)
        sharpest[first:last] = np.maximum(sharpest[first:last], max(abs(begin_per_m), abs(end_per_m)))
        begins_m += stretch_m
    return sharpest.tolist()
