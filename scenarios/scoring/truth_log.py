"""Ground truth of a run as arrays, with the drone's motion as the vehicle sees it.

Frames: W world ENU, B the drone's body (FLU, origin in its centre of mass), V the vehicle's body (FLU, origin on the
road under the middle of the body). All samples stand at the drone's times.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from link.messages import BodyTruth, RotorTruth

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruthLog:
    """A run's truth at n instants.

    Attributes:
        t_ns: (n,), rising.
        position_enu_m: (n, 3) p_WB.
        velocity_enu_m_s: (n, 3) v_WB.
        rotation: (n, 3, 3) R_WB.
        rate_rad_s: (n,) size of the drone's angular velocity.
        vehicle_position_enu_m: (n, 3) p_WV.
        vehicle_velocity_enu_m_s: (n, 3) v_WV.
        rotation_vb: (n, 3, 3) R_VB.
        position_v_m: (n, 3) of B in V.
        velocity_v_m_s: (n, 3) its rate of change, that is, the velocity relative to the deck in V.
        rotor_speed_rad_s: (n, 4), None without rotor truth.
    """

    t_ns: Indices
    position_enu_m: Array
    velocity_enu_m_s: Array
    rotation: Array
    rate_rad_s: Array
    vehicle_position_enu_m: Array
    vehicle_velocity_enu_m_s: Array
    rotation_vb: Array
    position_v_m: Array
    velocity_v_m_s: Array
    rotor_speed_rad_s: Array | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Poses:
    position: Array
    rotation: Array
    velocity_body: Array
    rate_body: Array


def truth_log(drone: Sequence[BodyTruth], vehicle: Sequence[BodyTruth], rotors: Sequence[RotorTruth]) -> TruthLog:
    """Return the log of time-ordered truths, the vehicle and the rotors interpolated to the drone's times.

    Raises:
        ValueError: fewer than two samples of the drone, no sample of the vehicle, or times that do not rise.
    """
    if len(drone) < 2 or not vehicle:
        raise ValueError(f"{len(drone)} samples of the drone and {len(vehicle)} of the vehicle cannot be scored")
    t_ns = np.array([sample.t_ns for sample in drone], dtype=np.int64)
    if np.any(np.diff(t_ns) <= 0):
        raise ValueError("the drone's truth must be in order of time")
    body, base = _poses(drone, t_ns), _poses(vehicle, t_ns)
    to_vehicle = np.swapaxes(base.rotation, 1, 2)
    position_v_m = _turn(to_vehicle, body.position - base.position)
    velocity_enu_m_s = _turn(body.rotation, body.velocity_body)
    velocity_v_m_s = _turn(to_vehicle, velocity_enu_m_s) - base.velocity_body - np.cross(base.rate_body, position_v_m)
    return TruthLog(
        t_ns=t_ns,
        position_enu_m=body.position,
        velocity_enu_m_s=velocity_enu_m_s,
        rotation=body.rotation,
        rate_rad_s=np.linalg.norm(body.rate_body, axis=1),
        vehicle_position_enu_m=base.position,
        vehicle_velocity_enu_m_s=_turn(base.rotation, base.velocity_body),
        rotation_vb=to_vehicle @ body.rotation,
        position_v_m=position_v_m,
        velocity_v_m_s=velocity_v_m_s,
        rotor_speed_rad_s=_rotor_speeds(rotors, t_ns),
    )


def _poses(samples: Sequence[BodyTruth], t_ns: NDArray[np.int64]) -> _Poses:
    times_ns = np.array([sample.t_ns for sample in samples], dtype=np.int64)
    quaternions = np.array([sample.orientation_wxyz for sample in samples], dtype=float)
    flips = np.sign(np.sum(quaternions[1:] * quaternions[:-1], axis=1))
    quaternions[1:] *= np.cumprod(np.where(flips == 0.0, 1.0, flips))[:, None]
    blended = _interpolate(t_ns, times_ns, quaternions)
    return _Poses(
        position=_interpolate(t_ns, times_ns, np.array([sample.position_enu_m for sample in samples])),
        rotation=_matrices(blended / np.linalg.norm(blended, axis=1, keepdims=True)),
        velocity_body=_interpolate(t_ns, times_ns, np.array([sample.velocity_flu_m_s for sample in samples])),
        rate_body=_interpolate(t_ns, times_ns, np.array([sample.angular_velocity_flu_rad_s for sample in samples])),
    )


def _rotor_speeds(rotors: Sequence[RotorTruth], t_ns: NDArray[np.int64]) -> Array | None:
    if not rotors:
        return None
    times_ns = np.array([sample.t_ns for sample in rotors], dtype=np.int64)
    return _interpolate(t_ns, times_ns, np.array([sample.speed_rad_s for sample in rotors]))


def _interpolate(t_ns: NDArray[np.int64], times_ns: NDArray[np.int64], values: Array) -> Array:
    """Return `values` (m, k) at `t_ns` (n,), as (n, k); ends are held."""
    at_s, times_s = (t_ns - t_ns[0]) * 1e-9, (times_ns - t_ns[0]) * 1e-9
    return np.stack([np.interp(at_s, times_s, column) for column in values.T], axis=1)


def _turn(rotation: Array, vectors: Array) -> Array:
    """Return `rotation` (n, 3, 3) times `vectors` (n, 3)."""
    return np.asarray(np.einsum("nij,nj->ni", rotation, vectors))


def _matrices(q: Array) -> Array:
    """Return the rotation matrices (n, 3, 3) of unit quaternions (n, 4), wxyz."""
    w, x, y, z = q.T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


_PASSED_M = 1.0  # farther than its closest approach by this, the vehicle has passed
_SAME_M = 1e-6


def passing_ns(log: TruthLog, place_enu_m: Array, around_ns: int) -> int | None:
    """Return when the vehicle is nearest to a place on that one of its passings which is at, or next to, an instant.

    A vehicle that stands is nearest all the time, of which the instant itself counts.

    Args:
        log: of the run.
        place_enu_m: (2,) in W.
        around_ns: within the log.

    Returns:
        None where the vehicle is still coming nearer at the end of the log.
    """
    aside_m = np.linalg.norm(log.vehicle_position_enu_m[:, :2] - place_enu_m, axis=1)
    around = min(int(np.searchsorted(log.t_ns, around_ns)), len(aside_m) - 1)
    first = around + 1 - _samples_until_passed(aside_m[around::-1])
    last = around + _samples_until_passed(aside_m[around:])
    within_m = aside_m[first:last]
    nearest = np.flatnonzero(within_m <= within_m.min() + _SAME_M) + first
    index = int(nearest[np.argmin(np.abs(nearest - around))])
    return None if index == len(aside_m) - 1 else int(log.t_ns[index])


def _samples_until_passed(aside_m: Array) -> int:
    passed = np.flatnonzero(aside_m > np.minimum.accumulate(aside_m) + _PASSED_M)
    return int(passed[0]) if len(passed) else len(aside_m)
