"""Resampling of a target onto the nodes of a horizon by constant weights.

Positions are cubic Hermite in position and velocity, velocities cubic Hermite in velocity and acceleration,
accelerations linear. After the last sample the target goes on at its last velocity.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel
from companion.planning.guidance import Target

VALUE, SLOPE, SLOPE_ENDING, LINEAR, LINEAR_ENDING = range(5)
"""Weights of a sampled value and of a sampled derivative (s) in an interpolated value, and of a linear interpolation;
those that are ending are zero after the last sample."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Resampler:
    """Maps n samples to k nodes, each from the two samples around it.

    Attributes:
        samples: n.
        left: (k,) the place of the earlier sample.
        weights: (5, k, 2) of the two samples, by kind: `VALUE` and so on. NaN where an offset is not finite, so that
            nothing made with them is finite either.
    """

    samples: int
    left: NDArray[np.int64]
    weights: Array

    def taken(self, target: Target) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration (n, 3) as compiled functions take them: no index is checked there.

        They are laid out in one piece, since any other layout would be compiled for when it first comes, in flight.

        Raises:
            ValueError: if they are not one for each offset.
        """
        rows = (target.position_enu_m, target.velocity_enu_m_s, target.acceleration_enu_m_s2)
        for row in rows:
            if row.shape != (self.samples, 3):
                raise ValueError(f"a target of {self.samples} offsets has rows of shape {row.shape}")
        position, velocity, acceleration = rows
        return np.ascontiguousarray(position), np.ascontiguousarray(velocity), np.ascontiguousarray(acceleration)

    def taken_line(self, samples: Array) -> Array:
        """Return `samples` (n,) as compiled functions take them, in one piece: no index is checked there.

        Raises:
            ValueError: if they are not one for each offset.
        """
        if samples.shape != (self.samples,):
            raise ValueError(f"a target of {self.samples} offsets has samples of shape {samples.shape}")
        return np.ascontiguousarray(samples)

    def apply(self, target: Target) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration (k, 3) of `target` at the nodes."""
        resampled = resampled_path(self.taken(target), self.left, self.weights)
        return resampled[0], resampled[1], resampled[2]

    def line(self, samples: Array) -> Array:
        """Return `samples` (n,) at the nodes (k,), linear, and after the last one as that."""
        return resampled_line(self.taken_line(samples), self.left, self.weights)


@compiled_kernel
def resampled_path(path: tuple[Array, Array, Array], left: NDArray[np.int64], weights: Array) -> Array:
    """Return position, velocity and acceleration (3, k, 3) of samples (n, 3) at the nodes of a `Resampler`."""
    position, velocity, acceleration = path
    resampled = np.zeros((3, len(left), 3))
    for node in range(len(left)):
        for side in range(2):
            sample = min(left[node] + side, len(position) - 1)
            value, slope = weights[VALUE, node, side], weights[SLOPE, node, side]
            slope_ending, linear_ending = weights[SLOPE_ENDING, node, side], weights[LINEAR_ENDING, node, side]
            for axis in range(3):
                p, v, a = position[sample, axis], velocity[sample, axis], acceleration[sample, axis]
                resampled[0, node, axis] += value * p + slope * v
                resampled[1, node, axis] += value * v + slope_ending * a
                resampled[2, node, axis] += linear_ending * a
    return resampled


@compiled_kernel
def resampled_line(samples: Array, left: NDArray[np.int64], weights: Array) -> Array:
    """Return `samples` (n,) at the nodes (k,) of a `Resampler`, linear, and after the last one as that."""
    resampled = np.empty(len(left))
    last = len(samples) - 1
    for node in range(len(left)):
        linear = weights[LINEAR, node]
        resampled[node] = linear[0] * samples[left[node]] + linear[1] * samples[min(left[node] + 1, last)]
    return resampled


def make_resampler(offset_s: Array, node_s: Array) -> Resampler:
    """Return the weights from samples at `offset_s` (n,), rising, to nodes at `node_s` (k,), clamped to the first one.

    Raises:
        ValueError: if there is no offset, or they do not rise.
    """
    return _resampler(offset_s.tobytes(), node_s.tobytes())


@lru_cache(maxsize=64)
def _resampler(offset_bytes: bytes, node_bytes: bytes) -> Resampler:
    """Return the resampler of two arrays' bytes, which are found again in a third of the time that numbers need."""
    offsets, nodes = np.frombuffer(offset_bytes), np.frombuffer(node_bytes)
    if not np.isfinite(offsets).all():
        nowhere = np.zeros(nodes.size, dtype=np.int64)
        return Resampler(samples=offsets.size, left=nowhere, weights=np.full((5, nodes.size, 2), np.nan))
    if not offsets.size or (np.diff(offsets) <= 0.0).any():
        raise ValueError(f"the target's offsets must rise: {offsets.tolist()}")
    left = np.clip(np.searchsorted(offsets, nodes, side="right") - 1, 0, max(offsets.size - 2, 0))
    step = np.diff(offsets, append=offsets[-1] + 1.0)[left]
    s = np.clip((nodes - offsets[left]) / step, 0.0, float(offsets.size > 1))
    weights = np.empty((5, nodes.size, 2))
    weights[VALUE] = np.stack(((1.0 + 2.0 * s) * (1.0 - s) ** 2, s**2 * (3.0 - 2.0 * s)), axis=1)
    weights[SLOPE] = np.stack((s * (1.0 - s) ** 2 * step, s**2 * (s - 1.0) * step), axis=1)
    weights[LINEAR] = np.stack((1.0 - s, s), axis=1)
    beyond = nodes > offsets[-1] + 1e-9
    weights[SLOPE, beyond] = 0.0
    weights[SLOPE_ENDING], weights[LINEAR_ENDING] = weights[SLOPE], weights[LINEAR]
    weights[LINEAR_ENDING, beyond] = 0.0
    last = int(offsets.size > 1)  # the place of the last sample of two
    weights[SLOPE, beyond, last] = nodes[beyond] - offsets[-1]
    return Resampler(samples=offsets.size, left=left.astype(np.int64), weights=weights)
