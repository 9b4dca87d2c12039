"""The fallback of every guidance law: match a velocity with limited jerk and acceleration, without a solver.

Per axis the velocity error and the acceleration go to zero in the shortest time: the jerk is +j, 0 or -j. The
velocity to match is the target's horizontally; vertically it is the target's if that climbs and zero otherwise, so
that a drone without a plan does not sink onto a deck. Without a finite target it is rest.
"""

import numpy as np

from companion.data import Array, FlightLimits
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, ReferenceState, Target, Trajectory
from companion.planning.intercept import Intercept, plan_intercept

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
    share = np.array([np.sqrt(0.5), np.sqrt(0.5), 1.0])
    bound = share * np.array([limits.acceleration_max_m_s2] * 2 + [limits.vertical_acceleration_max_m_s2])
    jerk = share * limits.jerk_max_m_s3
    way = plan_intercept(state.velocity_enu_m_s - wanted, state.acceleration_enu_m_s2, jerk, -bound, bound)
    error, acceleration, _ = way.at(t_s)
    velocity = wanted[:, None] + error
    position = state.position_enu_m[:, None] + wanted[:, None] * t_s + _integral(way, t_s)
    return position.T, velocity.T, acceleration.T


def _integral(way: Intercept, t_s: Array) -> Array:
    """Return the integral over time of the relative position of `way`, (k, n): three cubics and a rest at zero."""
    first, cruise, last = way.first_s[:, None], way.cruise_s[:, None], way.last_s[:, None]
    start, middle = way.rate_m_s[:, None], way.cruise_m_s[:, None]
    gain = (middle - start) / np.maximum(first, 1e-12)
    slow = -middle / np.maximum(last, 1e-12)
    in_first = np.minimum(t_s, first)
    in_cruise = np.clip(t_s - first, 0.0, cruise)
    in_last = np.clip(t_s - (first + cruise), 0.0, last)
    at_cruise = way.error_m[:, None] + start * first + gain * first**2 / 2.0
    at_last = at_cruise + middle * cruise
    return (
        way.error_m[:, None] * in_first
        + start * in_first**2 / 2.0
        + gain * in_first**3 / 6.0
        + at_cruise * in_cruise
        + middle * in_cruise**2 / 2.0
        + at_last * in_last
        + middle * in_last**2 / 2.0
        + slow * in_last**3 / 6.0
    )
