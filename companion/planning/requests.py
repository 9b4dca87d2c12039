"""Checks of what a guidance law is asked, the same for all laws."""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.guidance import PlanRequest, ReferenceState
from link.records import replace


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
