"""Opens the turning models to data that contradict what they hold for certain; states as in `imm_kernels`."""

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array
from companion.vehicle.imm_mixing import Modes

PLACE = np.array([0, 1, 8])  # indices of the position
OFFSET = np.array([12, 13, 14])

IndexArray = NDArray[np.intp]


def open_states(modes: Modes, indices: IndexArray, variances: Array) -> Modes:
    """Return both modes with `variances` (n,) more of the states at `indices` (n,)."""
    means, covariances, weights = modes
    opened = covariances.copy()
    opened[:, indices, indices] += variances
    return means, opened, weights


def open_place_and_offset(covariances: Array, step: Array) -> Array:
    """Return `covariances` (2, 18, 18) with `step` (3, 3), m^2, more of place and offset as one unknown."""
    moved = covariances.copy()
    for rows in (PLACE, OFFSET):
        for columns in (PLACE, OFFSET):
            moved[:, rows[:, None], columns] += step
    return moved
