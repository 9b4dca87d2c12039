"""The turning models' state between two readings: how it begins, what is known in it, and how it is opened to new data.

It is opened to data that contradict what it holds for certain: those that were rejected for too long are accepted.
Indices are those of `imm_kernels`.
"""

import math
from typing import assert_never

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from companion.config.estimation import ImmConfig, ReceiversConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.body_sway import BodySway
from companion.vehicle.deck_motion import DeckMotion
from companion.vehicle.imm_kernels import BEND, CLOCK, CURVATURE, HEADING, LEAK, UNKNOWN_HEADING_VARIANCE
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_numbers import Numbers
from companion.vehicle.imm_sensors import observe
from companion.vehicle.imm_swing import MOUNT, OWN_RATE, ROLL, SIZE, UNIT_HEADING
from companion.vehicle.spin import NO_SPIN, Spin
from companion.vehicle.steady_driving import SteadyDriving
from link.records import replace

PLACE = np.array([0, 1, 8])  # indices of the position
OFFSET = np.array([12, 13, 14])
TILT, DECK = np.arange(ROLL, MOUNT), np.arange(ROLL, OWN_RATE)

IndexArray = NDArray[np.intp]


def open_states(modes: Modes, indices: IndexArray, variances: Array) -> Modes:
    """Return all modes with `variances` (n,) more of the states at `indices` (n,)."""
    means, covariances, weights = modes
    opened = covariances.copy()
    opened[:, indices, indices] += variances
    return means, opened, weights


def without_heading(modes: Modes) -> Modes:
    """Return all modes with a heading that may be anything."""
    means, opened, weights = modes[0], modes[1].copy(), modes[2]
    opened[:, HEADING, :] = opened[:, :, HEADING] = 0.0
    opened[:, HEADING, HEADING] = UNKNOWN_HEADING_VARIANCE
    return means, opened, weights


def open_place_and_offset(covariances: Array, step: Array) -> Array:
    """Return `covariances` (n, 26, 26) with `step` (3, 3), m^2, more of place and offset as one unknown."""
    moved = covariances.copy()
    for rows in (PLACE, OFFSET):
        for columns in (PLACE, OFFSET):
            moved[:, rows[:, None], columns] += step
    return moved


KINDS = {
    Quantity.POSITION: sensors.POSITION,
    Quantity.VELOCITY: sensors.VELOCITY,
    Quantity.HEADING: sensors.HEADING,
    Quantity.YAW_RATE: sensors.YAW_RATE,
    Quantity.PAD: sensors.PAD,
    Quantity.ACCELERATION: sensors.ACCELERATION,
    Quantity.TILT: sensors.TILT,
    Quantity.SURFACE: sensors.SURFACE,
}
"""As the kernels count what is measured."""

_SETTLED_STD_M_S = 0.3  # of the speed; a receiver's velocity is as good, two fixes in a second are


class ImmState(Struct, frozen=True, kw_only=True, eq=False):
    """The filter.

    Attributes:
        modes: all, with their probabilities.
        driving: how steadily the vehicle is driven.
        fix_bias_variance_m2: the slow part of the fixes' variance.
        fix_white_variance_m2: the rest, on the worst axis.
        seen_age_s: how long ago the pad was seen, or known to be under the drone; infinite before.
        height_age_s: how long ago that or a range told how high it is for the drone; infinite before.
        turn_age_s: how long ago a sensor told the heading or the yaw rate.
        heading_bias_variance_rad2: of what a unit tells of the heading too much for long; 0 until it tells one.
        spin: how the vehicle turns on the spot.
        unmeasured_s: how long ago place or velocity was told.
        deck: how the deck swings; None until the vehicle has told its tilt.
        sway: how its body sways that does not tell its tilt; None until the vehicle is known well enough, and then.
    """

    modes: mixing.Modes
    driving: SteadyDriving
    fix_bias_variance_m2: float
    fix_white_variance_m2: float = 0.0
    seen_age_s: float = math.inf
    height_age_s: float = math.inf
    turn_age_s: float = math.inf
    heading_bias_variance_rad2: float = 0.0
    spin: Spin = NO_SPIN
    unmeasured_s: float = 0.0
    deck: DeckMotion | None = None
    sway: BodySway | None = None


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
    rates = 1.0 / numbers.begins_after_s
    n = len(rates)
    covariances = open_place_and_offset(np.stack([covariance] * n), offset_variance * np.eye(3))
    modes = (np.stack([mean] * n), covariances, rates / rates.sum())
    return ImmState(
        modes=modes,
        driving=SteadyDriving(),
        fix_bias_variance_m2=bias_variance,
        fix_white_variance_m2=largest(white) if is_fix else 0.0,
        seen_age_s=math.inf if is_fix else 0.0,
        height_age_s=math.inf if is_fix else 0.0,
    )


def split_fix(covariance: Array, receivers: ReceiversConfig) -> tuple[Array, float]:
    """Return a fix's `covariance` (3, 3), m^2, as its white part (3, 3) and the variance of the slow rest, m^2."""
    stated = largest(covariance)
    white = min(stated, receivers.fix_white_std_max_m**2)
    return covariance * (white / stated), stated - white


def largest(covariance: Array) -> float:
    """Return the variance on the worst axis."""
    return float(covariance.diagonal().max())


def is_heading_known(state: ImmState, config: ImmConfig) -> bool:
    """Return whether the heading is told; while it is not, the kernels leave the lever arm out."""
    return bool(mixing.is_heading_known(state.modes, config.heading.known_std_rad**2))


def has_settled(state: ImmState, config: ImmConfig) -> bool:
    """Return whether the first fixes are in: what a vehicle of any speed does would be learnt about its tilt, too.

    What is known is what all models say together: a brake that may have begun since the last fix is always in doubt.
    """
    _, covariance = mixing.combine(*state.modes)
    return is_heading_known(state, config) and covariance[2, 2] + covariance[3, 3] < _SETTLED_STD_M_S**2


def seen_axes(state: ImmState, receivers: ReceiversConfig) -> NDArray[np.bool_]:
    """Return on which axes of W (3,) the place is known better than the fixes alone could tell it."""
    _, covariances, weights = state.modes
    variances = weights @ covariances[:, PLACE, PLACE]
    return np.asarray(variances < 0.25 * (receivers.frame_offset_std_m**2 + state.fix_bias_variance_m2))


_TOLD_BY = {  # the states that a quantity tells
    Quantity.VELOCITY: np.array([2, 3, 4, 5, 9, 10, 11, BEND]),
    Quantity.HEADING: np.array([HEADING]),
    Quantity.YAW_RATE: np.array([CURVATURE]),
    Quantity.ACCELERATION: np.array([LEAK]),
    Quantity.TILT: DECK,  # a unit that was moved on its mount contradicts, too
}


def recover(
    state: ImmState, measurement: Measurement, config: ImmConfig, numbers: Numbers, placed_by: Quantity
) -> ImmState:
    """Return the state with that opened which `measurement` contradicts.

    A sighting that contradicts everything means that the drone's frame has stepped: place and offset move
    together. A fix that does is the receiver's step if the place is known from sightings, else a new start, as is
    a sighting where nothing else places the vehicle. A surface that does may be of anything, and opens nothing.

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
            if seen_axes(state, config.receivers)[:2].all():
                step_m = _step_size_m(state, measurement, config.receivers, numbers)
                return replace(state, modes=open_states(state.modes, OFFSET, np.full(3, step_m**2)))
            return _restart(state, measurement, config, numbers)
        case Quantity.VELOCITY | Quantity.HEADING | Quantity.YAW_RATE | Quantity.ACCELERATION | Quantity.TILT:
            told = _TOLD_BY[measurement.quantity]
            return replace(state, modes=open_states(state.modes, told, numbers.prior_variances[told]))
        case Quantity.SURFACE | Quantity.FRAME_STEP:
            return state
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
    """Restart at `place`, but for offset, heading, clock, unit and deck."""
    x, P = mixing.combine(*state.modes)
    means, covariances, weights = start_state(place, config, numbers).modes
    means[:, PLACE] += x[OFFSET]
    means[:, OFFSET] = x[OFFSET]
    for kept in (HEADING, CLOCK, UNIT_HEADING, *DECK):
        means[:, kept], covariances[:, kept, kept] = x[kept], P[kept, kept]
    age_s = 0.0 if place.quantity is Quantity.PAD else math.inf
    return replace(state, modes=(means, covariances, weights), seen_age_s=age_s, height_age_s=age_s)
