"""How the filter comes to follow the body's tilt, told or seen as its antenna's sway, and a told heading."""

import numpy as np

from companion.config.estimation import ImmConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.body_sway import BodySway, first_sway, learn_sway, sway_oscillators, sway_variances, widen_sway
from companion.vehicle.deck_motion import DeckMotion, first_motion, learn
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_numbers import Numbers, swing_of
from companion.vehicle.imm_state import DECK, PLACE, TILT, ImmState, has_settled
from companion.vehicle.imm_swing import HEAVE_RATE, ROLL, ROLL_RATE, SIZE, UNIT_HEADING, antenna_swing
from link.records import replace

MOTIONS = frozenset({Quantity.POSITION, Quantity.VELOCITY})
SWINGING = np.array([HEAVE_RATE, HEAVE_RATE + 1, *TILT])
_OTHER_UNIT = 2.0  # times the standard deviation: what a unit states scatters, too
_RATE = np.array([2, 3, HEAVE_RATE])  # what the velocity of the antenna has beside its swing


def opened_body(
    state: ImmState, measurement: Measurement, config: ImmConfig, numbers: Numbers, *, is_afloat: bool
) -> ImmState | None:
    """Return the state before `measurement`, which follows the body from then on; None if it is too early for a tilt.

    Args:
        state: so far.
        measurement: that is next.
        config: of the filter.
        numbers: the same as the kernels take them.
        is_afloat: whether the deck is a vessel's, whose tilt has to be told.
    """
    is_told = measurement.quantity is Quantity.TILT
    begins_to_sway = measurement.quantity in MOTIONS and state.sway is None and not is_afloat
    if state.deck is not None or not (is_told or begins_to_sway):
        return state
    if not has_settled(state, config):
        return None if is_told else state
    if is_told:
        return _with_told_tilt(state, measurement, first_motion(swing_of(config, is_afloat=is_afloat)), numbers)
    return _with_sway(state, config, numbers)


def learnt_body(
    state: ImmState, modes: Modes, reading: Measurement, config: ImmConfig, numbers: Numbers, *, is_afloat: bool
) -> tuple[DeckMotion | None, BodySway | None]:
    """Return what is known of the deck's swing and of the body's sway after a reading."""
    if state.deck is not None and reading.quantity is Quantity.TILT:
        lag_s = swing_of(config, is_afloat=is_afloat).lag_s
        return learn(state.deck, (modes[2] @ modes[0])[SWINGING].tolist(), lag_s), state.sway
    if state.sway is not None and reading.quantity in MOTIONS:
        sway = learn_sway(state.sway, modes, state.unmeasured_s, config)
        antenna_m = float(numbers.lever_m[3] - numbers.lever_m[2])
        return state.deck, widen_sway(sway, reading, state.unmeasured_s, antenna_m, config)
    return state.deck, state.sway


def _with_told_tilt(state: ImmState, tilt: Measurement, motion: DeckMotion, numbers: Numbers) -> ImmState:
    """What a vehicle states may err for ever, too."""
    variances = np.append(numbers.prior_variances[TILT], tilt.covariance.diagonal()[:2])
    modes = open_deck(state.modes, numbers.lever_m, variances)
    return replace(state, modes=modes, deck=motion, sway=None)


def _with_sway(state: ImmState, config: ImmConfig, numbers: Numbers) -> ImmState:
    sway = first_sway(config.sway)
    variances = np.append(sway_variances(sway), (0.0, 0.0))
    return replace(state, modes=open_deck(state.modes, numbers.lever_m, variances), sway=sway)


def open_deck(modes: Modes, lever_m: Array, variances: Array) -> Modes:
    """Return all modes with `variances` (6,) of the deck's states, which nothing was known of.

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


def opened_unit(state: ImmState, heading: Measurement) -> ImmState:
    """Return the state before a heading is fused.

    What a unit states says how far its compass or its antennas may be turned, which lasts, and how much it scatters. It
    does not say how much it is of each, so it is taken for both. A unit that comes to state twice as much, or half,
    goes by other sensors than before, and what was learnt of its error is of no use.

    Args:
        state: so far.
        heading: that a unit tells.
    """
    stated_rad2, before_rad2 = float(heading.covariance[0, 0]), state.heading_bias_variance_rad2
    if before_rad2 / _OTHER_UNIT**2 < stated_rad2 < before_rad2 * _OTHER_UNIT**2:
        return state
    means, covariances, weights = state.modes
    means, covariances = means.copy(), covariances.copy()
    means[:, UNIT_HEADING] = covariances[:, UNIT_HEADING, :] = covariances[:, :, UNIT_HEADING] = 0.0
    covariances[:, UNIT_HEADING, UNIT_HEADING] = stated_rad2
    return replace(state, modes=(means, covariances, weights), heading_bias_variance_rad2=stated_rad2)


def upright_modes(state: ImmState) -> Modes:
    """Return the modes of a body that stands upright: from its swing or sway, which is soon past, no error grows."""
    if state.deck is None and state.sway is None:
        return state.modes
    means, covariances, weights = state.modes
    upright, known = means.copy(), covariances.copy()
    upright[:, TILT] = known[:, TILT, :] = known[:, :, TILT] = 0.0
    return upright, known, weights


def told_modes(state: ImmState) -> Modes:
    """Return the modes without a sway that the vehicle does not tell: no drone is to follow its few centimetres."""
    return upright_modes(state) if state.deck is None else state.modes


def motion_of(state: ImmState, config: ImmConfig, numbers: Numbers) -> Array:
    """Return the numbers (18,) of the motion as `imm_mixing` takes them, with what was learnt of deck or body."""
    if state.deck is None and state.sway is None:
        return numbers.motion
    motion = numbers.motion.copy()
    if state.deck is not None:
        motion[1:4], motion[10:16] = state.deck.oscillators[:3], state.deck.oscillators[3:]
    elif state.sway is not None:
        oscillators = sway_oscillators(state.sway, config.sway)
        motion[1:4], motion[10:16] = oscillators[:3], oscillators[3:]
    return motion
