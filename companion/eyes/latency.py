"""A camera's latency from the drone's own rotation over a pad that stands still; pure.

Model: the pad's attitude in W is R_WB(t) R_BP(t), the drone's from its autopilot and the pad's from the camera. The
pad stands, so that it is the same in all pictures; where the pictures are stamped late by d, the product with
R_WB(t - d) is. The d is taken that leaves least of the angles from their mean.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from companion.eyes.attitude import Attitude, attitude_at
from link.errors import UserError
from link.frames.rotations import matrix_from_quaternion
from link.messages import PadSighting

Array = NDArray[np.float64]

SIGHTINGS_MIN = 60
_RANGE_S = (-0.1, 0.5)
_STEP_S = 0.005
_TURNING_MIN_RAD_S = 0.15  # root mean square: 1 ms is 0.01 degrees then
_ANGLE_MAX_RAD = 0.35  # a single picture's pose that is off by more is a mirrored one


@dataclass(frozen=True, slots=True, kw_only=True)
class Latency:
    """What the rotation tells.

    Attributes:
        latency_s: from the middle of an exposure to the stamp of its picture.
        std_s: standard deviation of it.
        left_rad: root mean square of what is left of the angles.
        turning_rad_s: root mean square of the drone's rate.
        sightings: that it rests on.
    """

    latency_s: float
    std_s: float
    left_rad: float
    turning_rad_s: float
    sightings: int


def fit_latency(attitudes: Sequence[Attitude], sightings: Sequence[PadSighting]) -> Latency:
    """Return the latency by which the pad stands stillest.

    Args:
        attitudes: of the drone, oldest first.
        sightings: of a pad that stands, with stamps that are not corrected for any latency.

    Raises:
        UserError: too little was seen, or the drone hardly turned.
    """
    if len(sightings) < SIGHTINGS_MIN:
        raise UserError(
            f"the pad was seen {len(sightings)} times, {SIGHTINGS_MIN} are needed: keep it in view for some seconds"
        )
    rate_rad_s = _turning_rad_s(attitudes)
    if rate_rad_s < _TURNING_MIN_RAD_S:
        raise UserError(
            f"the drone turned by {rate_rad_s:.2f} rad/s, {_TURNING_MIN_RAD_S:g} are needed: roll and pitch it to and "
            "fro over the pad, a turn of 20 degrees in half a second"
        )
    history = tuple(attitudes)
    delays_s = np.arange(_RANGE_S[0], _RANGE_S[1] + 0.5 * _STEP_S, _STEP_S)
    left = np.array([_left_rad2(history, sightings, float(delay_s))[0] for delay_s in delays_s])
    best = int(np.argmin(left))
    if best in (0, len(delays_s) - 1):
        raise UserError(f"no latency from {_RANGE_S[0]:g} to {_RANGE_S[1]:g} s fits: do the clocks agree?")
    before, least, after = left[best - 1 : best + 2].tolist()
    curvature = max(before - 2.0 * least + after, 1e-15) / _STEP_S**2  # of the mean square, rad^2/s^2
    latency_s = float(delays_s[best]) + 0.5 * _STEP_S * (before - after) / max(before - 2.0 * least + after, 1e-15)
    least_rad2, count = _left_rad2(history, sightings, latency_s)
    return Latency(
        latency_s=latency_s,
        std_s=math.sqrt(2.0 / 3.0 * least_rad2 / (curvature * count)),  # an angle has three components
        left_rad=math.sqrt(least_rad2),
        turning_rad_s=rate_rad_s,
        sightings=count,
    )


def _left_rad2(history: tuple[Attitude, ...], sightings: Sequence[PadSighting], delay_s: float) -> tuple[float, int]:
    """Return the mean square of the angles from the pad's mean attitude with a delay, and of how many sightings."""
    found = []
    for sighting in sightings:
        own = attitude_at(history, sighting.t_ns - round(delay_s * 1e9))
        if own is not None:
            found.append(matrix_from_quaternion(own) @ matrix_from_quaternion(sighting.orientation_wxyz))
    if len(found) < SIGHTINGS_MIN // 2:
        return math.inf, len(found)
    angles = _angles_rad(np.array(found))
    kept = angles[angles < max(_ANGLE_MAX_RAD, 3.0 * float(np.median(angles)))]
    return float(np.mean(kept**2)), len(kept)


def _angles_rad(matrices: Array) -> Array:
    """Return the angles (N,) of rotations (N, 3, 3) from their mean."""
    u, _, vt = np.linalg.svd(matrices.sum(axis=0))
    mean = u @ np.diag([1.0, 1.0, float(np.linalg.det(u @ vt))]) @ vt
    cosine = 0.5 * (np.einsum("nij,ij->n", matrices, mean) - 1.0)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _turning_rad_s(attitudes: Sequence[Attitude]) -> float:
    """Return the root mean square of the rate between one attitude and the next."""
    squares = []
    for before, after in pairwise(attitudes):
        elapsed_s = (after.t_ns - before.t_ns) * 1e-9
        cosine = abs(sum(a * b for a, b in zip(before.orientation_wxyz, after.orientation_wxyz, strict=True)))
        if 0.0 < elapsed_s < 0.5:
            squares.append((2.0 * math.acos(min(cosine, 1.0)) / elapsed_s) ** 2)
    return math.sqrt(sum(squares) / len(squares)) if squares else 0.0
