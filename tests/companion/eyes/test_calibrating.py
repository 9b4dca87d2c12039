"""A camera is found again from what it shows of the board, and how well is told."""

import math
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from companion.eyes.board import load_board
from companion.eyes.calibrating import Shot, calibrate, covered_share, is_new, is_still
from companion.eyes.calibration_commands import quality_lines
from companion.eyes.camera import Camera, vector_of
from companion.eyes.collecting import collect_shots
from companion.eyes.sources.file_source import FolderSource
from link.errors import UserError
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw
from scenarios.camera.lens import CAMERA, SIZE_PX
from tests.companion.eyes.frames import case

BOARD = load_board(None)
FISHEYE = Camera(model="fisheye", matrix=CAMERA.matrix, distortion=np.array([0.02, -0.01, 0.0, 0.0]), size_px=SIZE_PX)
FACING = np.diag([1.0, -1.0, -1.0])


@cache
def shots(count: int, tilt_rad: float = 0.6, *, is_fisheye: bool = False) -> tuple[Shot, ...]:
    """Shots of the board 0.6 to 1.6 m away, with a tenth of a pixel of noise."""
    rng, camera = np.random.default_rng(1), FISHEYE if is_fisheye else CAMERA
    found: list[Shot] = []
    while len(found) < count:
        roll, pitch = rng.uniform(-tilt_rad, tilt_rad, 2).tolist()
        turn = vector_of(matrix_from_quaternion(quaternion_from_roll_pitch_yaw(roll, pitch, 0.4)) @ FACING)
        place = np.array([rng.uniform(-0.8, 0.8), rng.uniform(-0.5, 0.5), rng.uniform(0.6, 1.6)])
        seen = {
            tag_id: camera.pixels(corners, turn, place)[0] + 0.1 * rng.standard_normal((4, 2))
            for tag_id, corners in BOARD.corners_m.items()
            if camera.in_view(corners, turn, place).all()
        }
        if len(seen) > 10:
            found.append(Shot(seen))
    return tuple(found)


@pytest.mark.slow
@pytest.mark.parametrize("camera", [CAMERA, FISHEYE], ids=["pinhole", "fisheye"])
def test_camera_is_found_again(camera: Camera) -> None:
    found, quality = calibrate(shots(16, is_fisheye=camera is FISHEYE), BOARD, SIZE_PX, camera.model)
    assert found.matrix == pytest.approx(camera.matrix, abs=2.0)
    assert quality.rms_px == pytest.approx(0.1 * math.sqrt(2.0), rel=0.15)
    assert quality.focal_std_share < 0.002
    assert all("poor" not in line for line in quality_lines(quality, found.focal_px)[:3])


def test_tags_that_do_not_fit_are_left_out() -> None:
    good = shots(12)
    bent = Shot({tag_id: corners + 4.0 * (tag_id % 3 - 1) for tag_id, corners in good[0].corners_px.items()})
    found, quality = calibrate([bent, *good[1:]], BOARD, SIZE_PX, "pinhole")
    assert quality.rms_px < 0.2
    assert found.focal_px == pytest.approx(CAMERA.focal_px, abs=2.0)


@pytest.mark.slow
def test_too_few_pictures_and_a_board_that_was_never_tilted_say_what_to_do() -> None:
    with pytest.raises(UserError, match="8 are needed"):
        calibrate(shots(12)[:7], BOARD, SIZE_PX, "pinhole")
    with pytest.raises(UserError, match="tilt it"):
        calibrate(shots(12, tilt_rad=0.02), BOARD, SIZE_PX, "pinhole")


@given(shift_px=st.floats(0.0, 200.0), angle_rad=st.floats(-3.1, 3.1))
def test_a_shot_is_new_where_the_board_has_moved_and_still_where_it_has_not(shift_px: float, angle_rad: float) -> None:
    assume(all(abs(shift_px - limit_px) > 1e-6 for limit_px in (1.0, 0.04 * SIZE_PX[0])))
    before = shots(12)[0]
    by = shift_px * np.array([math.cos(angle_rad), math.sin(angle_rad)])
    shot = Shot({tag_id: corners + by for tag_id, corners in before.corners_px.items()})
    assert is_still(before, shot) is bool(np.hypot(*by) < 1.0)
    assert is_new([before], shot, SIZE_PX) is bool(np.hypot(*by) > 0.04 * SIZE_PX[0])


def test_no_corner_covers_nothing_and_many_shots_nearly_all() -> None:
    assert covered_share([], SIZE_PX) == 0.0
    assert covered_share(shots(12), SIZE_PX) > 0.7


@pytest.mark.slow  # twelve pictures are rendered in full and searched in all passes
def test_rendered_pictures_in_a_folder_give_their_camera(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    for index in range(14):
        roll, pitch = rng.uniform(-0.6, 0.6, 2).tolist()
        aside_m = (float(rng.uniform(-0.4, 0.4)), float(rng.uniform(-0.4, 0.4)))
        one = case(
            float(rng.uniform(0.7, 1.5)),
            roll_pitch_yaw_rad=(roll, pitch, 0.5 * index),
            aside_m=aside_m,
            board=BOARD.config,
        )
        cv2.imwrite(str(tmp_path / f"{index:03d}.png"), one.frame.picture.shades)  # type: ignore[attr-defined]  # a whole one
    told: list[str] = []
    found, size_px = collect_shots(FolderSource(tmp_path, start_ns=0, rate_hz=30.0), BOARD, 40, told.append)
    camera, quality = calibrate(found, BOARD, size_px, "pinhole")
    assert quality.rms_px < 0.5
    assert camera.focal_px == pytest.approx(CAMERA.focal_px, rel=0.005)
    assert len(told) == len(found)
