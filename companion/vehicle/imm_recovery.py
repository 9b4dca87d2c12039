"""Widens states of the turning models for data that were rejected for too long and are now accepted."""

from typing import assert_never

import numpy as np

from companion.config.estimation import ImmConfig, ReceiversConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle import imm_kernels as kernels
from companion.vehicle import imm_mixing as mixing
from companion.vehicle.imm_numbers import Numbers
from companion.vehicle.imm_opening import DECK, OFFSET, PLACE, open_place_and_offset, open_states
from companion.vehicle.imm_sensors import observe
from companion.vehicle.imm_state import KINDS, ImmState, is_placed_by_sightings, start_state
from link.records import replace

_CURVATURE, _HEADING = 6, 7
_TOLD_BY = {  # the states that a quantity tells
    Quantity.VELOCITY: np.array([2, 3, 4, 5, 9, 11, kernels.BEND]),
    Quantity.HEADING: np.array([_HEADING]),
    Quantity.YAW_RATE: np.array([_CURVATURE]),
    Quantity.ACCELERATION: np.array([kernels.LEAK]),
    Quantity.TILT: DECK,  # a unit that was moved on its mount contradicts, too
}


def recover(
    state: ImmState, measurement: Measurement, config: ImmConfig, numbers: Numbers, placed_by: Quantity
) -> ImmState:
    """Return the state with that opened which `measurement` contradicts.

    A sighting that contradicts everything means that the drone's frame has stepped: place and offset move
    together. A fix that does is the receiver's step if the place is known from sightings, else a new start, as is
    a sighting where nothing else places the vehicle.

    Args:
        state: that rejects it.
        measurement: in W.
        config: of the filter.
        numbers: the same as the kernels take them.
        placed_by: what the filter starts on.
    """
    match measurement.quantity:
        case Quantity.PAD:
            if placed_by is Quantity.PAD:
                return _restart(state, measurement, config, numbers)
            return _move_frame(state, measurement, config.receivers, numbers)
        case Quantity.POSITION:
            if is_placed_by_sightings(state, config.receivers):
                step_m = _step_size_m(state, measurement, config.receivers, numbers)
                return replace(state, modes=open_states(state.modes, OFFSET, np.full(3, step_m**2)))
            return _restart(state, measurement, config, numbers)
        case Quantity.VELOCITY | Quantity.HEADING | Quantity.YAW_RATE | Quantity.ACCELERATION | Quantity.TILT:
            told = _TOLD_BY[measurement.quantity]
            return replace(state, modes=open_states(state.modes, told, numbers.prior_variances[told]))
        case _:
            assert_never(measurement.quantity)


def _step_size_m(state: ImmState, measurement: Measurement, receivers: ReceiversConfig, numbers: Numbers) -> float:
    """Return how far a measured place is from the expected one; at least the prior of the offset."""
    means, _, weights = state.modes
    expected, _ = observe(KINDS[measurement.quantity], weights @ means, numbers.lever_m, False)
    return max(float(np.linalg.norm(measurement.value - expected)), receivers.frame_offset_std_m)


def _move_frame(state: ImmState, sighting: Measurement, receivers: ReceiversConfig, numbers: Numbers) -> ImmState:
    """Open place and offset as one unknown."""
    step = _step_size_m(state, sighting, receivers, numbers) ** 2 * np.eye(3)
    means, covariances, weights = state.modes
    return replace(state, modes=(means, open_place_and_offset(covariances, step), weights))


def _restart(state: ImmState, place: Measurement, config: ImmConfig, numbers: Numbers) -> ImmState:
    """Restart at `place`, but for offset, heading, clock and deck."""
    x, P = mixing.combine(*state.modes)
    means, covariances, weights = start_state(place, config, numbers).modes
    means[:, PLACE] += x[OFFSET]
    means[:, OFFSET] = x[OFFSET]
    for kept in (_HEADING, kernels.CLOCK, *DECK):
        means[:, kept], covariances[:, kept, kept] = x[kept], P[kept, kept]
    return replace(state, modes=(means, covariances, weights))
