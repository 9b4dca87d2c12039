import numpy as np
import pytest

from companion.eyes.board import Board, nested_board
from companion.eyes.finding.agreement import doubled_ids, most_agree, odd_ids
from scenarios.camera.lens import CAMERA

SQUARE = np.array([[10.0, 12.0], [50.0, 13.0], [51.0, 52.0], [9.0, 53.0]])
BOARD = Board(nested_board(1.5))
POSE = (np.array([3.0, 0.4, 0.1]), np.array([0.3, -0.2, 4.0]))


@pytest.mark.parametrize(("shift_px", "is_doubled"), [(0.0, False), (30.0, False), (60.0, True)])
def test_one_square_found_twice_is_one_place_and_two_that_cannot_overlap_are_two(
    shift_px: float, is_doubled: bool
) -> None:
    assert doubled_ids({4: [SQUARE, SQUARE + shift_px * np.array([0.8, 0.6])], 5: [SQUARE]}) == (
        {4} if is_doubled else frozenset()
    )


def test_tags_are_odd_once_they_are_a_cell_beside_where_a_pose_has_them() -> None:
    seen = {tag_id: CAMERA.pixels(BOARD.corners_m[tag_id], *POSE)[0] for tag_id in (0, 1, 2)}
    assert odd_ids(CAMERA, BOARD, POSE, seen) == frozenset()
    cell_px = float(np.linalg.norm(seen[0][1] - seen[0][0])) / 8.0
    away = np.array([0.6, -0.8])
    assert odd_ids(CAMERA, BOARD, POSE, seen | {0: seen[0] + 0.7 * cell_px * away}) == frozenset()
    assert odd_ids(CAMERA, BOARD, POSE, seen | {0: seen[0] + 1.4 * cell_px * away}) == {0}


def test_mud_on_one_corner_does_not_make_a_tag_odd() -> None:
    corners = CAMERA.pixels(BOARD.corners_m[0], *POSE)[0]
    bent = corners + np.array([[0.0, 0.0], [0.3, 0.0], [0.0, 0.0], [0.0, 0.0]]) * np.linalg.norm(
        corners[1] - corners[0]
    )
    assert odd_ids(CAMERA, BOARD, POSE, {0: bent}) == frozenset()


def test_as_many_against_a_pose_as_for_it_are_not_most() -> None:
    seen = dict.fromkeys((1, 2, 3, 4), SQUARE)
    assert most_agree(frozenset({1}), seen)
    assert not most_agree(frozenset({1, 2}), seen)
