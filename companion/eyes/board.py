"""The board on the pad: square tags of one family, each with its own id, at known places.

Frame P: origin in the middle of the board, x forward along the vehicle, y left, z up; lengths in metres. A tag's upper
edge, as it is printed, points forward.

A printed tag has 8 by 8 cells, the outer ring of them black. The family 36h11 of AprilTag (Olson 2011) has 587 tags of
36 bits, any two of which differ in 11 bits or more however they are turned, so that up to 5 wrong bits can be mended.
OpenCV has them built in.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from importlib import resources
from itertools import combinations
from pathlib import Path
from typing import Annotated, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from link.errors import UserError
from link.program.toml_config import StrictModel, load_config

CELLS = 8
"""Along a side of a tag, its black border included."""

_FAMILIES = {"36h11": cv2.aruco.DICT_APRILTAG_36h11}


@cache
def dictionary_of(family: str) -> cv2.aruco.Dictionary:
    """Return OpenCV's table of the family."""
    return cv2.aruco.getPredefinedDictionary(_FAMILIES[family])


def ids_of(family: str) -> int:
    """Return how many tags the family has; their ids are counted from 0."""
    return len(dictionary_of(family).bytesList)


@cache
def cells_of(family: str, tag_id: int) -> NDArray[np.bool_]:
    """Return the cells of a tag (8, 8), row by row from its upper edge; true is white."""
    cells = dictionary_of(family).generateImageMarker(tag_id, CELLS) > 0
    cells.setflags(write=False)
    return cells


Array = NDArray[np.float64]
Family = Literal["36h11"]
Length = Annotated[float, Field(gt=0.0, le=10.0)]
Place = Annotated[float, Field(ge=-10.0, le=10.0)]

_UNIT_CORNERS = np.array([[0.5, 0.5], [0.5, -0.5], [-0.5, -0.5], [-0.5, 0.5]])  # upper left, then clockwise


class TagConfig(StrictModel):
    """One tag; of several that overlap the later one is on top, and no larger than a cell of the other."""

    id: Annotated[int, Field(ge=0)]
    center_m: tuple[Place, Place]  # forward and left of the board's middle
    side_m: Length  # of the black square


class BoardConfig(StrictModel):
    """A board as its file has it."""

    family: Family = "36h11"  # of AprilTag
    size_m: tuple[Length, Length]  # of the white plate: along and across the vehicle
    tags: tuple[TagConfig, ...]

    @model_validator(mode="after")
    def _check_tags(self) -> "BoardConfig":
        ids = [tag.id for tag in self.tags]
        if not ids:
            raise ValueError("a board needs at least one tag")
        if len(set(ids)) < len(ids):
            raise ValueError(f"two tags have the id {next(one for one in ids if ids.count(one) > 1)}")
        if max(ids) >= ids_of(self.family):
            raise ValueError(f"the family {self.family} has the ids 0 to {ids_of(self.family) - 1}, not {max(ids)}")
        for tag in self.tags:
            for center_m, size_m in zip(tag.center_m, self.size_m, strict=True):
                if abs(center_m) + 0.5 * tag.side_m > 0.5 * size_m:
                    raise ValueError(f"the tag {tag.id} reaches beyond the board's edge")
        for below, above in combinations(self.tags, 2):
            if not _are_apart(below, above) and not _is_nested(above, below):
                raise ValueError(f"the tags {below.id} and {above.id} overlap or touch: white is needed between them")
        return self


@dataclass(frozen=True)
class Board:
    """A board, ready to be looked for.

    Attributes:
        config: what it is made of.
    """

    config: BoardConfig

    @cached_property
    def corners_m(self) -> dict[int, Array]:
        """Of each id the corners (4, 3) in P: upper left as printed, then clockwise seen from above."""
        return {tag.id: _corners(tag) for tag in self.config.tags}

    @cached_property
    def hosts(self) -> frozenset[int]:
        """The ids of tags in which others stand."""
        return frozenset(
            tag.id
            for tag in self.config.tags
            for other in self.config.tags
            if other is not tag and _is_nested(other, tag)
        )

    @cached_property
    def outline_m(self) -> Array:
        """The corners (4, 3) of the plate in P, forward left first, then clockwise seen from above."""
        return np.column_stack([_UNIT_CORNERS * np.array(self.config.size_m), np.zeros(4)])


def _are_apart(one: TagConfig, other: TagConfig) -> bool:
    between_m = 0.5 * (one.side_m + other.side_m)
    return any(abs(a - b) > between_m for a, b in zip(one.center_m, other.center_m, strict=True))


def _is_nested(tag: TagConfig, host: TagConfig) -> bool:
    """Return whether a tag stands in another one and is no larger than what a cell of it is read by."""
    is_within = all(abs(a - b) < 0.5 * host.side_m for a, b in zip(tag.center_m, host.center_m, strict=True))
    return is_within and tag.side_m <= host.side_m / CELLS


def _corners(tag: TagConfig) -> Array:
    return np.column_stack([np.array(tag.center_m) + tag.side_m * _UNIT_CORNERS, np.zeros(4)])


def load_board(path: Path | None) -> Board:
    """Return the board in a TOML file, the default one (1.5 m) for None.

    Raises:
        UserError: the file cannot be read or does not fit.
    """
    if path is not None:
        return Board(load_config(path, BoardConfig))
    with resources.as_file(resources.files("companion.eyes") / "boards" / "default.toml") as default:
        return Board(load_config(default, BoardConfig))


_LARGE_SHARE = 0.8  # of the board's side: a white margin of a cell's width is left for it to be told by
_MIDDLE_SHARE = 0.56  # of the large tag's cell
_SMALL_SHARE = 0.226
_CORE = 2  # cells to each side of the middle in which the small tags are


def nested_board(size_m: float, first_id: int = 0) -> BoardConfig:
    """Return a square board with one large tag, in whose inner cells smaller ones stand.

    The large tag's cell is read by its majority, which a smaller tag and its white surround leave. For a board of 1.5 m
    the sides are 1.2 m, 0.084 m and 0.034 m. Of a camera with 640 pixels a radian, which reads tags from 24 pixels
    on, that is for 32 m, 2.2 m and 0.9 m; the large one leaves the picture below 1.1 m.

    Args:
        size_m: of the plate's side.
        first_id: the ids are this one and those that follow; boards that may be seen together need different ones.

    Raises:
        UserError: there are not that many ids.
    """
    large_m = _LARGE_SHARE * size_m
    cell_m = large_m / CELLS
    found = [((0.0, 0.0), large_m)]
    for row in range(1, CELLS - 1):
        for column in range(1, CELLS - 1):
            center_m = ((0.5 * (CELLS - 1) - row) * cell_m, (0.5 * (CELLS - 1) - column) * cell_m)
            found.extend(_cell_tags(row, column, center_m, cell_m))
    if first_id + len(found) > ids_of("36h11"):
        raise UserError(f"a board needs {len(found)} ids and there are {ids_of('36h11')}: begin with a lower one")
    tags = (
        TagConfig(id=first_id + number, center_m=(round(x_m, 5), round(y_m, 5)), side_m=round(side_m, 5))
        for number, ((x_m, y_m), side_m) in enumerate(found)
    )
    return BoardConfig(size_m=(size_m, size_m), tags=tuple(tags))


def _cell_tags(
    row: int, column: int, center_m: tuple[float, float], cell_m: float
) -> list[tuple[tuple[float, float], float]]:
    """Return the tags within a cell of the large one, places and sides: four small ones, a middle one, or none."""
    middle = 0.5 * (CELLS - 1)
    is_core = max(abs(row - middle), abs(column - middle)) < _CORE
    if is_core and (row + 2 * column) % 4:
        quarter_m = 0.25 * cell_m
        shifts = ((1, 1), (1, -1), (-1, 1), (-1, -1))
        return [((center_m[0] + a * quarter_m, center_m[1] + b * quarter_m), _SMALL_SHARE * cell_m) for a, b in shifts]
    if is_core or (row + column) % 2:
        return [(center_m, _MIDDLE_SHARE * cell_m)]
    return []
