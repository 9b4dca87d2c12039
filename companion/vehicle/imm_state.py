"""The turning models' state between two readings: how it begins, and what is known in it.

Indices are those of `imm_kernels`.
"""

import math

import numpy as np
from msgspec import Struct

from companion.config.estimation import ImmConfig, ReceiversConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.deck_motion import DeckMotion
from companion.vehicle.imm_kernels import CLOCK
from companion.vehicle.imm_numbers import Numbers
from companion.vehicle.imm_opening import DECK, PLACE, open_place_and_offset
from companion.vehicle.imm_swing import SIZE

KINDS = {
    Quantity.POSITION: sensors.POSITION,
    Quantity.VELOCITY: sensors.VELOCITY,
    Quantity.HEADING: sensors.HEADING,
    Quantity.YAW_RATE: sensors.YAW_RATE,
    Quantity.PAD: sensors.PAD,
    Quantity.ACCELERATION: sensors.ACCELERATION,
    Quantity.TILT: sensors.TILT,
}
"""As the kernels count what is measured."""

_SETTLED_STD_M_S = 0.3  # of the speed; a receiver's velocity is as good, two fixes in a second are


class ImmState(Struct, frozen=True, kw_only=True, eq=False):
    """The filter.

    Attributes:
        modes: both.
        fix_bias_variance_m2: the slow part of the fixes' variance.
        turn_age_s: how long ago a sensor told the heading or the yaw rate.
        unmeasured_s: how long ago place or velocity was told.
        deck: how the deck swings; None until the vehicle has told its tilt.
    """

    modes: mixing.Modes
    fix_bias_variance_m2: float
    turn_age_s: float = math.inf
    unmeasured_s: float = 0.0
    deck: DeckMotion | None = None


def start_state(place: Measurement, config: ImmConfig, numbers: Numbers) -> ImmState:
    """Return the state after a first place: anything may be true of the rest.

    A sighting is in the drone's own frame and dated by its clock, so that it leaves nothing between the two.

    Args:
        place: a fix, or a sighting.
        config: of the filter.
        numbers: the same as the kernels take them.
    """
    is_fix = place.quantity is Quantity.POSITION
    white, bias_variance = split_fix(place.covariance, config.receivers) if is_fix else (place.covariance, 0.0)
    offset_variance = config.receivers.frame_offset_std_m**2 + bias_variance if is_fix else 0.0
    mean = np.zeros(SIZE)
    mean[PLACE] = place.value
    covariance = np.diag(numbers.prior_variances)
    covariance[DECK, DECK] = 0.0
    covariance[np.ix_(PLACE, PLACE)] = white
    covariance[CLOCK, CLOCK] = config.receivers.clock_std_s**2 if bias_variance else 0.0
    covariances = open_place_and_offset(np.stack([covariance, covariance]), offset_variance * np.eye(3))
    modes = (np.stack([mean, mean]), covariances, numbers.dwell_s / numbers.dwell_s.sum())
    return ImmState(modes=modes, fix_bias_variance_m2=bias_variance)


def split_fix(covariance: Array, receivers: ReceiversConfig) -> tuple[Array, float]:
    """Return a fix's `covariance` (3, 3), m^2, as its white part (3, 3) and the variance of the slow rest, m^2."""
    stated = float(covariance.diagonal().max())
    white = min(stated, receivers.fix_white_std_max_m**2)
    return covariance * (white / stated), stated - white


def is_heading_known(state: ImmState, config: ImmConfig) -> bool:
    """Return whether the heading is told; while it is not, the kernels leave the lever arm out."""
    return bool(mixing.is_heading_known(state.modes, config.heading.known_std_rad**2))


def has_settled(state: ImmState, config: ImmConfig) -> bool:
    """Return whether the first fixes are in: what a vehicle of any speed does would be learnt about its tilt, too."""
    _, covariances, _ = state.modes
    speed_variance = float((covariances[:, 2, 2] + covariances[:, 3, 3]).max())
    return is_heading_known(state, config) and speed_variance < _SETTLED_STD_M_S**2


def is_placed_by_sightings(state: ImmState, receivers: ReceiversConfig) -> bool:
    """Return whether the place is known better than the fixes alone could tell it in the drone's frame."""
    _, covariances, weights = state.modes
    variance = float(weights @ covariances[:, 0, 0])
    return variance < 0.25 * (receivers.frame_offset_std_m**2 + state.fix_bias_variance_m2)
