"""Tags found anywhere in a picture, without knowing where: OpenCV's detector on the picture and on reduced ones.

A large tag in whose cells smaller ones stand is found where these have blurred away, in a reduced picture. That is
also the cheapest, so the reduced ones come first, and the search ends with the first that shows the board.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import CELLS, Board, dictionary_of
from companion.eyes.finding.agreement import doubled_ids
from companion.eyes.picture import Gray, Part

Array = NDArray[np.float64]


class _Pass(NamedTuple):
    """By how much the picture is reduced, whether mud may bend an outline, and whether speckles are taken out."""

    reduction: int
    is_muddy: bool = False
    is_cleaned: bool = False


_PASSES = (
    *(_Pass(8), _Pass(4), _Pass(2), _Pass(1)),
    *(_Pass(4, is_muddy=True), _Pass(2, is_muddy=True)),
    *(_Pass(4, is_muddy=True, is_cleaned=True), _Pass(2, is_muddy=True, is_cleaned=True)),
)
_SPECKLE_PX = 5
_WINDOW_PX = 11  # of the adaptive threshold: larger than a cell of small tags; large ones are told by their outline
_MUD_WINDOW_MAX_PX, _MUD_WINDOW_STEP_PX = 35, 12  # also: larger than the mud on an outline, which is as dark as print
_MUD_BEND_SHARE = 0.08  # of an outline's length: a third of a side, by which mud may bend it; OpenCV takes 0.03
_THRESHOLD_SHARE, _THRESHOLD_MIN, _THRESHOLD_MAX = 0.03, 2.0, 7.0  # of the picture's contrast; in shades
_SHARPENING = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 20, 0.02)
_SIDE_MIN_PX = 12.0  # 1.5 pixels a cell: below, neighbouring cells cannot be told apart
_NEAR_SHARE = 0.02  # of a square's perimeter: one that is farther from another is no second finding of the same edges
_WRONG_BITS_MAX = 2  # of 36; of the 5 that could be mended, so that chance and other families' tags are refused


@dataclass(frozen=True)
class Found:
    """What a pass has found.

    Attributes:
        corners_px: of each id on the board the corners (4, 2) in the whole picture, in the order of `Board.corners_m`.
        foreign_ids: of tags of the family that are not on the board.
        doubled_ids: on the board that this pass and those before it have seen at two places.
        is_followed_by_mud: the passes after it expect mud: worth their time only where nothing has shown the board.
    """

    corners_px: dict[int, Array]
    foreign_ids: frozenset[int]
    doubled_ids: frozenset[int]
    is_followed_by_mud: bool


def search(part: Part, board: Board) -> Iterator[Found]:
    """Yield what each pass over a part of a picture finds, the cheapest first; the caller stops when it has the pad.

    An id that is seen twice is believed at neither place.
    """
    constant = _threshold_of(part.shades)
    places: dict[int, list[Array]] = {tag_id: [] for tag_id in board.corners_m}
    for one, following in zip(_PASSES, (*_PASSES[1:], None), strict=True):
        tags = _detect(part.shades, one, board.config.family, constant)
        seen = [tag_id for tag_id, _ in tags]
        known = [
            (tag_id, corners + np.array([part.box.left, part.box.top]))
            for tag_id, corners in tags
            if tag_id in board.corners_m
        ]
        for tag_id, corners in known:
            places[tag_id].append(corners)
        yield Found(
            corners_px={tag_id: corners for tag_id, corners in known if seen.count(tag_id) == 1},
            foreign_ids=frozenset(seen) - frozenset(board.corners_m),
            doubled_ids=doubled_ids(places),
            is_followed_by_mud=following is not None and following.is_muddy,
        )


def _threshold_of(shades: Gray) -> int:
    """Return by how much black must be below its surroundings: OpenCV's 7 shades, less where all is dim."""
    low, high = np.percentile(shades[::8, ::8], [2.0, 98.0])
    return int(np.clip(_THRESHOLD_SHARE * (high - low), _THRESHOLD_MIN, _THRESHOLD_MAX))


def _detect(shades: Gray, one: _Pass, family: str, constant: int) -> list[tuple[int, Array]]:
    """Return ids and corners (4, 2) of the tags that are seen in the picture once it is reduced."""
    rows, columns = shades.shape
    reduction = one.reduction
    if min(rows, columns) < 2 * reduction * _SIDE_MIN_PX:
        return []
    small = shades
    if reduction > 1:
        small = shades[: rows - rows % reduction, : columns - columns % reduction]
        size = (small.shape[1] // reduction, small.shape[0] // reduction)
        small = np.asarray(cv2.resize(small, size, interpolation=cv2.INTER_AREA), np.uint8)
    if one.is_cleaned:
        small = np.asarray(cv2.medianBlur(np.ascontiguousarray(small), _SPECKLE_PX), np.uint8)
    corners, found, _ = _detector(family, max(small.shape), constant, is_muddy=one.is_muddy).detectMarkers(
        np.ascontiguousarray(small)
    )
    ids = [int(tag_id) for tag_id in np.ravel(found)] if len(corners) else []
    shift = 0.5 * (reduction - 1)  # between the centres of the first pixels
    places = [
        _sharpen(shades, np.asarray(quad, np.float64).reshape(4, 2) * reduction + shift, reduction) for quad in corners
    ]
    return list(zip(ids, places, strict=True))


def _sharpen(shades: Gray, corners: Array, reduction: int) -> Array:
    """Return corners as the picture in full shows them."""
    side_px = float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min())
    half_px = int(min(0.5 * side_px / CELLS, 2.0 * reduction))
    if half_px < 2:
        return corners
    places = corners.astype(np.float32).reshape(-1, 1, 2)
    found = cv2.cornerSubPix(shades, places, (half_px, half_px), (-1, -1), _SHARPENING)
    return np.asarray(found, np.float64).reshape(4, 2)


@cache
def _detector(family: str, side_px: int, constant: int, *, is_muddy: bool) -> cv2.aruco.ArucoDetector:
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMin = parameters.adaptiveThreshWinSizeMax = _WINDOW_PX
    parameters.adaptiveThreshConstant = constant
    if is_muddy:
        parameters.adaptiveThreshWinSizeMax = _MUD_WINDOW_MAX_PX
        parameters.adaptiveThreshWinSizeStep = _MUD_WINDOW_STEP_PX
        parameters.polygonalApproxAccuracyRate = _MUD_BEND_SHARE
    parameters.minMarkerPerimeterRate = 4.0 * _SIDE_MIN_PX / side_px
    parameters.maxMarkerPerimeterRate = 8.0
    parameters.minMarkerDistanceRate = _NEAR_SHARE  # by default a small tag's white surround takes the place of the tag
    table = dictionary_of(family)
    parameters.errorCorrectionRate = _WRONG_BITS_MAX / table.maxCorrectionBits
    return cv2.aruco.ArucoDetector(table, parameters)
