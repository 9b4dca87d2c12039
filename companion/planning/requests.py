"""Checks of what a guidance law is asked, the same for all laws."""

import math
from dataclasses import replace

from companion.planning.guidance import PlanRequest, ReferenceState


def with_finite_state(last: ReferenceState | None, request: PlanRequest) -> PlanRequest:
    """Return `request`, its state replaced by the `last` planned one where it is not finite.

    Raises:
        ValueError: if the state is not finite and there is no last one, or `dt_s` is not positive.
    """
    if not request.dt_s > 0.0:
        raise ValueError(f"the control period must be positive, not {request.dt_s} s")
    if is_finite_state(request.state):
        return request
    if last is None:
        raise ValueError(f"the first reference state is not finite: {request.state}")
    return replace(request, state=last)


def is_finite_state(state: ReferenceState) -> bool:
    """Return whether all nine numbers are finite."""
    total = state.position_enu_m.sum() + state.velocity_enu_m_s.sum() + state.acceleration_enu_m_s2.sum()
    return math.isfinite(total)


def has_finite_target(request: PlanRequest) -> bool:
    """Return whether target and floor are finite throughout."""
    target = request.target
    total = target.position_enu_m.sum() + target.velocity_enu_m_s.sum() + target.acceleration_enu_m_s2.sum()
    return math.isfinite(total + request.floor_enu_m.sum() + target.offset_s.sum())
