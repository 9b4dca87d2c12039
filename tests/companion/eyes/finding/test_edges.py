"""Where edges are, against the camera's own model of where a pose has them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.board import CELLS, load_board
from companion.eyes.camera import matrix_of, vector_of
from companion.eyes.finding.edges import EdgePoints, edge_points, find_crossings
from companion.eyes.finding.reading import expected_tags
from companion.eyes.picture import whole
from scenarios.camera.lens import CAMERA, SIZE_PX
from tests.companion.eyes.frames import MOUNTING, Case, case

Array = NDArray[np.float64]

BOARD = load_board(None)


def pose_of(one: Case) -> tuple[Array, Array]:
    R_CB = MOUNTING.R_BC.T
    return vector_of(R_CB @ one.R_BP), R_CB @ (one.away_flu_m - MOUNTING.position_flu_m)


def points_in_view(one: Case) -> EdgePoints:
    sides_px = {tag_id: px for tag_id, px in expected_tags(CAMERA, BOARD, pose_of(one)).items() if 60.0 < px < 300.0}
    points = edge_points([BOARD.corners_m[tag_id] for tag_id in sides_px], list(sides_px.values()), CELLS)
    return points.only(CAMERA.in_view(points.places_m, *pose_of(one), 20.0))


@pytest.mark.parametrize("change", [(0.0012, 0.0, 0.0), (0.0, 0.0012, 0.0), (-0.001, 0.001, 0.0)])
def test_an_edge_seen_from_aside_is_as_far_off_as_the_slopes_say(change: tuple[float, float, float]) -> None:
    """From aside the board's right angles are none in the picture: what moves along an edge must not count."""
    one = case(0.35, board=BOARD.config, roll_pitch_yaw_rad=(0.6, 0.5, 0.4))
    rotation, translation = pose_of(one)
    points = points_in_view(one)
    assert len(points.places_m) > 20
    part = one.frame.picture.part(whole(SIZE_PX))
    off = (rotation, translation + matrix_of(rotation) @ np.array(change))
    right = find_crossings(part, CAMERA, points, (rotation, translation), 8.0)
    found = find_crossings(part, CAMERA, points, off, 8.0)
    seen = right.is_seen & found.is_seen
    assert seen.sum() > 20
    expected_px = found.slopes[seen] @ np.concatenate([np.zeros(3), translation - off[1]]) + right.distance_px[seen]
    assert float(np.median(np.abs(found.distance_px[seen] - expected_px))) < 0.3
    assert float(np.quantile(np.abs(expected_px), 0.9)) > 1.0
