import re
import zlib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.board import Board, BoardConfig, TagConfig, cells_of, ids_of, load_board, nested_board
from companion.eyes.pdf import write_pdf
from companion.eyes.plate import raster_of
from link.errors import UserError
from link.program.toml_config import dump_toml

BOARD = nested_board(1.5)
PIXEL_M = 0.0025


def test_the_shipped_board_is_the_nested_one_of_a_metre_and_a_half() -> None:
    assert load_board(None).config == BOARD


def test_a_board_of_a_file_is_the_one_that_was_written(tmp_path: Path) -> None:
    (tmp_path / "board.toml").write_text(dump_toml(nested_board(0.2, 63)), encoding="utf-8")
    assert load_board(tmp_path / "board.toml").config == nested_board(0.2, 63)


def test_boards_with_ids_of_their_own_share_none() -> None:
    first, second = (load_ids(nested_board(0.5, first_id)) for first_id in (0, len(BOARD.tags)))
    assert not first & second


def load_ids(board: BoardConfig) -> set[int]:
    return {tag.id for tag in board.tags}


def test_a_board_beyond_the_familys_ids_is_refused() -> None:
    with pytest.raises(UserError, match="begin with a lower one"):
        nested_board(1.5, ids_of("36h11") - 10)


@pytest.mark.parametrize(
    ("tags", "why"),
    [
        ([(3, 0.0, 0.1), (3, 0.2, 0.1)], "two tags have the id 3"),
        ([(587, 0.0, 0.1)], "ids 0 to 586"),
        ([(1, 0.3, 0.5)], "beyond the board's edge"),
        ([(1, 0.2, 0.4), (2, -0.2, 0.4)], "1 and 2 overlap or touch"),
        ([(1, 0.0, 0.4), (2, 0.1, 0.1)], "1 and 2 overlap or touch"),
        ([(1, 0.1, 0.04), (2, 0.0, 0.4)], "1 and 2 overlap or touch"),
        ([], "at least one tag"),
    ],
)
def test_a_board_that_cannot_be_is_refused_in_words(
    tmp_path: Path, tags: list[tuple[int, float, float]], why: str
) -> None:
    rows = ",".join(f"{{id={tag_id}, center_m=[{x_m}, 0.0], side_m={side_m}}}" for tag_id, x_m, side_m in tags)
    (tmp_path / "b.toml").write_text(f"size_m = [1.0, 1.0]\ntags = [{rows}]\n", encoding="utf-8")
    with pytest.raises(UserError, match=why):
        load_board(tmp_path / "b.toml")


def test_each_cell_of_each_tag_has_mostly_its_own_colour() -> None:
    # whatever stands in it: only so can the large tag be read
    image = raster_of(BOARD, PIXEL_M)
    for tag in (one for one in BOARD.tags if one.side_m > 0.05):
        side_px = tag.side_m / PIXEL_M
        top = (0.5 * BOARD.size_m[0] - tag.center_m[0] - 0.5 * tag.side_m) / PIXEL_M
        left = (0.5 * BOARD.size_m[1] - tag.center_m[1] - 0.5 * tag.side_m) / PIXEL_M
        edges = np.arange(9) * side_px / 8
        rows, columns = np.round(top + edges).astype(int), np.round(left + edges).astype(int)
        means = np.add.reduceat(np.add.reduceat(image[: rows[-1], : columns[-1]], rows[:-1], 0), columns[:-1], 1)
        means /= np.outer(np.diff(rows), np.diff(columns))
        assert ((means > 0.6) == cells_of("36h11", tag.id)).all()
        assert ((means < 0.4) == ~cells_of("36h11", tag.id)).all()


def test_the_light_of_a_raster_does_not_depend_on_its_pixels() -> None:
    board = BoardConfig(size_m=(0.3, 0.3), tags=(TagConfig(id=11, center_m=(0.013, -0.021), side_m=0.17),))
    # neither divides a cell: each pixel is the mean of what it covers
    assert raster_of(board, 0.3 / 70).mean() == pytest.approx(raster_of(board, 0.3 / 311).mean(), rel=1e-5)


def test_a_page_has_the_boards_rectangles_in_true_size(tmp_path: Path) -> None:
    within = TagConfig(id=9, center_m=(0.01, -0.03), side_m=0.008)
    board = BoardConfig(size_m=(0.2, 0.2), tags=(TagConfig(id=5, center_m=(0.0, 0.0), side_m=0.16), within))
    write_pdf(board, tmp_path / "pad.pdf")
    data = (tmp_path / "pad.pdf").read_bytes()
    box = re.search(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", data)
    assert box is not None
    width_mm, height_mm = (float(number) / 72.0 * 25.4 for number in box.groups())
    assert (width_mm, height_mm) == pytest.approx((210.0, 226.0), abs=0.01)
    pixel_m = 0.0005
    assert np.abs(painted(data, height_mm, pixel_m) - raster_of(board, pixel_m)).mean() < 0.004


def painted(data: bytes, height_mm: float, pixel_m: float) -> NDArray[np.float64]:
    """The board's part of a page, painted with the filled rectangles of its stream at whole pixels."""
    streams = re.findall(rb"stream\r?\n(.*?)endstream", data, re.DOTALL)
    text = next(found for one in streams if (found := inflated(one)) and b" re f" in found).decode("latin-1")
    image = np.ones((400, 400))
    shade = 0.0
    for grey, x, y, w, h in re.findall(r"([\d.]+) g\b|([\d.]+) ([\d.]+) ([\d.]+) (-?[\d.]+) re f", text):
        if grey:
            shade = float(grey)
            continue
        left_mm, top_mm, width, height = (float(one) / 72.0 * 25.4 for one in (x, y, w, h))
        rows = np.round((np.array([height_mm - top_mm, height_mm - top_mm - height]) - 5.0) / (pixel_m * 1000.0))
        columns = np.round((np.array([left_mm, left_mm + width]) - 5.0) / (pixel_m * 1000.0))
        (top, bottom), (left, right) = sorted(rows.astype(int)), sorted(columns.astype(int))
        image[top:bottom, left:right] = shade
    return image


def inflated(stream: bytes) -> bytes:
    try:
        return zlib.decompress(stream)
    except zlib.error:
        return b""


def test_a_small_tag_may_stand_in_a_large_one_and_beside_it() -> None:
    tags = [(1, 0.0, 0.4), (2, 0.0, 0.04), (3, 0.25, 0.08)]
    board = BoardConfig(
        size_m=(1.0, 1.0),
        tags=tuple(TagConfig(id=tag_id, center_m=(x_m, 0.0), side_m=side_m) for tag_id, x_m, side_m in tags),
    )
    assert Board(board).hosts == {1}
