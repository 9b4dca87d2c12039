"""The lift-off: whether a reference asks for one, and the ramp by which the first climb grows from rest.

As PX4 does it: from the end of the spool-up on, the allowed climb rate grows linearly to its limit, and begins so far
below zero that the thrust begins at none.
"""

from dataclasses import dataclass

import numpy as np

from link.records import replace
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.physics.airframe import GRAVITY_M_S2

_RISE_ASKED_M = 0.1
"""A position setpoint this much above the drone asks for a take-off."""
_RATE_FROM_M_S = GRAVITY_M_S2 / 4.0
"""Below zero, where the ramp begins: gravity over the gain of the vertical velocity (PX4 MPC_Z_VEL_P_ACC)."""
_LIFTED_SHARE = 0.25
"""Of the ramp; PX4 was seen to report IN_AIR 0.8 s after its 3 s ramp began, 1.4 s before the drone moved."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb:
    """A lift-off that began at `start_ns` since boot, at height `base_m` in W."""

    start_ns: int
    base_m: float


def asks_for_takeoff(reference: Reference | None, height_m: float) -> bool:
    """Return whether a drone that stands at `height_m` is to leave the ground."""
    if reference is None:
        return False
    if reference.attitude is not None:
        return reference.attitude.thrust_m_s2 > GRAVITY_M_S2
    if reference.height_m is not None:
        return reference.height_m > height_m + _RISE_ASKED_M
    if reference.velocity_enu_m_s is not None:
        return bool(reference.velocity_enu_m_s[2] > 0.0)
    return reference.acceleration_enu_m_s2 is not None and bool(reference.acceleration_enu_m_s2[2] > 0.0)


def is_idle(elapsed_s: float, rate_max_m_s: float, ramp_s: float) -> bool:
    """Return whether the ramp, `elapsed_s` after its start, still holds the thrust below the weight."""
    return elapsed_s < _weight_s(rate_max_m_s, ramp_s)


def has_lifted(elapsed_s: float, ramp_s: float) -> bool:
    """Return whether the thrust has grown so far that the drone no longer counts as landed."""
    return elapsed_s >= _LIFTED_SHARE * ramp_s


def ramp(reference: Reference, climb: Climb, elapsed_s: float, rate_max_m_s: float, ramp_s: float) -> Reference | None:
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
    rising_s = max(0.0, elapsed_s - _weight_s(rate_max_m_s, ramp_s))
    rate_m_s = (rate_max_m_s + _RATE_FROM_M_S) / ramp_s * rising_s
    height_m = climb.base_m + 0.5 * rate_m_s * rising_s
    if reference.position_enu_m is None or reference.height_m is None:
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


def _weight_s(rate_max_m_s: float, ramp_s: float) -> float:
    """When the ramp crosses zero, where the thrust is the weight."""
    return ramp_s * _RATE_FROM_M_S / (rate_max_m_s + _RATE_FROM_M_S)


def _with_up(vector: Array, up: float) -> Array:
    return np.array((vector[0], vector[1], up))
