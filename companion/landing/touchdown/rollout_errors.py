"""What may be wrong in each rollout of a descent: of the vehicle, as it is driven, and of the drone; pure."""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import STATES
from companion.core.data import Array, Mixture, VehicleEstimate
from companion.forecast.draws import MODE, Draws
from companion.vehicle.hindsight import CLIMB_AHEAD_S, Driving, climb_std_m_s
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import frames_apart_m2

_PLACE_STD_MIN_M = 0.02  # of a receiver with corrections
_CHANGE_S = 0.1  # between two changes of speed that `Driving` keeps
_PRIOR_DRIVEN_S = 2.0  # what the estimator believes of drivers counts as one such change, which is over 2 s
_OWN_HEIGHT_STD_M = 0.05  # of the drone's height beside the vehicle's: receivers with corrections, or a range finder
_OWN_CLIMB_STD_M_S = 0.07  # of its rate, gusts included: 208 contacts in worlds sank by 0.06 m/s other than forecast


class Errors(Struct, frozen=True, kw_only=True, eq=False):
    """What may be wrong in each of n samples: as `samples.Samples` has it, and how late a setpoint is, in deviations.

    Attributes:
        vehicle: (n, 3, 2).
        deviation: (n, 4, 2).
        vertical: (n, 2).
        late: (n,) standard normal.
    """

    vehicle: Array
    deviation: Array
    vertical: Array
    late: Array


def draw_errors(then: VehicleEstimate, pad: PadPath, climbs_m_s: float, deviates: Array, numbers: Draws) -> Errors:
    """Return what may be wrong.

    Args:
        then: the vehicle at its newest datum.
        pad: now; where its place is known less well than the antenna's, that is the heading's.
        climbs_m_s: standard deviation of the pad's velocity upwards at the contact.
        deviates: (4, 4) covariance of how the drone deviates from its path.
        numbers: random ones.
    """
    normals = numbers.normals
    vehicle = _draw_vehicle(then, pad, normals[:, :9], numbers.uniforms[:, MODE])
    own = normals[:, 17:19] * np.array([_OWN_HEIGHT_STD_M, math.hypot(_OWN_CLIMB_STD_M_S, climbs_m_s)])
    return Errors(
        vehicle=np.ascontiguousarray(vehicle.reshape(-1, 3, 3)[:, :, :2]),
        deviation=np.einsum("ij,njk->nik", _root(deviates), normals[:, 9:17].reshape(-1, STATES, 2)),
        vertical=own - np.column_stack([vehicle[:, 2], np.zeros(len(vehicle))]),
        late=normals[:, 19],
    )


def climbs_m_s(then: VehicleEstimate, pad: PadPath, driving: Driving) -> float:
    """Return the standard deviation of the pad's velocity upwards at a contact, as far as the drone does not follow it.

    What the estimator believes of roads and decks counts as `_PRIOR_DRIVEN_S` of what this one has shown.

    Args:
        then: the vehicle at its newest datum.
        pad: from now on.
        driving: the last 15 s.
    """
    stated = pad.climb_std_m_s
    believed_m_s = climb_std_m_s(then) if stated is None else float(np.interp(CLIMB_AHEAD_S, pad.offset_s, stated))
    squares = _PRIOR_DRIVEN_S + _CHANGE_S * sum(driving.climbs)
    return believed_m_s * math.sqrt(squares / (_PRIOR_DRIVEN_S + _CHANGE_S * len(driving.climbs)))


def draw_deck(pad: PadPath, contact_s: float, normals: Array) -> Array:
    """Return by what a deck's slope, and place and velocity of the pad's shake, may be off at the contact, (n, 3, 2).

    A drone follows a part of the shake, but of the one that is forecast.

    Args:
        pad: from now on.
        contact_s: until then.
        normals: (n, 4) standard normal, of roll, its rate, pitch and its rate.
    """
    if pad.swing is None or pad.yaw_rad is None:
        return np.zeros((len(normals), 3, 2))
    std = np.array([np.interp(contact_s, pad.offset_s, column) for column in pad.swing.tilt_std_rad.T])
    roll, roll_rate, pitch, pitch_rate = (normals * std).T[:, :, None]
    ahead = np.array([math.cos(pad.yaw_rad), math.sin(pad.yaw_rad)])
    starboard = np.array([ahead[1], -ahead[0]])
    return np.stack(
        [
            -roll * starboard - pitch * ahead,
            pad.swing.above_m * (roll * starboard + pitch * ahead),
            pad.swing.above_m * (roll_rate * starboard + pitch_rate * ahead),
        ],
        axis=1,
    )


def relearns_hz(then: VehicleEstimate) -> float:
    """Return how fast the error of the vehicle's velocity becomes another one, 1/s.

    In a steady filter the data take from the velocity's variance P_vv what the acceleration's error adds, 2 P_va. So
    the error decays by 2 P_va / P_vv, and the acceleration's, of which it is a part, holds half of that up.
    """
    of_velocity = float(np.trace(then.covariance[3:5, 3:5]))
    with_acceleration = float(np.trace(then.covariance[3:5, 6:8]))
    return max(with_acceleration, 0.0) / of_velocity if of_velocity > 0.0 else 0.0


def _draw_vehicle(then: VehicleEstimate, pad: PadPath, normals: Array, uniforms: Array) -> Array:
    """Return how far place, velocity and acceleration (n, 9) are off, each sample drawn from one of the models.

    A model that is hardly likely holds for few samples. As a part of one covariance it would widen them all.
    """
    mixture, apart_m2 = then.mixture or _as_one(then, pad), frames_apart_m2(pad)
    of_model = np.searchsorted(np.cumsum(mixture.weight)[:-1], uniforms)
    vehicle = np.empty_like(normals)
    for model, (off, stated) in enumerate(zip(mixture.off, mixture.covariance, strict=True)):
        covariance = stated.copy()
        for axis in range(3):
            covariance[axis, axis] = max(covariance[axis, axis] - apart_m2[axis], _PLACE_STD_MIN_M**2)
        drawn = of_model == model
        vehicle[drawn] = off + normals[drawn] @ _root(covariance).T
    return vehicle


def _as_one(then: VehicleEstimate, pad: PadPath) -> Mixture:
    """Return the estimate of a filter of one model; by the heading the pad's place is less well known than it tells."""
    covariance = then.covariance.copy()
    turned_m2 = np.maximum(pad.position_std_m[0] ** 2 - covariance.diagonal()[:3], 0.0)
    covariance[:3, :3] += np.diag(turned_m2)
    return Mixture(weight=np.ones(1), off=np.zeros((1, 9)), covariance=covariance[None])


def as_driven(vehicle: Array, driving: Driving, direction: Array, *, stands: bool) -> Array:
    """Return what the vehicle may be off its estimate with what is known of how it is driven.

    One that stands has neither a velocity nor an acceleration until it departs. One that drives is as uneven along its
    way as it has been, rather than as the estimator takes all drivers to be.

    Args:
        vehicle: (n, 3, 2) as `Errors` has it.
        driving: the last 15 s.
        direction: (2,) unit vector along its way.
        stands: whether it does.
    """
    off = vehicle.copy()
    if stands:
        off[:, 1:] = 0.0
        return off
    along = off[:, 2] @ direction
    believed_m2_s4, seen_s = float(np.mean(np.square(along))), _CHANGE_S * len(driving.changes)
    squares = _PRIOR_DRIVEN_S * believed_m2_s4 + seen_s * driving.unevenness_m_s2**2
    shown_m2_s4 = squares / (_PRIOR_DRIVEN_S + seen_s)
    less = 1.0 - math.sqrt(min(shown_m2_s4 / max(believed_m2_s4, 1e-9), 1.0))
    off[:, 2] -= less * along[:, None] * direction
    return off


def _root(covariance: Array) -> Array:
    """Return a matrix whose product with its transpose is `covariance`, which rounding may have made indefinite."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
