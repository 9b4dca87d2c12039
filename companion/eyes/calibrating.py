"""A camera's calibration from pictures of the board, and how good it is; pure.

Model: OpenCV's pinhole with two radial and two tangential coefficients, or its fisheye with four, by least squares over
the corners of the board's tags (Zhang 2000). How good: what is left of the corners' distances, and by how much two
cameras differ that each half of the pictures gives alone; the whole errs by about half of that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from companion.eyes.board import Board
from companion.eyes.camera import Camera, Model, matrix_of
from companion.eyes.finding.search import search
from companion.eyes.picture import Gray, Part, whole
from link.errors import UserError

Array = NDArray[np.float64]
Size = tuple[int, int]

TAGS_MIN = 3  # twelve corners: a pose and six that tell of the camera
SHOTS_MIN = 8
_SIDE_MIN_PX = 24.0  # of a tag whose corners are told to a tenth of a pixel
_MOVED_SHARE = 0.04  # of the picture's width, by which the board has to be elsewhere to tell anything new
_OUTLIER = 3.0  # times the median of the tags' distances: corners of something else, a bent board, or one that moved
_CELLS = (8, 5)  # of the picture, along and across, in which corners are counted
_FLAT_RAD = math.radians(10.0)  # boards that all face the camera do not tell the focal length
_FINER_PASSES = 4  # of a search: each finer than the one before; what follows is coarse again
_GRID = (9, 6)  # of pixels at which two cameras are compared


@dataclass(frozen=True)
class Shot:
    """The board in one picture: of each id the corners (4, 2) in pixels."""

    corners_px: dict[int, Array]


class Quality(Struct, frozen=True, kw_only=True):
    """How good a calibration is.

    Attributes:
        shots: that it rests on.
        left_out: that did not fit.
        rms_px: of what is left of the corners' distances.
        halves_px: by which the cameras of both halves differ, root mean square over the picture.
        focal_std_share: standard deviation of the focal length, as a share of it: half of what the halves differ by.
        covered_share: of the picture's parts in which corners were seen.
        tilt_max_rad: of the board against the picture's plane.
    """

    shots: int
    left_out: int
    rms_px: float
    halves_px: float
    focal_std_share: float
    covered_share: float
    tilt_max_rad: float


def shot_of(shades: Gray, board: Board) -> Shot | None:
    """Return what a picture (rows, columns) shows of the board, None where that is too little."""
    rows, columns = shades.shape
    corners: dict[int, Array] = {}
    for number, found in enumerate(search(Part(shades, whole((columns, rows))), board)):
        large = {tag_id: places for tag_id, places in found.corners_px.items() if _side_px(places) >= _SIDE_MIN_PX}
        corners = corners | large if number < _FINER_PASSES else large | corners
    return Shot(corners) if len(corners) >= TAGS_MIN else None


def is_new(shots: Sequence[Shot], shot: Shot, size_px: Size) -> bool:
    """Return whether a shot has the board elsewhere, or turned otherwise, than all before."""
    return all(_moved_px(shot, before) > _MOVED_SHARE * size_px[0] for before in shots)


def is_still(before: Shot | None, shot: Shot) -> bool:
    """Return whether the board has not moved by a pixel since the picture before: nothing is smeared then."""
    return before is not None and _moved_px(before, shot) < 1.0


def covered_share(shots: Sequence[Shot], size_px: Size) -> float:
    """Return the share of the picture's parts in which corners were seen."""
    along, across = _CELLS
    seen = np.zeros((across, along), np.bool_)
    for shot in shots:
        for corners in shot.corners_px.values():
            at = np.clip(corners / np.array(size_px) * np.array(_CELLS), 0.0, np.array(_CELLS) - 1.0).astype(int)
            seen[at[:, 1], at[:, 0]] = True
    return float(seen.mean())


def calibrate(shots: Sequence[Shot], board: Board, size_px: Size, model: Model) -> tuple[Camera, Quality]:
    """Return the camera that all shots agree with but for those that do not fit.

    Raises:
        UserError: there are too few shots, or the board was never tilted in them.
    """
    _check(shots)
    kept = _without_outliers(shots, _fit(shots, board, size_px, model)[1])
    _check(kept)
    kept = _without_outliers(kept, _fit(kept, board, size_px, model)[1])
    _check(kept)
    camera, errors_px, rotations = _fit(kept, board, size_px, model)
    tilt_rad = max(math.acos(min(abs(float(matrix_of(rotation)[2, 2])), 1.0)) for rotation in rotations)
    if tilt_rad < _FLAT_RAD:
        raise UserError("the board faces the camera in all pictures: tilt it by up to 45 degrees to all sides")
    halves = [_fit(kept[first::2], board, size_px, model)[0] for first in (0, 1)]
    quality = Quality(
        shots=len(kept),
        left_out=len(shots) - len(kept),
        rms_px=float(np.sqrt(np.mean(np.concatenate(errors_px) ** 2))),
        halves_px=_difference_px(*halves),
        focal_std_share=0.5 * abs(halves[0].focal_px - halves[1].focal_px) / camera.focal_px,
        covered_share=covered_share(kept, size_px),
        tilt_max_rad=tilt_rad,
    )
    return camera, quality


def _check(shots: Sequence[Shot]) -> None:
    if len(shots) < SHOTS_MIN:
        raise UserError(
            f"{len(shots)} pictures show {TAGS_MIN} or more tags of the board, {SHOTS_MIN} are needed, 20 or more are "
            "good: bring the board nearer, or give the one that was printed by --board"
        )


def _without_outliers(shots: Sequence[Shot], errors_px: list[Array]) -> list[Shot]:
    """Return the shots with the tags that fit, as far as enough are left; errors are each shot's (tags,)."""
    limit_px = _OUTLIER * float(np.median(np.concatenate(errors_px)))
    kept = []
    for shot, errors in zip(shots, errors_px, strict=True):
        fits = [one for one, error_px in zip(shot.corners_px.items(), errors, strict=True) if error_px <= limit_px]
        if len(fits) >= TAGS_MIN:
            kept.append(Shot(dict(fits)))
    return kept


def _fit(shots: Sequence[Shot], board: Board, size_px: Size, model: Model) -> tuple[Camera, list[Array], list[Array]]:
    """Return a camera, each shot's distances in pixels (tags,), root mean square, and the boards' rotation vectors."""
    places = [np.concatenate([board.corners_m[tag_id] for tag_id in shot.corners_px]) for shot in shots]
    pixels = [np.concatenate(list(shot.corners_px.values())) for shot in shots]
    wanted = [one.reshape(-1, 1, 3).astype(np.float32) for one in places]
    seen = [one.reshape(-1, 1, 2).astype(np.float32) for one in pixels]
    start = np.array([[size_px[0], 0.0, 0.5 * size_px[0]], [0.0, size_px[0], 0.5 * size_px[1]], [0.0, 0.0, 1.0]])
    try:
        if model == "fisheye":
            flags = cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW
            _, matrix, distortion, turns, shifts = cv2.fisheye.calibrate(
                [one.reshape(1, -1, 3).astype(np.float64) for one in wanted],
                [one.reshape(1, -1, 2).astype(np.float64) for one in seen],
                size_px,
                start,
                np.zeros((4, 1)),
                flags=flags,
            )
        else:
            _, matrix, distortion, turns, shifts = cv2.calibrateCamera(
                wanted, seen, size_px, start, np.zeros(5), flags=cv2.CALIB_FIX_K3
            )
    except cv2.error as error:
        raise UserError(f"no camera explains the pictures: {str(error).splitlines()[0][:120]}") from None
    camera = Camera(
        model=model,
        matrix=np.asarray(matrix, np.float64),
        distortion=np.asarray(distortion, np.float64).ravel(),
        size_px=size_px,
    )
    rotations = [np.asarray(turn, np.float64).ravel() for turn in turns]
    errors = [
        camera.pixels(place, rotation, np.asarray(shift, np.float64).ravel())[0] - pixel
        for place, pixel, rotation, shift in zip(places, pixels, rotations, shifts, strict=True)
    ]
    return camera, [np.sqrt(np.mean(np.sum(one**2, axis=1).reshape(-1, 4), axis=1)) for one in errors], rotations


def _difference_px(one: Camera, other: Camera) -> float:
    """Return how far apart two cameras have what each pixel of a grid sees, root mean square."""
    width, height = one.size_px
    at = np.stack(np.meshgrid(np.linspace(0.0, width - 1.0, _GRID[0]), np.linspace(0.0, height - 1.0, _GRID[1])), -1)
    grid = at.reshape(-1, 2)
    rays = np.column_stack([one.rays(grid), np.ones(len(grid))])
    seen, _ = other.pixels(rays, np.zeros(3), np.zeros(3))
    return float(np.sqrt(np.mean(np.sum((seen - grid) ** 2, axis=1))))


def _side_px(corners: Array) -> float:
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min())


def _moved_px(one: Shot, other: Shot) -> float:
    """Return how far the corners have moved that both shots have, on average; infinite where they share none."""
    common = one.corners_px.keys() & other.corners_px.keys()
    if not common:
        return math.inf
    return float(np.mean([np.linalg.norm(one.corners_px[i] - other.corners_px[i], axis=1).mean() for i in common]))
