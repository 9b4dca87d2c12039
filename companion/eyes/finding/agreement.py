"""Whether all tags that a search has found are where a pose of the board has them; pure.

A pose that rests on one tag may be right for this tag alone: where the board's file has other sizes or places than the
print, the others are seen elsewhere. So they are asked as well, and most must agree.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import CELLS, Board
from companion.eyes.camera import Camera
from companion.eyes.finding.pose import AGREES_PX, Pose

Array = NDArray[np.float64]


def doubled_ids(places: Mapping[int, Sequence[Array]]) -> frozenset[int]:
    """Return the ids that are seen at two places: so far apart that they cannot be two findings of one square.

    Args:
        places: of each id the corners (4, 2) in pixels, once for each finding.
    """
    return frozenset(
        tag_id
        for tag_id, found in places.items()
        if any(_apart_px(one, other) > max(side_px(one), side_px(other)) for one, other in combinations(found, 2))
    )


def odd_ids(camera: Camera, board: Board, pose: Pose, seen: Mapping[int, Array]) -> frozenset[int]:
    """Return the ids of tags that are seen more than a cell beside where a pose has them: it cannot read them there.

    Args:
        camera: that took the picture.
        board: that they are on.
        pose: of the board.
        seen: of each id the corners (4, 2) in pixels. Their mean is compared: mud bends one corner or another.
    """
    return frozenset(
        tag_id
        for tag_id, corners in seen.items()
        if _apart_px(corners, camera.pixels(board.corners_m[tag_id], *pose)[0])
        > max(AGREES_PX, side_px(corners) / CELLS)
    )


def most_agree(odd: frozenset[int], seen: Mapping[int, Array]) -> bool:
    """Return whether more of the tags that are seen are where the pose has them than elsewhere."""
    return 2 * len(odd) < len(seen)


def side_px(corners: Array) -> float:
    """Return the mean length of a square's sides from its corners (4, 2)."""
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).mean())


def _apart_px(one: Array, other: Array) -> float:
    return float(np.linalg.norm(one.mean(axis=0) - other.mean(axis=0)))
