"""Which of the two poses that explain a plane is right; pure.

Seen from afar, a plane that is tilted to one side looks as one that is tilted to the other (Schweighofer and Pinz
2006). The edges tell the two apart by their perspective, gravity by the deck, which lies within some degrees of level.
Where neither does, the pad is not said to be seen: as many frames as are refused so, twice in a thousand of them at
most would have been mirrored.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from companion.eyes.camera import matrix_of, vector_of
from companion.eyes.finding.pose import Pose, Refined

Array = NDArray[np.float64]

DECK_TILT_STD_RAD = 0.1
"""Roads of up to 12 % (7 degrees), and a body's roll on its springs."""
_DRONE_TILT_STD_RAD = 0.25  # of a drone of unknown attitude
TILT_STDS_MAX = 4.0
_MISREAD_MAX = 1e-3  # probability that the other of the two poses was the right one
_TAGS_SHARE_MAX = 0.5  # of the other's: chance reads no tag, blur takes one or another, but not half of them
_APART_MAX_RAD = math.radians(20.0)  # between the normals: poses that are nearer are not taken for mirrored ones


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A pose near a guess: the tags that it rests on, how far from level it is, and whether most tags were read."""

    refined: Refined
    tags: tuple[int, ...]
    tilt_stds: float
    is_complete: bool


Chosen = tuple[Candidate, Candidate | None]
"""A pose, and its mirrored one if that may be the right one as well."""


def choose(candidates: list[Candidate]) -> Chosen | None:
    """Return the more probable of up to two poses, and the other one where it may as well be.

    None is returned where none can be right, or where they cannot be told apart and are not alike either.
    """
    if not candidates:
        return None
    tags_max = max(len(one.tags) for one in candidates)
    candidates = [one for one in candidates if len(one.tags) > _TAGS_SHARE_MAX * tags_max]
    variance_px2 = min(one.refined.variance_px2 for one in candidates)
    scores = [one.refined.squares_px2 / variance_px2 - one.refined.independent + one.tilt_stds**2 for one in candidates]
    best = int(np.argmin(scores))
    if candidates[best].tilt_stds > TILT_STDS_MAX:
        return None
    if len(candidates) == 1 or _misread_probability(scores) <= _MISREAD_MAX:
        return candidates[best], None
    if _apart_rad(*(one.refined.pose for one in candidates)) > _APART_MAX_RAD:
        return None
    return candidates[best], candidates[1 - best]


def better(best: Chosen | None, chosen: Chosen | None) -> Chosen | None:
    """Return which of two rests on more points, the first if they are as many."""
    if best is None or chosen is None:
        return best or chosen
    return chosen if chosen[0].refined.points > best[0].refined.points else best


def leaning_of(candidates: list[Candidate]) -> Pose | None:
    """Return the most level pose if even that one is not as level as decks are."""
    level = min(candidates, key=lambda one: one.tilt_stds, default=None)
    return None if level is None or level.tilt_stds <= TILT_STDS_MAX else level.refined.pose


def _misread_probability(scores: list[float]) -> float:
    """Return how probable the worse of two poses is, each with the likelihood exp(-score / 2)."""
    return 1.0 / (1.0 + math.exp(min(0.5 * abs(scores[0] - scores[1]), 700.0)))


def _apart_rad(one: Pose, other: Pose) -> float:
    cosine = float(matrix_of(one[0])[:, 2] @ matrix_of(other[0])[:, 2])
    return math.acos(min(max(cosine, -1.0), 1.0))


def mirrored(pose: Pose) -> Pose:
    """Return the pose that looks the same without perspective: tilted to the other side of the line of sight."""
    sight = pose[1] / np.linalg.norm(pose[1])
    across = np.cross(sight, np.eye(3)[int(np.argmin(np.abs(sight)))])
    across = across / np.linalg.norm(across)
    A = np.array([across, np.cross(sight, across), sight])
    D = np.diag([1.0, 1.0, -1.0])
    return vector_of(A.T @ D @ A @ matrix_of(pose[0]) @ D), pose[1]


def tilt_stds(R_WP: Array, *, is_level_known: bool) -> float:
    """Return how far from level the board would be, in standard deviations of decks.

    Args:
        R_WP: (3, 3) of the board.
        is_level_known: the drone's attitude is.
    """
    drone_rad = 0.0 if is_level_known else _DRONE_TILT_STD_RAD
    return math.acos(min(max(float(R_WP[2, 2]), -1.0), 1.0)) / math.hypot(DECK_TILT_STD_RAD, drone_rad)
