"""How the drone's frame W and that of the vehicle's fixes move against each other, and what is known for it."""

import math

import numpy as np

from companion.config.estimation import ReceiversConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.imm_kernels import CLOCK, HEADING
from companion.vehicle.imm_numbers import Deck
from companion.vehicle.imm_sensors import PAD, observe
from companion.vehicle.imm_state import OFFSET, PLACE, ImmState, open_place_and_offset, open_states, seen_axes
from companion.vehicle.imm_swing import PITCH, ROLL, SIZE
from companion.vehicle.surface import pad_height_seen
from link.records import replace


def wandering(state: ImmState, receivers: ReceiversConfig) -> tuple[float, float, float]:
    """Return how fast the vehicle's receiver and the drone's own place wander, m^2/s, and its height's rate, m^2/s^3.

    Args:
        state: now.
        receivers: of both.
    """
    bias_m2_s = 2.0 * state.fix_bias_variance_m2 / receivers.fix_bias_time_s
    receiver_m2_s = receivers.frame_offset_walk_m2_s + bias_m2_s + _fine_walk_m2_s(state, receivers)
    return receiver_m2_s, receivers.own_walk_share * bias_m2_s, _own_rate_m2_s3(state, receivers)


def without_slow_error(state: ImmState, bias_variance_m2: float, receivers: ReceiversConfig) -> ImmState:
    """Return the state as the first corrected fix comes: the slow error of those before has ended.

    The offset was that of the frames and the slow error in one. On an axis on which less is known of it than before any
    fix, it begins anew. The place is then where the fixes have it, and is uncertain by the slow error that they had.
    Corrected fixes are dated without an error, too.

    Args:
        state: before the fix.
        bias_variance_m2: of the fix's slow error, 0 of a corrected one.
        receivers: of both.
    """
    before_m2, anew_m2 = state.fix_bias_variance_m2, receivers.frame_offset_std_m**2
    if bias_variance_m2 > 0.0 or before_m2 == 0.0:
        return state
    means, covariances, weights = state.modes
    is_unknown = weights @ covariances[:, OFFSET, OFFSET] > anew_m2
    place, offset = PLACE[is_unknown], OFFSET[is_unknown]
    by_fixes = np.eye(SIZE)
    by_fixes[place, offset], by_fixes[offset, offset], by_fixes[CLOCK, CLOCK] = -1.0, 0.0, 0.0
    modes = (means @ by_fixes.T, by_fixes @ covariances @ by_fixes.T, weights)
    means, covariances, weights = open_states(modes, place, np.full(len(place), before_m2))
    anew = open_place_and_offset(covariances, np.diag(np.where(is_unknown, anew_m2, 0.0)))
    return replace(state, modes=(means, anew, weights))


def moved_frame(state: ImmState, step: Measurement, receivers: ReceiversConfig, placed_by: Quantity) -> ImmState:
    """Return the state after W has moved.

    On an axis on which the fixes alone tell the place, the drone's own step is of an offset that nobody knows: there it
    may as well be that the drone's place was wrong before, and the vehicle stays where its fixes have it.

    Args:
        state: before.
        step: a `Quantity.FRAME_STEP`.
        receivers: of the vehicle and the drone.
        placed_by: what the filter starts on; what sightings alone place has no offset.
    """
    seen_m, told_m = step.value[:3], step.value[3:]
    if placed_by is Quantity.PAD:
        means, covariances, weights = open_states(state.modes, PLACE, step.covariance.diagonal()[:3])
        means = means.copy()
        means[:, PLACE] += seen_m
        return replace(state, modes=(means, covariances, weights))
    means, covariances, weights = state.modes
    seen = seen_axes(state, receivers)
    means = means.copy()
    means[:, PLACE] += np.where(seen, seen_m, told_m)
    means[:, OFFSET] += np.where(seen, seen_m - told_m, 0.0)
    opened = open_place_and_offset(covariances, step.covariance[:3, :3] * np.outer(seen, seen))
    return replace(state, modes=(means, opened, weights))


def ranged_pad(
    state: ImmState, surface: Measurement, deck: Deck, lever_m: Array, *, sees_heading: bool
) -> Measurement | None:
    """Return the pad's height that a surface below the drone tells, None if it may be of something else.

    Args:
        state: now.
        surface: the place that was seen, with how far the frames may be apart.
        deck: with the pad.
        lever_m: (4,) as `observe` takes it.
        sees_heading: whether the heading is known: without it nobody knows where about the antenna the pad is.
    """
    if not sees_heading and any(lever_m[:2]):
        return None
    means, covariances, weights = state.modes
    x = weights @ means
    pad, H = observe(PAD, x, lever_m, sees_heading)
    apart_m2 = float(surface.covariance[0, 0]) + _slow_variance_m2(state)
    forward, left = x[9] - x[PITCH], x[ROLL]
    c, s = math.cos(x[HEADING]), math.sin(x[HEADING])
    return pad_height_seen(
        surface,
        pad,
        pad_std_m=math.sqrt(max(horizontal_variance_m2(H[:2], weights, covariances, apart_m2), 0.0)),  # rounding
        slope_enu=(c * forward - s * left, s * forward + c * left),
        half_width_m=deck.half_width_m,
        above_road_m=deck.pad_height_m,
    )


def horizontal_variance_m2(H: Array, weights: Array, covariances: Array, apart_m2: float) -> float:
    """Return the variance of the pad's horizontal place in W on its worse axis.

    It is that in the frame of the vehicle's fixes, with what the frames may be apart, where that is less: what fixes
    alone place is taken to be anywhere in W until a sighting tells, whether the frames are known to be one or not.

    Args:
        H: (2, 26) Jacobian of the pad's place in W.
        weights: (n,) of the modes.
        covariances: (n, 26, 26).
        apart_m2: variance of how far apart the frames are.
    """
    by_fixes = H.copy()
    by_fixes[[0, 1], OFFSET[:2]] -= 1.0
    P = np.einsum("n,nij->ij", weights, covariances)
    in_drones_frame, fixed = ((J @ P @ J.T).diagonal() for J in (H, by_fixes))
    return float(np.minimum(in_drones_frame, np.maximum(fixed, 0.0) + apart_m2).max())


def _slow_variance_m2(state: ImmState) -> float:
    """Return the variance of what two receivers err by slowly, so that no number of fixes averages it, m^2.

    Of what a receiver states that is no slow error most is slow, too, and the drone's errs as the vehicle's.
    """
    return state.fix_bias_variance_m2 + 2.0 * state.fix_white_variance_m2


def own_rate_opened_m2_s2(state: ImmState, receivers: ReceiversConfig) -> float:
    """Return the variance that the rate of the drone's own height has gained unseen, when its height is told, m^2/s^2.

    A rate that has that much beside what `wandering` fed it while nothing told the height may be any again.
    """
    left = math.exp(-state.height_age_s / receivers.own_height_time_s)
    return (receivers.own_height_rate_std_m_s * (1.0 - left)) ** 2


def _fine_walk_m2_s(state: ImmState, receivers: ReceiversConfig) -> float:
    """Return how fast the frames wander apart, m^2/s, by what two receivers state that is no slow error.

    Most of it is slow, too: multipath and the atmosphere. Over a time T each of two Gauss-Markov errors of variance v
    changes by 2 v (1 - exp(-T / tau)), so that what was known when the pad was last seen is never worse than both.
    """
    left = math.exp(-state.seen_age_s / receivers.fix_bias_time_s)
    return 4.0 * state.fix_white_variance_m2 * left / receivers.fix_bias_time_s


def _own_rate_m2_s3(state: ImmState, receivers: ReceiversConfig) -> float:
    """Return how fast the rate of the drone's own height wanders, m^2/s^3.

    Its height does not wander for ever: long after anything told it, it is as wrong as it ever gets.
    """
    left = math.exp(-state.height_age_s / receivers.own_height_time_s)
    return 2.0 * receivers.own_height_rate_std_m_s**2 / receivers.own_height_rate_time_s * left
