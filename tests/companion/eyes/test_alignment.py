from math import radians

import numpy as np
import pytest

from companion.eyes.alignment import Turned, is_told_wrong, no_alignment, turned_of, update_alignment
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw

TOLD_STD_RAD = 0.005


def turn(roll: float, pitch: float, yaw: float) -> np.ndarray:
    return matrix_from_quaternion(quaternion_from_roll_pitch_yaw(roll, pitch, yaw))


def seen(
    off_rad: tuple[float, float], deck_rad: tuple[float, float], yaws_rad: np.ndarray, away_m: float = 1.5
) -> Turned:
    """Return what is made of looks at a deck, half a second apart, by a drone that tilts and stands at these yaws."""
    rng = np.random.default_rng(6)
    R_off = turn(off_rad[0], off_rad[1], 0.0)  # from the told camera to the true one
    R_WP = turn(deck_rad[0], deck_rad[1], 0.3)
    alignment = no_alignment()
    for index, yaw_rad in enumerate(yaws_rad):
        R_WB = turn(0.08 * float(rng.standard_normal()), 0.08 * float(rng.standard_normal()), yaw_rad)
        R_BP = (
            R_off.T
            @ R_WB.T
            @ R_WP
            @ turn(0.01 * float(rng.standard_normal()), 0.01 * float(rng.standard_normal()), 0.0)
        )
        alignment = update_alignment(alignment, index * 500_000_000, away_m, R_BP, R_WB)
    return turned_of(alignment)


def test_a_drone_that_turns_over_the_pad_tells_a_turned_camera_from_a_tilted_deck() -> None:
    off_rad = (radians(3.0), radians(-1.0))
    turned = seen(off_rad, (0.06, -0.04), np.linspace(0.0, 3.0, 40))
    assert (turned.about_x_rad, turned.about_y_rad) == pytest.approx(off_rad, abs=3.0 * turned.std_rad)
    assert is_told_wrong(turned, TOLD_STD_RAD)


def test_a_camera_that_is_mounted_as_told_is_not_blamed_for_a_tilted_deck() -> None:
    assert not is_told_wrong(seen((0.002, -0.003), (0.09, 0.05), np.linspace(0.0, 3.0, 40)), TOLD_STD_RAD)


def test_without_a_turn_neither_is_blamed() -> None:
    turned = seen((radians(3.0), 0.0), (0.06, -0.04), np.full(200, 0.7))
    assert turned.std_rad > 0.05
    assert not is_told_wrong(turned, TOLD_STD_RAD)


def test_pads_far_away_and_frames_that_follow_at_once_say_nothing() -> None:
    assert seen((0.05, 0.0), (0.0, 0.0), np.linspace(0.0, 3.0, 20), away_m=5.0) == turned_of(no_alignment())
    once = update_alignment(no_alignment(), 10**9, 1.0, turn(0.1, 0.0, 0.0), np.eye(3))
    assert update_alignment(once, 10**9 + 33_000_000, 1.0, turn(0.1, 0.0, 0.0), np.eye(3)) is once
