"""The one interface of all guidance laws: from a target over a horizon to the next setpoint of a virtual model.

The virtual model is a point mass whose position, velocity and acceleration are what the autopilot is asked to
follow. SI units, world ENU (W). A law is a pure function over its own immutable memory.
"""

from enum import Enum
from typing import NewType, Protocol

from msgspec import Struct

from companion.core.data import Array, FlightLimits


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


class PlanRequest(Struct, frozen=True, kw_only=True, eq=False):
    """What a guidance law plans from.

    Attributes:
        state: the virtual model now.
        target: where it is wanted.
        limits: what may be asked of the drone.
        floor_enu_m: (n,) lowest allowed height in W at the target's offsets.
        dt_s: control period, after which the next plan is made.
    """

    state: ReferenceState
    target: Target
    limits: FlightLimits
    floor_enu_m: Array
    dt_s: float


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
