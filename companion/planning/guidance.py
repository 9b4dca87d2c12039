"""The one interface of all guidance laws: from a target over a horizon to the next setpoint of a virtual model.

The virtual model is a point mass whose position, velocity and acceleration are what the autopilot is asked to
follow. SI units, world ENU (W). A law is a pure function over its own immutable memory.
"""

import math
from enum import Enum
from typing import NewType, Protocol

import numpy as np
from msgspec import Struct

from companion.core.data import Array, FlightLimits
from companion.planning.following import Following
from link.records import replace


class PlanStatus(Enum):
    """How a plan came about; only SOLVED follows the law, all others brake."""

    SOLVED = "solved"
    SOLVED_INACCURATE = "solved inaccurately"  # the solver missed its tolerance: not flown
    INFEASIBLE = "infeasible"  # the solver proved that no plan satisfies the hard bounds
    FAILED = "failed"  # not finite input, iteration limit, numerical trouble


class ReferenceState(Struct, frozen=True, kw_only=True, eq=False):
    """The virtual model at one instant, each (3,) in W."""

    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array


class Target(Struct, frozen=True, kw_only=True, eq=False):
    """Where the drone's reference is wanted at `offset_s` (n,) >= 0, rising, after now; the others (n, 3) in W.

    After the last offset the target is taken to go on at its last velocity.
    """

    offset_s: Array
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array


class Leaning(Struct, frozen=True, kw_only=True, eq=False):
    """What the drone leans for: to accelerate along its path, and to hold against the air.

    Attributes:
        path_max_m_s2: norm of the path's acceleration alone.
        most_m_s2: norm of both together, the horizontal thrust by mass of the largest tilt.
        holds_enu_m_s2: (2,) what it leans beyond what its path accelerates by.
    """

    path_max_m_s2: float
    most_m_s2: float
    holds_enu_m_s2: Array


class PlanRequest(Struct, frozen=True, kw_only=True, eq=False):
    """What a guidance law plans from.

    Attributes:
        state: the virtual model now.
        target: where it is wanted.
        limits: what may be asked of the drone, its acceleration in the direction in which it is needed.
        floor_enu_m: (n,) lowest allowed height in W at the target's offsets.
        touched_enu_m: (n,) in place of a floor, where a pad is to be touched: the lowest that the height in W, carried
            on by its rate for `MpcConfig.touch_time_s`, may be. Laws without bounds on a plan pass it over.
        dt_s: control period, after which the next plan is made.
        following: how the drone deviates from what is planned, beside what the target makes up for already; None where
            it follows at once. Only the default law takes it into account.
        leaning: what bounds the acceleration in each direction; None where that of the limits does in all. Only the
            default law tells directions apart.
    """

    state: ReferenceState
    target: Target
    limits: FlightLimits
    floor_enu_m: Array
    dt_s: float
    touched_enu_m: Array | None = None
    following: Following | None = None
    leaning: Leaning | None = None


class Trajectory(Struct, frozen=True, kw_only=True, eq=False):
    """The planned motion of the virtual model at `offset_s` (n,) from 0 on; the others (n, 3) in W."""

    offset_s: Array
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array


class PlanResult(Struct, frozen=True, kw_only=True, eq=False):
    """What a guidance law wants flown.

    Attributes:
        next_state: the virtual model after the request's `dt_s`; finite and flyable whatever the status.
        trajectory: the whole plan; the fallback's braking when the status is not SOLVED.
        status: how it came about.
        limit_excess: largest excess over a soft limit in the plan (m/s, m/s^2 or, at the floor, m); 0 inside.
        iterations: of the solver, over all axes.
    """

    next_state: ReferenceState
    trajectory: Trajectory
    status: PlanStatus
    limit_excess: float
    iterations: int


GuidanceMemory = NewType("GuidanceMemory", object)
"""What a guidance law remembers; only that law reads it."""


class Guidance(Protocol):
    """What the companion asks of a guidance law; the memory is None at the first call."""

    def plan(self, memory: GuidanceMemory | None, request: PlanRequest) -> tuple[GuidanceMemory, PlanResult]:
        """Return the memory and the plan for `request`.

        Raises:
            ValueError: if the state is not finite and no earlier plan can stand in for it.
        """


def with_finite_state(last: ReferenceState | None, request: PlanRequest) -> PlanRequest:
    """Return `request`, its state replaced by the `last` planned one where it is not finite.

    Raises:
        ValueError: if the state is not finite and there is no last one, or `dt_s` or a limit is not positive.
    """
    limits_of(request)  # refuses what cannot be planned with
    if is_finite_state(request.state):
        return request
    if last is None:
        raise ValueError(f"the first reference state is not finite: {request.state}")
    return replace(request, state=last)


def limits_of(request: PlanRequest) -> tuple[float, float, float, float, float, float, float]:
    """Return the limits as the compiled calls take them: a whole number would have them recompiled, in flight.

    Raises:
        ValueError: if `dt_s` or a limit is not a positive number; without them there is not even a braking.
    """
    if not request.dt_s > 0.0:
        raise ValueError(f"the control period must be positive, not {request.dt_s} s")
    limits = request.limits
    values = (
        float(limits.speed_max_m_s),
        float(limits.climb_max_m_s),
        float(limits.descent_max_m_s),
        float(limits.acceleration_max_m_s2),
        float(limits.vertical_acceleration_max_m_s2),
        float(limits.jerk_max_m_s3),
        float(limits.vertical_jerk_max_m_s3),
    )
    if not (math.isfinite(sum(values)) and min(values) > 0.0):
        raise ValueError(f"the drone's limits must be positive: {limits}")
    return values


def leaning_of(request: PlanRequest) -> tuple[float, float, float, float]:
    """Return the leaning as the compiled calls take it: its two norms, then what holds against the air, in W."""
    leaning = request.leaning
    if leaning is None:
        return float(request.limits.acceleration_max_m_s2), math.inf, 0.0, 0.0
    x, y = leaning.holds_enu_m_s2.tolist()
    return float(leaning.path_max_m_s2), float(leaning.most_m_s2), x, y


def is_finite_state(state: ReferenceState) -> bool:
    """Return whether all nine numbers are finite."""
    rows = (state.position_enu_m, state.velocity_enu_m_s, state.acceleration_enu_m_s2)
    return math.isfinite(sum([sum(row.tolist()) for row in rows]))


def has_finite_target(request: PlanRequest) -> bool:
    """Return whether target and floor are finite throughout."""
    target = request.target
    path = (target.position_enu_m, target.velocity_enu_m_s, target.acceleration_enu_m_s2)
    return are_finite(*path, request.floor_enu_m, target.offset_s)


def are_finite(*arrays: Array) -> bool:
    """Return whether all numbers of all arrays are finite, none beyond 1e150: their squares are summed, in no time."""
    for array in arrays:  # noqa: SIM110 (a generator would take longer than the sums)
        if not math.isfinite(np.vdot(array, array)):
            return False
    return True
