"""Whether the camera is turned against the drone as the mounting file says, told by the decks that it sees; pure.

Model: the pad's normal as it is seen, less the drone's own up, is the deck's tilt, which turns with the pad, and what
the camera is turned by against what is told, which does not: d = R(psi) tau + (-delta_y, delta_x), both in B, level
parts, for small angles; psi is the pad's yaw in B, tau its tilt in P, delta the rotation vector from the told camera to
the true one. Least squares, with tau as decks are. Only a drone that turns over the pad tells the two apart; while it
keeps its yaw to the pad, delta stays as uncertain as decks are uneven. An autopilot that is not level is in delta, too:
sightings are off by both. What is not told is a turn about the vertical, nor where the camera is: these show in the
pad's place alone, which moves.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.eyes.finding.choosing import DECK_TILT_STD_RAD

Array = NDArray[np.float64]

_EVERY_NS = 500_000_000  # what is off in one frame is in the next one as well
_RANGE_MAX_M = 3.0  # farther away the normal is told by a tag's perspective alone
_SEEN_STD_RAD = 0.02  # of one comparison: attitudes of autopilots in motion are good to 1 degree
_CAMERA_STD_RAD = 0.2  # before anything was seen
_STDS = 3.0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Alignment:
    """What was seen until `t_ns`: information (4, 4) and its vector (4,) of delta_x, delta_y, tau_x, tau_y."""

    t_ns: int | None
    information: Array
    vector: Array


class Turned(NamedTuple):
    """By how much the true camera is turned about B's x and y against the told one, and the standard deviation."""

    about_x_rad: float
    about_y_rad: float
    std_rad: float


def no_alignment() -> Alignment:
    """Return what is known before a pad was seen."""
    stds = np.array([_CAMERA_STD_RAD, _CAMERA_STD_RAD, DECK_TILT_STD_RAD, DECK_TILT_STD_RAD])
    return Alignment(t_ns=None, information=np.diag(stds**-2), vector=np.zeros(4))


def update_alignment(before: Alignment, t_ns: int, away_m: float, R_BP: Array, R_WB: Array) -> Alignment:
    """Return the alignment with a pad of attitude R_BP, seen from `away_m` by a drone of attitude R_WB."""
    is_soon = before.t_ns is not None and 0 <= t_ns - before.t_ns < _EVERY_NS
    if is_soon or away_m > _RANGE_MAX_M:
        return before
    d = R_BP[:2, 2] - R_WB[2, :2]
    yaw_rad = math.atan2(R_BP[1, 0], R_BP[0, 0])
    cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
    A = np.array([[0.0, -1.0, cosine, -sine], [1.0, 0.0, sine, cosine]])
    return Alignment(
        t_ns=t_ns,
        information=before.information + A.T @ A / _SEEN_STD_RAD**2,
        vector=before.vector + A.T @ d / _SEEN_STD_RAD**2,
    )


def turned_of(alignment: Alignment) -> Turned:
    """Return the best estimate of how the camera is turned."""
    covariance = np.linalg.inv(alignment.information)
    about_x_rad, about_y_rad = (covariance @ alignment.vector)[:2].tolist()
    return Turned(about_x_rad, about_y_rad, float(np.sqrt(covariance[:2, :2].trace() / 2.0)))


def upright(R_BP: Array, R_WB: Array) -> Array:
    """Return the least rotation vector (3,) in B that would have a pad of attitude R_BP lie level.

    Args:
        R_BP: (3, 3) of the pad.
        R_WB: (3, 3) of the drone.
    """
    normal, up = R_BP[:, 2], R_WB[2]
    axis = np.cross(normal, up)
    sine = float(np.linalg.norm(axis))
    return np.asarray(axis * (math.atan2(sine, float(normal @ up)) / max(sine, 1e-9)))


def is_told_wrong(turned: Turned, rotation_std_rad: float) -> bool:
    """Return whether it is turned by more than what is unsure here and what the mounting file allows for."""
    off_rad = math.hypot(turned.about_x_rad, turned.about_y_rad)
    return off_rad > _STDS * math.hypot(turned.std_rad, rotation_std_rad)
