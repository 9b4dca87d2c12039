"""The fallback of every guidance law: match a velocity with limited jerk and acceleration, without a solver.

Per axis the velocity error and the acceleration go to zero in the shortest time: the jerk is +j, 0 or -j. The
velocity to match is the target's horizontally; vertically it is the target's if that climbs and zero otherwise, so
that a drone without a plan does not sink onto a deck. Without a finite target it is rest.
"""

import math

import numpy as np

from companion.core.data import Array, FlightLimits
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, ReferenceState, Target, Trajectory
from companion.planning.intercept import fastest_way, way_at

HORIZON_S = 3.0
STEP_S = 0.1


def brake(request: PlanRequest, status: PlanStatus, iterations: int) -> PlanResult:
    """Return the fallback for `request`, whose state must be finite."""
    offsets = np.append(np.arange(0.0, HORIZON_S, STEP_S), HORIZON_S)
    times = np.append(offsets, request.dt_s)
    position, velocity, acceleration = _motion(request.state, wanted_velocity(request.target), request.limits, times)
    return PlanResult(
        next_state=ReferenceState(
            position_enu_m=position[-1], velocity_enu_m_s=velocity[-1], acceleration_enu_m_s2=acceleration[-1]
        ),
        trajectory=Trajectory(
            offset_s=offsets,
            position_enu_m=position[:-1],
            velocity_enu_m_s=velocity[:-1],
            acceleration_enu_m_s2=acceleration[:-1],
        ),
        status=status,
        limit_excess=0.0,
        iterations=iterations,
    )


def wanted_velocity(target: Target) -> Array:
    """Return the velocity (3,) that the fallback goes to: the target's where that is known and does not sink."""
    velocity = np.zeros(3)
    if target.velocity_enu_m_s.shape[0] and np.isfinite(target.velocity_enu_m_s[0]).all():
        velocity[:] = target.velocity_enu_m_s[0]
    velocity[2] = max(velocity[2], 0.0)
    return velocity


def _motion(state: ReferenceState, wanted: Array, limits: FlightLimits, t_s: Array) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration (n, 3) at `t_s`; each horizontal axis gets 1/sqrt(2) of a norm."""
    path = np.empty((3, t_s.size, 3))
    for axis, share in enumerate((math.sqrt(0.5), math.sqrt(0.5), 1.0)):
        is_up = axis == 2
        bound = limits.vertical_acceleration_max_m_s2 if is_up else share * limits.acceleration_max_m_s2
        jerk = limits.vertical_jerk_max_m_s3 if is_up else share * limits.jerk_max_m_s3
        error, push = state.velocity_enu_m_s[axis] - wanted[axis], state.acceleration_enu_m_s2[axis]
        way = fastest_way(error, push, jerk, -bound, bound)
        for i, t in enumerate(t_s):
            covered, rate, acceleration, _ = way_at(error, push, way, t)
            path[0, i, axis] = state.position_enu_m[axis] + wanted[axis] * t + covered
            path[1, i, axis] = wanted[axis] + rate
            path[2, i, axis] = acceleration
    return path[0], path[1], path[2]
