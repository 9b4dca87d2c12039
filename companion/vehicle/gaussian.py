"""A Gaussian belief and the little algebra that all filters share."""

import math
from dataclasses import dataclass

import numpy as np

from companion.core.data import Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gaussian:
    """Mean `(n,)` and covariance `(n, n)`; which states and units, each filter says."""

    mean: Array
    covariance: Array


def symmetric(matrix: Array) -> Array:
    """Return the symmetric part of `(n, n)`, which rounding takes away."""
    return 0.5 * (matrix + matrix.T)


def squared_norm(innovation: Array, covariance: Array) -> float:
    """Return the normalised innovation squared, NIS, of `(m,)` with covariance `(m, m)`."""
    return float(innovation @ np.linalg.solve(covariance, innovation))


def wrapped(angle_rad: float) -> float:
    """Return the angle in [-pi, pi)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi
