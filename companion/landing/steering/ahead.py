"""A setpoint takes effect a moment after its step, and there its plan begins; pure numerics.

Until then the drone follows what was sent before. A model that turned at once would be ahead of what the drone is told,
and its plans would make up for a deviation that they caused: behind a link of 0.1 s a drone swung by 0.3 m/s.
"""

import numpy as np

from companion.autopilots.response import ResponseModel
from companion.core.data import Array
from companion.landing.steering.flown_plan import FlownPlan, state_at
from companion.landing.steering.targets import HORIZON_OFFSETS_S, Aim
from companion.landing.steering.virtual_model import BREAK_S, Tracking, add_to_past, state_then
from companion.planning.guidance import ReferenceState, Target
from link.records import replace


def model_along(
    plan: FlownPlan, tracking: Tracking, monotonic_ns: int, starts_ns: int, elapsed_s: float
) -> tuple[ReferenceState, ReferenceState]:
    """Return the virtual model now, and where the next plan begins.

    Args:
        plan: the newest.
        tracking: with the model up to where that leads.
        monotonic_ns: now.
        starts_ns: when the next setpoint takes effect.
        elapsed_s: from the plan's beginning to then; negative where a link has become quicker.
    """
    start = state_at(plan, elapsed_s) if elapsed_s >= 0.0 else state_then(tracking, starts_ns)
    return state_then(add_to_past(tracking, starts_ns, start), monotonic_ns), start


def shift_aim(aim: Aim, by_s: float) -> Aim:
    """Return the aim with its offsets counted from `by_s` later on.

    Between two offsets it follows the cubic of place and velocity; beyond the last one it goes on as it moves there.
    """
    before, spacing_s = aim.target, HORIZON_OFFSETS_S[1]
    whole = int(by_s / spacing_s)
    share = by_s / spacing_s - whole
    velocity = _extended(before.velocity_enu_m_s, whole)
    onwards_m = np.outer(spacing_s * np.arange(1, whole + 2), velocity[-1])
    place = np.vstack((before.position_enu_m, before.position_enu_m[-1] + onwards_m))[whole:]
    moved, (start, end) = np.diff(place, axis=0), (spacing_s * velocity[:-1], spacing_s * velocity[1:])
    bows = (1.0 - share) * (start - moved) - share * (end - moved)
    target = replace(
        before,
        position_enu_m=place[:-1] + share * moved + share * (1.0 - share) * bows,
        velocity_enu_m_s=_between(velocity, share),
        acceleration_enu_m_s2=_between(_extended(before.acceleration_enu_m_s2, whole), share),
    )
    touched = aim.touched_enu_m
    return replace(
        aim,
        target=target,
        floor_enu_m=_between(_extended(aim.floor_enu_m, whole), share),
        touched_enu_m=None if touched is None else _between(_extended(touched, whole), share),
    )


def _extended(values: Array, whole: int) -> Array:
    """Return values (n + 1, ...) of the offsets from `whole` on, the last one kept."""
    return np.concatenate((values[whole:], np.repeat(values[-1:], whole + 1, axis=0)))


def _between(values: Array, share: float) -> Array:
    return np.asarray(values[:-1] + share * (values[1:] - values[:-1]))


def make_up(
    target: Target,
    start: ReferenceState,
    tracking: Tracking,
    response: ResponseModel,
    *,
    late_s: float,
    ahead_s: float,
    planner_foresees: bool = True,
) -> Target:
    """Return where the virtual model is wanted, so that the drone, which will be off it, is where the target is.

    The drone's deviation is foreseen for a model that goes on with the acceleration that it begins with: what its moves
    add to that is the planner's to foresee (`PlanRequest.following`). For one that does not, the model goes the
    target's way: foreseen along the last plan, each plan would make up for what the one before it was going to.

    Args:
        target: of the drone.
        start: the model at the target's first offset, where the plan begins.
        tracking: with the deviation at the time of the newest report.
        response: of the autopilot.
        late_s: since that report.
        ahead_s: from now to the target's first offset.
        planner_foresees: as said above.
    """
    accelerates = start.acceleration_enu_m_s2[:2]
    then = response.carry(tracking.deviation, accelerates, min(late_s, BREAK_S) + ahead_s)
    way = np.tile(accelerates, (len(target.offset_s), 1)) if planner_foresees else target.acceleration_enu_m_s2[:, :2]
    deviation = response.predict(then, way)[:, :2]
    position, velocity = target.position_enu_m.copy(), target.velocity_enu_m_s.copy()
    position[:, :2] -= deviation[:, 0]
    velocity[:, :2] -= deviation[:, 1]
    return replace(target, position_enu_m=position, velocity_enu_m_s=velocity)
