"""The lift-off: whether a reference asks for one, and the ramp by which the first climb grows from rest.

As PX4 does it: from the end of the spool-up on, the allowed climb rate grows linearly from zero to its limit.
"""

from dataclasses import dataclass, replace

import numpy as np

from sim_autopilot.data import Array, Reference

_RISE_ASKED_M = 0.1
"""A position setpoint this much above the drone asks for a take-off."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb:
    """A lift-off that began at `start_ns` since boot, at height `base_m` in W."""

    start_ns: int
    base_m: float


def asks_for_takeoff(reference: Reference | None, height_m: float) -> bool:
    """Return whether a drone that stands at `height_m` is to leave the ground."""
    if reference is None:
        return False
    if reference.position_enu_m is not None:
        return bool(reference.position_enu_m[2] > height_m + _RISE_ASKED_M)
    if reference.velocity_enu_m_s is not None:
        return bool(reference.velocity_enu_m_s[2] > 0.0)
    return reference.acceleration_enu_m_s2 is not None and bool(reference.acceleration_enu_m_s2[2] > 0.0)


def ramped(
    reference: Reference, climb: Climb, elapsed_s: float, rate_max_m_s: float, ramp_s: float
) -> Reference | None:
    """Return `reference` held down to the ramp, or None once the ramp is over or above it.

    Args:
        reference: what is asked for.
        climb: the lift-off.
        elapsed_s: since its start.
        rate_max_m_s: climb rate at the ramp's end.
        ramp_s: its duration.
    """
    if elapsed_s >= ramp_s:
        return None
    rate_m_s = rate_max_m_s * elapsed_s / ramp_s
    height_m = climb.base_m + 0.5 * rate_m_s * elapsed_s
    if reference.position_enu_m is None:
        velocity = reference.velocity_enu_m_s
        if velocity is None or velocity[2] <= rate_m_s:
            return None
        return replace(reference, velocity_enu_m_s=_with_up(velocity, rate_m_s))
    if reference.position_enu_m[2] <= height_m:
        return None
    velocity = np.zeros(3) if reference.velocity_enu_m_s is None else reference.velocity_enu_m_s
    return replace(
        reference,
        position_enu_m=_with_up(reference.position_enu_m, height_m),
        velocity_enu_m_s=_with_up(velocity, rate_m_s),
    )


def _with_up(vector: Array, up: float) -> Array:
    return np.array((vector[0], vector[1], up))
