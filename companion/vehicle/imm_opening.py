"""Opens the turning models to data that contradict what they hold for certain; states as in `imm_kernels`."""

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_swing import MOUNT, ROLL, ROLL_RATE, SIZE, antenna_swing

PLACE = np.array([0, 1, 8])  # indices of the position
OFFSET = np.array([12, 13, 14])
TILT, DECK = np.arange(ROLL, MOUNT), np.arange(ROLL, SIZE)
_RATE = np.array([2, 3, 10])  # what the velocity of the antenna has beside its swing

IndexArray = NDArray[np.intp]


def open_states(modes: Modes, indices: IndexArray, variances: Array) -> Modes:
    """Return both modes with `variances` (n,) more of the states at `indices` (n,)."""
    means, covariances, weights = modes
    opened = covariances.copy()
    opened[:, indices, indices] += variances
    return means, opened, weights


def open_place_and_offset(covariances: Array, step: Array) -> Array:
    """Return `covariances` (2, 24, 24) with `step` (3, 3), m^2, more of place and offset as one unknown."""
    moved = covariances.copy()
    for rows in (PLACE, OFFSET):
        for columns in (PLACE, OFFSET):
            moved[:, rows[:, None], columns] += step
    return moved


def open_deck(modes: Modes, lever_m: Array, variances: Array) -> Modes:
    """Return both modes with `variances` (6,) of the deck's states, which nothing was known of.

    Where the antenna is and how fast stays as it was known: a part of it becomes that of the swing.

    Args:
        modes: the filter.
        lever_m: (4,) as `imm_swing.antenna_swing` takes it.
        variances: of `DECK`.
    """
    means, covariances, weights = modes
    swung = np.zeros((SIZE, len(DECK)))
    swung[DECK, np.arange(len(DECK))] = 1.0
    for first, moved in ((ROLL, PLACE), (ROLL_RATE, _RATE)):
        swung[moved] -= antenna_swing(weights @ means, first, lever_m)[1][:, DECK]
    return means, covariances + swung @ (variances[:, None] * swung.T), weights
