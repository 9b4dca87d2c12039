"""Resampling of a target onto the nodes of a horizon by constant matrices.

Positions are cubic Hermite in position and velocity, velocities cubic Hermite in velocity and acceleration,
accelerations linear. After the last sample the target goes on at its last velocity.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from companion.data import Array
from companion.planning.guidance import Target


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Resampler:
    """Maps (k, n) from n samples to k nodes.

    Attributes:
        value: weight of a sampled value in an interpolated value.
        slope: weight of a sampled derivative in an interpolated value, s.
        slope_ending: the same, but zero after the last sample.
        linear: linear interpolation, constant after the last sample.
        linear_ending: the same, but zero after the last sample.
    """

    value: Array
    slope: Array
    slope_ending: Array
    linear: Array
    linear_ending: Array

    def apply(self, target: Target) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration (k, 3) of `target` at the nodes."""
        velocity, acceleration = target.velocity_enu_m_s, target.acceleration_enu_m_s2
        return (
            self.value @ target.position_enu_m + self.slope @ velocity,
            self.value @ velocity + self.slope_ending @ acceleration,
            self.linear_ending @ acceleration,
        )


@lru_cache(maxsize=64)
def make_resampler(offset_s: tuple[float, ...], node_s: tuple[float, ...]) -> Resampler:
    """Return the maps from samples at `offset_s`, rising, to nodes at `node_s`; nodes before the first are clamped.

    Raises:
        ValueError: if there is no offset, or they do not rise.
    """
    offsets, nodes = np.array(offset_s), np.array(node_s)
    if not offsets.size or (np.diff(offsets) <= 0.0).any():
        raise ValueError(f"the target's offsets must rise: {offset_s}")
    linear = np.stack([np.interp(nodes, offsets, unit) for unit in np.eye(offsets.size)], axis=1)
    value, slope = _hermite(offsets, nodes)
    beyond = nodes > offsets[-1] + 1e-9
    value[beyond], slope[beyond] = 0.0, 0.0
    value[beyond, -1] = 1.0
    slope_ending = slope.copy()
    slope[beyond, -1] = nodes[beyond] - offsets[-1]
    return Resampler(
        value=value,
        slope=slope,
        slope_ending=slope_ending,
        linear=linear,
        linear_ending=np.where(beyond[:, None], 0.0, linear),
    )


def _hermite(offsets: Array, nodes: Array) -> tuple[Array, Array]:
    """Return the cubic Hermite weights of values and of derivatives, each (k, n)."""
    value, slope = np.zeros((nodes.size, offsets.size)), np.zeros((nodes.size, offsets.size))
    rows = np.arange(nodes.size)
    if offsets.size == 1:
        value[:, 0] = 1.0
        return value, slope
    left = np.clip(np.searchsorted(offsets, nodes, side="right") - 1, 0, offsets.size - 2)
    step = offsets[left + 1] - offsets[left]
    s = np.clip((nodes - offsets[left]) / step, 0.0, 1.0)
    value[rows, left] = (1.0 + 2.0 * s) * (1.0 - s) ** 2
    value[rows, left + 1] = s**2 * (3.0 - 2.0 * s)
    slope[rows, left] = s * (1.0 - s) ** 2 * step
    slope[rows, left + 1] = s**2 * (s - 1.0) * step
    return value, slope
