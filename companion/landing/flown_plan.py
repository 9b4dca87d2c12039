"""A plan as it is flown: where the virtual model is at any time after it was made; pure numerics.

A step comes when the drone has reported, over a link that loses and delays 0.02 to 0.04 s after the one before. The
model goes on along its plan for as long as that was. Steps of a fixed period instead would change its acceleration by
less than was planned (0.65 of it on such a link), and a plan of limited jerk would then swing about what it follows.
"""

import numpy as np
from msgspec import Struct

from companion.core.data import Array
from companion.planning.guidance import PlanResult, ReferenceState, Trajectory
from link.records import replace


class FlownPlan(Struct, frozen=True, kw_only=True, eq=False):
    """A plan, and how low what is asked for by it may end.

    Attributes:
        trajectory: of the virtual model, from where it was when the plan was made.
        lowest_enu_m: height in W above which a setpoint that is carried on has to end; None where none has to.
    """

    trajectory: Trajectory
    lowest_enu_m: float | None


def flown_plan(plan: PlanResult, period_s: float, lowest_enu_m: float | None) -> FlownPlan:
    """Return the plan as it is flown: its next state, `period_s` after it was made, is one of its instants."""
    path, following = plan.trajectory, plan.next_state
    later = int(path.offset_s.searchsorted(period_s, side="right"))
    trajectory = Trajectory(
        offset_s=np.concatenate((path.offset_s[:1], [period_s], path.offset_s[later:])),
        position_enu_m=_through(path.position_enu_m, following.position_enu_m, later),
        velocity_enu_m_s=_through(path.velocity_enu_m_s, following.velocity_enu_m_s, later),
        acceleration_enu_m_s2=_through(path.acceleration_enu_m_s2, following.acceleration_enu_m_s2, later),
    )
    return FlownPlan(trajectory=trajectory, lowest_enu_m=lowest_enu_m)


def _through(path: Array, following: Array, later: int) -> Array:
    return np.concatenate((path[:1], following[np.newaxis], path[later:]))


def state_at(trajectory: Trajectory, offset_s: float) -> ReferenceState:
    """Return the model `offset_s` after its plan was made; between two instants of a plan the jerk is constant."""
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


def extrapolate(reference: ReferenceState, duration_s: float) -> ReferenceState:
    """Return the model `duration_s` later (or, negative, earlier) at its present acceleration."""
    velocity, acceleration = reference.velocity_enu_m_s, reference.acceleration_enu_m_s2
    return replace(
        reference,
        position_enu_m=reference.position_enu_m + (velocity + 0.5 * acceleration * duration_s) * duration_s,
        velocity_enu_m_s=velocity + acceleration * duration_s,
    )
