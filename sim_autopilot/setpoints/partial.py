"""Setpoints that leave axes free, as PX4 takes them: north and east together, down by itself.

Each of the two needs a position, a velocity or an acceleration. An axis without a position is not held anywhere, one
with an acceleration alone has no velocity to keep to either: there the drone's own place and velocity stand in.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from link.records import replace
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.plant.snapshot import Snapshot

_POSITION, _VELOCITY, _ACCELERATION = 0, 3, 6
Axes = tuple[bool, bool, bool]
"""In W; the first two are alike."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Given:
    """What a type mask gives of position, velocity and acceleration: on the level, and upwards."""

    position: Axes
    velocity: Axes
    acceleration: Axes

    @property
    def free_position(self) -> Axes:
        """The axes without a position, where another axis has one."""
        return _unless(self.position, among=any(self.position))

    @property
    def free_velocity(self) -> Axes:
        """The axes with neither place nor velocity, where another axis has one of them."""
        either = _either(self.position, self.velocity)
        return _unless(either, among=any(either))


@lru_cache(maxsize=16)  # a companion's masks are the same all the time
def read_mask(mask: int) -> Given | None:
    """Return what the type mask of a SET_POSITION_TARGET gives, None where PX4 does not fly it."""
    position, velocity, acceleration = (_group(mask, bit) for bit in (_POSITION, _VELOCITY, _ACCELERATION))
    if position is None or velocity is None or acceleration is None:
        return None
    if not all(_either(_either(position, velocity), acceleration)):
        return None
    return Given(position=position, velocity=velocity, acceleration=acceleration)


def with_own_motion(reference: Reference, now: Snapshot) -> Reference:
    """Return `reference` with the drone's own place and velocity on its free axes."""
    if not any(reference.free_position) and not any(reference.free_velocity):
        return reference
    return replace(
        reference,
        position_enu_m=_fill(reference.position_enu_m, reference.free_position, now.position_enu_m),
        velocity_enu_m_s=_fill(reference.velocity_enu_m_s, reference.free_velocity, now.velocity_enu_m_s),
    )


def _group(mask: int, first_bit: int) -> Axes | None:
    x, y, z = (not mask >> (first_bit + axis) & 1 for axis in range(3))
    return (x, y, z) if x is y else None


def _either(one: Axes, other: Axes) -> Axes:
    return one[0] or other[0], one[1] or other[1], one[2] or other[2]


def _unless(axes: Axes, *, among: bool) -> Axes:
    return (not axes[0], not axes[1], not axes[2]) if among else (False, False, False)


def _fill(vector: Array | None, free: Axes, own: tuple[float, float, float]) -> Array | None:
    if not any(free):
        return vector
    return np.where(free, own, np.zeros(3) if vector is None else vector)
