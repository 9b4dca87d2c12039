"""Which tags of the board can be read where they are expected; a tag counts only if its cells can be seen.

Each cell is sampled in a grid, and its shade is the mean: with a smaller tag in it, that is still its own colour.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import CELLS, Board, cells_of
from companion.eyes.camera import Camera
from companion.eyes.picture import Part

Array = NDArray[np.float64]
Pose = tuple[Array, Array]

SIDE_MIN_PX = 12.0  # 1.5 pixels a cell: below, neighbouring cells cannot be told apart
TAGS_MAX = 12  # that are looked at in a frame: more make it slower and the pose hardly better
_FEW = 3  # tags
_GRID, _HOST_GRID = 2, 4  # samples along a cell's side; more where another tag may stand in it
_CELLS_MIN = 32  # in the picture; chance reads them with at most 12 % wrong less than once in 100,000 times
_WRONG_SHARE_MAX = 0.12
CONTRAST_MIN = 12.0
"""Shades between black and white: less is not read."""


def expected_tags(camera: Camera, board: Board, pose: Pose) -> dict[int, float]:
    """Return the ids that should be seen at a pose, the largest in the picture first, with their sides in pixels."""
    rotation, translation = pose
    ids = list(board.corners_m)
    corners = np.concatenate([board.corners_m[tag_id] for tag_id in ids])
    ahead = camera.in_view(corners, rotation, translation, -float(max(camera.size_px))).reshape(-1, 4).all(axis=1)
    pixels, _ = camera.pixels(corners, rotation, translation)
    quads = pixels.reshape(-1, 4, 2)
    sides = np.linalg.norm(quads - np.roll(quads, -1, axis=1), axis=2).min(axis=1)
    limit = np.array(camera.size_px, np.float64) - 1.0
    overlaps = ((quads.max(axis=1) > 0.0) & (quads.min(axis=1) < limit)).all(axis=1)
    is_seen = (ahead & overlaps & (sides >= SIDE_MIN_PX)).tolist()
    return {ids[index]: float(sides[index]) for index in np.argsort(-sides).tolist() if is_seen[index]}


def read_best(part: Part, camera: Camera, board: Board, pose: Pose) -> tuple[dict[int, float], int]:
    """Return the sides in pixels of the tags that are read at a pose, the largest first, and how many might have been.

    Where hardly any of the largest is read, the others are tried: those beside a tag that fits may fit as well.
    """
    expected = expected_tags(camera, board, pose)
    ids = read_tags(part, camera, board, pose, list(expected)[:TAGS_MAX])
    if len(ids) < _FEW and len(expected) > TAGS_MAX:
        ids = read_tags(part, camera, board, pose, list(expected))[:TAGS_MAX]
    return {tag_id: expected[tag_id] for tag_id in ids}, len(expected)


def read_tags(part: Part, camera: Camera, board: Board, pose: Pose, ids: list[int]) -> list[int]:
    """Return those of `ids` whose cells are seen at a pose in a part of the picture."""
    hosts = [tag_id for tag_id in ids if tag_id in board.hosts]
    others = [tag_id for tag_id in ids if tag_id not in board.hosts]
    read = _read_alike(part, camera, board, pose, hosts, grid=_HOST_GRID) | _read_alike(
        part, camera, board, pose, others, grid=_GRID
    )
    return [tag_id for tag_id in ids if tag_id in read]


def _read_alike(part: Part, camera: Camera, board: Board, pose: Pose, ids: list[int], *, grid: int) -> set[int]:
    """Return those of `ids` that are read by `grid` samples along each cell's side."""
    if not ids:
        return set()
    pixels, _ = camera.pixels(np.concatenate([_samples(board, tag_id, grid) for tag_id in ids]), *pose)
    at = pixels.reshape(len(ids), -1, 2)
    inside = part.holds(at)
    seen = part.sample(at).reshape(len(ids), CELLS * CELLS, -1).mean(axis=2)
    is_inside = np.asarray(inside.reshape(len(ids), CELLS * CELLS, -1).all(axis=2))
    return {
        tag_id
        for index, tag_id in enumerate(ids)
        if _is_read(seen[index], is_inside[index], cells_of(board.config.family, tag_id).ravel())
    }


def _is_read(seen: NDArray[np.float32], inside: NDArray[np.bool_], white: NDArray[np.bool_]) -> bool:
    """Return whether the cells' shades are those of the tag."""
    if inside.sum() < _CELLS_MIN or not (inside & white).any() or not (inside & ~white).any():
        return False
    bright, dark = float(seen[inside & white].mean()), float(seen[inside & ~white].mean())
    if bright - dark < CONTRAST_MIN:
        return False
    wrong = ((seen > 0.5 * (bright + dark)) != white) & inside
    return bool(wrong.sum() <= _WRONG_SHARE_MAX * inside.sum())


def _samples(board: Board, tag_id: int, grid: int) -> Array:
    """Return where a tag's cells are sampled (64 * grid^2, 3) in P: cell by cell from the upper left, row by row."""
    upper_left, upper_right, _, lower_left = board.corners_m[tag_id]
    rows, columns = _shares(grid)
    return np.asarray(upper_left + rows * (lower_left - upper_left) + columns * (upper_right - upper_left))


@cache
def _shares(grid: int) -> tuple[Array, Array]:
    """Return of each sample how far down the tag it is, and how far to the right, as shares of its side."""
    within = (np.arange(grid) + 0.5) / grid
    row, column, down, right = np.meshgrid(np.arange(CELLS), np.arange(CELLS), within, within, indexing="ij")
    down_share, right_share = (row + down) / CELLS, (column + right) / CELLS
    return down_share.reshape(-1, 1).astype(np.float64), right_share.reshape(-1, 1).astype(np.float64)
