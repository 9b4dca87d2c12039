"""The point that a mode moves ahead of the drone: at bounded speed and acceleration to a goal, and to a stop there.

Horizontally and vertically by itself; the speed falls off linearly near the goal, by constant deceleration farther out.
Its acceleration is fed forward, as by the firmwares' own ways: their velocity loops alone would overshoot the goal.
"""

from dataclasses import dataclass
from math import atan2, hypot, sqrt

import numpy as np

from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.data import Array, Reference

_SLOPE_PER_S = 1.5
_TURNS_BEYOND_M = 1.0
"""Nearer to the goal than this the heading stays."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """How fast a goal may be approached: horizontally, upwards, downwards, and the acceleration in every direction."""

    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """Where a mode goes to in W, at most as fast as `speed_m_s`; without `yaw_rad` the nose points there."""

    position_enu_m: Vector3
    speed_m_s: float
    yaw_rad: float | None = None


def move(anchor: Reference, goal: Goal, pace: Pace, elapsed_s: float) -> Reference:
    """Return `anchor`, which has a position and a velocity, `elapsed_s` nearer to `goal`."""
    position, velocity = anchor.position_enu_m, anchor.velocity_enu_m_s
    if position is None or velocity is None:
        raise ValueError("a point that moves has a position and a velocity")
    dx, dy, dz = (goal.position_enu_m - position).tolist()
    distance_m = hypot(dx, dy)
    speed_m_s = _approach_m_s(distance_m, min(goal.speed_m_s, pace.speed_m_s), pace.acceleration_m_s2)
    scale = speed_m_s / distance_m if distance_m > 0.0 else 0.0
    vertical_m_s = _approach_m_s(abs(dz), pace.climb_m_s if dz > 0.0 else pace.descent_m_s, pace.acceleration_m_s2)
    wanted = np.array((dx * scale, dy * scale, vertical_m_s if dz > 0.0 else -vertical_m_s))
    after = velocity + _limit(wanted - velocity, pace.acceleration_m_s2 * elapsed_s)
    yaw_rad = goal.yaw_rad
    if yaw_rad is None:
        yaw_rad = atan2(dy, dx) if distance_m > _TURNS_BEYOND_M else anchor.yaw_rad
    return replace(
        anchor,
        position_enu_m=position + 0.5 * elapsed_s * (velocity + after),
        velocity_enu_m_s=after,
        acceleration_enu_m_s2=(after - velocity) / elapsed_s,
        yaw_rad=yaw_rad,
    )


def _approach_m_s(distance_m: float, speed_m_s: float, braking_m_s2: float) -> float:
    linear_m = braking_m_s2 / _SLOPE_PER_S**2
    if distance_m <= linear_m:
        return min(speed_m_s, _SLOPE_PER_S * distance_m)
    return min(speed_m_s, sqrt(2.0 * braking_m_s2 * (distance_m - 0.5 * linear_m)))


def _limit(change: Array, most: float) -> Array:
    size = float(np.linalg.norm(change[:2]))
    along = change[:2] * min(1.0, most / size) if size > 0.0 else change[:2]
    return np.array((along[0], along[1], max(-most, min(most, change[2]))))
