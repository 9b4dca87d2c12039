"""A plan as it is flown: where the virtual model is at any time after it begins; pure numerics.

A step comes when the drone has reported, over a link that loses and delays 0.02 to 0.04 s after the one before. The
model goes on along its plan for as long as that was. Steps of a fixed period instead would change its acceleration by
less than was planned (0.65 of it on such a link), and a plan of limited jerk would then swing about what it follows.
"""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import RATE_LAG_S, Cascade, Shaping
from companion.core.data import Array, FlightLimits
from companion.planning.guidance import PlanResult, ReferenceState, Trajectory
from link.records import replace


class FlownPlan(Struct, frozen=True, kw_only=True, eq=False):
    """A plan, and how it is kept up for an autopilot that carries setpoints on.

    Attributes:
        starts_ns: when it begins, monotonic.
        trajectory: of the virtual model, from where that is then.
        lowest_enu_m: height above which a setpoint that is carried on has to end.
        shaping: of the autopilot; None of one that holds setpoints as they came.
        limits: of the plan.
    """

    starts_ns: int
    trajectory: Trajectory
    lowest_enu_m: float
    shaping: Shaping | None
    limits: FlightLimits


def flown_plan(
    plan: PlanResult,
    period_s: float,
    lowest_enu_m: float,
    shaping: Shaping | None,
    limits: FlightLimits,
    *,
    starts_ns: int = 0,
) -> FlownPlan:
    """Return the plan as it is flown: its next state, `period_s` after it begins, is one of its instants."""
    path, following = plan.trajectory, plan.next_state
    later = int(path.offset_s.searchsorted(period_s, side="right"))
    trajectory = Trajectory(
        offset_s=np.concatenate((path.offset_s[:1], [period_s], path.offset_s[later:])),
        position_enu_m=_through(path.position_enu_m, following.position_enu_m, later),
        velocity_enu_m_s=_through(path.velocity_enu_m_s, following.velocity_enu_m_s, later),
        acceleration_enu_m_s2=_through(path.acceleration_enu_m_s2, following.acceleration_enu_m_s2, later),
    )
    return FlownPlan(
        starts_ns=starts_ns, trajectory=trajectory, lowest_enu_m=lowest_enu_m, shaping=shaping, limits=limits
    )


def state_at(flown: FlownPlan, offset_s: float) -> ReferenceState:
    """Return the model `offset_s` after its plan begins."""
    planned = state_in_plan(flown.trajectory, offset_s)
    if flown.shaping is None:
        return planned
    before = ReferenceState(
        position_enu_m=flown.trajectory.position_enu_m[0],
        velocity_enu_m_s=flown.trajectory.velocity_enu_m_s[0],
        acceleration_enu_m_s2=flown.trajectory.acceleration_enu_m_s2[0],
    )
    return keep_up(planned, before, flown.lowest_enu_m, flown.shaping, limits=flown.limits, elapsed_s=offset_s)


def _through(path: Array, following: Array, later: int) -> Array:
    return np.concatenate((path[:1], following[np.newaxis], path[later:]))


def state_in_plan(trajectory: Trajectory, offset_s: float) -> ReferenceState:
    """Return the model `offset_s` after its plan begins; between two instants of a plan the jerk is constant."""
    last = len(trajectory.offset_s) - 2
    node = min(max(int(trajectory.offset_s.searchsorted(offset_s, side="right")) - 1, 0), last)
    start_s, end_s = trajectory.offset_s[node : node + 2].tolist()
    duration_s, t_s = end_s - start_s, offset_s - start_s
    # Axis by axis in plain numbers: of three at a time arrays take twice as long.
    position, velocity = trajectory.position_enu_m[node].tolist(), trajectory.velocity_enu_m_s[node].tolist()
    acceleration, later = trajectory.acceleration_enu_m_s2[node : node + 2].tolist()
    jerk = [(end - start) / duration_s for start, end in zip(acceleration, later, strict=True)]
    motion = list(zip(position, velocity, acceleration, jerk, strict=True))
    return ReferenceState(
        position_enu_m=np.array([p + (v + (a / 2.0 + j * t_s / 6.0) * t_s) * t_s for p, v, a, j in motion]),
        velocity_enu_m_s=np.array([v + (a + j * t_s / 2.0) * t_s for _, v, a, j in motion]),
        acceleration_enu_m_s2=np.array([a + j * t_s for _, _, a, j in motion]),
    )


def asked_for(plan: FlownPlan, cascade: Cascade | None, period_s: float) -> ReferenceState:
    """Return what a setpoint asks for that takes effect as the plan begins.

    An autopilot that carries it on is asked for the mean acceleration until the next one comes. One whose setpoints are
    led is asked for more, since its lean lags: for the mean jerk of the time in which turn rates follow, for of a
    shorter one the drone makes nothing.

    Args:
        plan: of the step.
        cascade: of the autopilot, None while none is known.
        period_s: until the next setpoint.
    """
    start = state_at(plan, 0.0)
    now = start.acceleration_enu_m_s2
    if cascade is not None and cascade.is_led:
        jerk_m_s3 = (state_at(plan, RATE_LAG_S).acceleration_enu_m_s2 - now) / RATE_LAG_S
        now = np.append(cascade.lead(now[:2], jerk_m_s3[:2]), now[2])
    elif plan.shaping is not None:
        now = state_at(plan, 0.5 * period_s).acceleration_enu_m_s2
    return replace(start, acceleration_enu_m_s2=now)


def keep_up(
    planned: ReferenceState,
    before: ReferenceState,
    lowest_enu_m: float,
    shaping: Shaping,
    *,
    limits: FlightLimits,
    elapsed_s: float,
) -> ReferenceState:
    """Return the planned next state, kept up by `limit_sink`, so that it may be carried on.

    The model itself is kept up, for the drone follows what is sent, and the next plan begins there.

    Args:
        planned: the model `elapsed_s` after `before`.
        before: the model when the plan was made.
        lowest_enu_m: where it is to end above.
        shaping: of the autopilot.
        limits: of the plan.
        elapsed_s: since then.
    """
    limited = limit_sink(planned, lowest_enu_m, shaping, limits)
    if limited is planned:
        return planned
    up = extrapolate(replace(before, acceleration_enu_m_s2=limited.acceleration_enu_m_s2), elapsed_s)
    kept_up = ReferenceState(
        position_enu_m=np.array([*planned.position_enu_m[:2], up.position_enu_m[2]]),
        velocity_enu_m_s=np.array([*planned.velocity_enu_m_s[:2], up.velocity_enu_m_s[2]]),
        acceleration_enu_m_s2=limited.acceleration_enu_m_s2,
    )
    return limit_sink(kept_up, lowest_enu_m, shaping, limits)


def limit_sink(
    reference: ReferenceState, lowest_enu_m: float, shaping: Shaping, limits: FlightLimits
) -> ReferenceState:
    """Return the model for an autopilot that carries a setpoint on, should no other follow.

    Its acceleration upwards is at least such that the drone, which then brakes, ends above `lowest_enu_m`: ArduCopter
    was flown into the road at 1.6 m/s from a chase whose companion had died. The rate w at the end of the time T obeys
    `h + (v + w) T / 2 - w^2 / 2A + w A / 2J >= 0` with the height h, the rate v, the braking A and its jerk J.

    One that is too low, or sinks too fast, to end there within T climbs as the limits allow: of a short T it would be
    asked for any acceleration.
    """
    duration_s, braking_m_s2 = shaping.carried_s, shaping.vertical_acceleration_m_s2
    turning_s = braking_m_s2 / shaping.vertical_jerk_m_s3
    above_m = float(reference.position_enu_m[2]) - lowest_enu_m
    ax, ay, az = reference.acceleration_enu_m_s2.tolist()
    climb_m_s, room_m = float(reference.velocity_enu_m_s[2]), 2.0 * above_m
    room_m += climb_m_s * duration_s
    if room_m >= 0.0:
        brakes_m_s = braking_m_s2 * (duration_s + turning_s)
        end_m_s = 0.5 * (brakes_m_s - math.sqrt(brakes_m_s**2 + 4.0 * braking_m_s2 * room_m))
    else:
        end_m_s = min(-room_m / duration_s, limits.climb_max_m_s)
    least_m_s2 = min((end_m_s - climb_m_s) / duration_s, limits.vertical_acceleration_max_m_s2)
    if az >= least_m_s2:
        return reference
    return replace(reference, acceleration_enu_m_s2=np.array([ax, ay, least_m_s2]))


def extrapolate(reference: ReferenceState, duration_s: float) -> ReferenceState:
    """Return the model `duration_s` later (or, negative, earlier) at its present acceleration."""
    velocity, acceleration = reference.velocity_enu_m_s, reference.acceleration_enu_m_s2
    return replace(
        reference,
        position_enu_m=reference.position_enu_m + (velocity + 0.5 * acceleration * duration_s) * duration_s,
        velocity_enu_m_s=velocity + acceleration * duration_s,
    )
