import math

import numpy as np
import pytest

from companion.eyes.board import load_board
from link.frames.rotations import matrix_from_quaternion
from scenarios.camera.rendering import Renderer, Vehicle
from scenarios.eyes.draws import ANGLE_MAX_RAD, RANGE_M, draw_frame, draw_light
from scenarios.eyes.study import study
from scenarios.eyes.tables import summary_of, text_lines
from tests.companion.eyes.frames import MOUNTING, ROOF_M

CAR = Vehicle(board=load_board(None).config, length_m=4.2, width_m=1.8, roof_height_m=ROOF_M)


@pytest.mark.slow
def test_drawn_frames_are_within_their_ranges_and_show_a_place_near_the_pad() -> None:
    rng = np.random.default_rng(1)
    renderer = Renderer(CAR, 0.0, rng)
    for _ in range(4):
        drawn = draw_frame(renderer, draw_light("dusk", rng), MOUNTING, ROOF_M, rng)
        assert RANGE_M[0] <= drawn.range_m <= RANGE_M[1]
        assert 0.0 <= drawn.angle_rad <= ANGLE_MAX_RAD
        camera_to_pad_m = float(np.linalg.norm(drawn.away_flu_m - MOUNTING.position_flu_m))
        assert camera_to_pad_m == pytest.approx(drawn.range_m, abs=0.6)  # the place aimed at is within 0.57 m of it
        assert drawn.frame.orientation_wxyz is not None
        up = (matrix_from_quaternion(drawn.frame.orientation_wxyz) @ drawn.R_BP)[2, 2]
        assert math.acos(min(up, 1.0)) < 0.3  # the deck is level within six standard deviations


@pytest.mark.slow
def test_a_study_is_the_same_each_time_and_its_table_counts_each_frame() -> None:
    looks, again = ([*study(3, 5, has_board=True, tell=lambda _: None)] for _ in range(2))
    assert looks == again
    bare = [*study(2, 5, has_board=False, tell=lambda _: None)]
    table = summary_of([*looks, *bare])
    assert (table["frames"], table["frames_without_the_board"], table["false_detections"]) == (3, 2, 0)
    assert sum(row["frames"] for row in table["by_range_m"].values()) == 3
    assert "0 false detections" in text_lines(table)[-1]
