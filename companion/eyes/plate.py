"""What is black and what is white on a board: rectangles in the order in which they are painted.

A white surround of one cell is painted under each tag that stands within another one, so that it can be told on black.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import CELLS, BoardConfig, TagConfig, cells_of


class Rectangle(NamedTuple):
    """An upright rectangle on the plate, in P: between two places forward and two to the left."""

    forward_m: tuple[float, float]
    left_m: tuple[float, float]
    is_white: bool


def rectangles_of(board: BoardConfig) -> Iterator[Rectangle]:
    """Yield the rectangles of the plate, to be painted in this order on white."""
    for tag in board.tags:
        yield _square(tag, 0.5 * tag.side_m * (1.0 + 2.0 / CELLS), is_white=True)
        yield _square(tag, 0.5 * tag.side_m, is_white=False)
        yield from _white_runs(tag, cells_of(board.family, tag.id))


def _square(tag: TagConfig, half_m: float, *, is_white: bool) -> Rectangle:
    x_m, y_m = tag.center_m
    return Rectangle((x_m - half_m, x_m + half_m), (y_m - half_m, y_m + half_m), is_white)


def _white_runs(tag: TagConfig, cells: NDArray[np.bool_]) -> Iterator[Rectangle]:
    """Yield the white cells of a tag, those beside each other in a row as one: seams would show in print."""
    cell_m = tag.side_m / CELLS
    forward_m, left_m = tag.center_m[0] + 0.5 * tag.side_m, tag.center_m[1] + 0.5 * tag.side_m
    for row in range(CELLS):
        edges = np.flatnonzero(np.diff(np.concatenate([[0], cells[row].astype(np.int8), [0]])))
        for begin, end in edges.reshape(-1, 2).tolist():
            yield Rectangle(
                (forward_m - (row + 1) * cell_m, forward_m - row * cell_m),
                (left_m - end * cell_m, left_m - begin * cell_m),
                is_white=True,
            )


def raster_of(board: BoardConfig, pixel_m: float) -> NDArray[np.float32]:
    """Return the plate as an image (rows, columns) from 0 (black) to 1 (white), each pixel the mean of what it covers.

    Args:
        board: of which the plate is.
        pixel_m: a pixel's side. The first row is the forward edge, the first column the left one.
    """
    shape = tuple(round(size_m / pixel_m) for size_m in board.size_m)
    image = np.ones(shape, np.float32)
    for tag in board.tags:
        cells = np.pad(cells_of(board.family, tag.id), 1, constant_values=True)  # with its white surround
        half = 0.5 * tag.side_m * len(cells) / CELLS
        begins_m = [0.5 * size_m - center_m - half for size_m, center_m in zip(board.size_m, tag.center_m, strict=True)]
        (row, down), (column, across) = (
            _coverage(begin_m / pixel_m, 2.0 * half / pixel_m, len(cells), count)
            for begin_m, count in zip(begins_m, shape, strict=True)
        )
        part = image[row : row + len(down), column : column + len(across)]
        part *= 1.0 - np.outer(down.sum(axis=1), across.sum(axis=1)).astype(np.float32)
        part += down @ cells.astype(np.float32) @ across.T
    return image


def _coverage(begin: float, length: float, cells: int, count: int) -> tuple[int, NDArray[np.float32]]:
    """Return the first pixel that a row of cells touches, and of it and those after it the shares of each cell.

    Args:
        begin: of the row, in pixels.
        length: of the row, in pixels.
        cells: that it has.
        count: pixels that there are; what is beyond them is left out.
    """
    edges = begin + length * np.arange(cells + 1) / cells
    first, last = max(int(np.floor(begin)), 0), min(int(np.ceil(begin + length)), count)
    pixels = np.arange(first, last)[:, None]
    ends = np.minimum(edges[1:], pixels + 1.0) - np.maximum(edges[:-1], pixels)
    return first, np.maximum(ends, 0.0).astype(np.float32)
