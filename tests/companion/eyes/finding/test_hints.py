import cv2
import numpy as np
import pytest

from companion.eyes.board import load_board, nested_board
from companion.eyes.finding.hints import HINTS, hint_of
from companion.eyes.picture import Gray, WholePicture
from tests.companion.eyes.frames import case

BOARD = load_board(None)


def picture(first_id: int | None) -> Gray:
    board = None if first_id is None else nested_board(1.5, first_id)
    shown = case(4.0, board=board).frame.picture
    assert isinstance(shown, WholePicture)
    return shown.shades


def printed(table: int) -> Gray:
    """A tag of another table on a roof."""
    shades = np.full((480, 640), 180, np.uint8)
    tag = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(table), 11, 140)
    shades[150:290, 200:340] = 20 + tag // 2
    noise = np.random.default_rng(5).normal(0.0, 3.0, shades.shape)
    return np.clip(cv2.GaussianBlur(shades, (0, 0), 0.8) + noise, 0.0, 255.0).astype(np.uint8)


def told_of(shades: Gray) -> list[str]:
    return [text for number in range(HINTS) if (text := hint_of(shades, BOARD, number)) is not None]


def test_a_mirrored_picture_is_told() -> None:
    (told,) = told_of(np.ascontiguousarray(picture(0)[:, ::-1]))
    assert told.startswith("the pictures are mirrored")


def test_a_print_in_white_on_black_is_told() -> None:
    (told,) = told_of(255 - picture(0))
    assert "black and white exchanged" in told


@pytest.mark.parametrize(
    ("table", "name"),
    [
        (cv2.aruco.DICT_APRILTAG_25h9, "AprilTag 25h9"),
        (cv2.aruco.DICT_APRILTAG_36h10, "AprilTag 36h10"),
        (cv2.aruco.DICT_6X6_50, "ArUco 6x6"),
    ],
)
def test_tags_of_another_family_are_named(table: int, name: str) -> None:
    (told,) = told_of(printed(table))
    assert f"tags of {name} are seen" in told
    assert BOARD.config.family in told


def test_roofs_and_noise_speak_for_no_cause() -> None:
    noise = np.random.default_rng(8).integers(0, 256, (720, 1280)).astype(np.uint8)
    for shades in (picture(None), noise):
        assert told_of(shades) == []


def test_a_covered_lens_and_a_picture_that_is_overexposed_are_told() -> None:
    rng = np.random.default_rng(6)
    dark = np.clip(rng.normal(6.0, 3.0, (720, 1280)), 0.0, 255.0).astype(np.uint8)
    (told,) = told_of(dark)
    assert "is the lens covered" in told
    (told,) = told_of(np.clip(20.0 * picture(0), 0.0, 255.0).astype(np.uint8))
    assert "overexposed" in told
    (told,) = told_of(np.zeros((1, 1), np.uint8))
    assert "differ by 0 of 255" in told
