"""Of two poses that look alike the right one is taken, or none."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.eyes.camera import matrix_of, vector_of
from companion.eyes.finding.choosing import Candidate, choose, mirrored, tilt_stds
from companion.eyes.finding.pose import Pose, Refined
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw

FACING = np.diag([1.0, -1.0, -1.0])
AWAY = np.array([0.4, -0.3, 12.0])


def tilted(roll_rad: float, pitch_rad: float) -> Pose:
    return vector_of(matrix_from_quaternion(quaternion_from_roll_pitch_yaw(roll_rad, pitch_rad, 0.7)) @ FACING), AWAY


def candidate(pose: Pose, *, squares_px2: float, stds: float, tags: int = 1) -> Candidate:
    refined = Refined(
        pose=pose,
        covariance=1e-4 * np.eye(6),
        rms_px=0.1,
        points=100 * tags,
        squares_px2=squares_px2,
        variance_px2=0.05,
        independent=80.0 * tags,
    )
    return Candidate(refined=refined, tags=tuple(range(tags)), tilt_stds=stds, is_complete=True)


@given(roll_rad=st.floats(-0.9, 0.9), pitch_rad=st.floats(-0.9, 0.9))
def test_the_mirrored_pose_looks_the_same_but_for_perspective_and_leads_back(roll_rad: float, pitch_rad: float) -> None:
    pose = tilted(roll_rad, pitch_rad)
    other = mirrored(pose)
    sight = AWAY / np.linalg.norm(AWAY)
    across = np.eye(3) - np.outer(sight, sight)
    np.testing.assert_allclose(across @ matrix_of(other[0])[:, :2], across @ matrix_of(pose[0])[:, :2], atol=1e-6)
    np.testing.assert_allclose(matrix_of(mirrored(other)[0]), matrix_of(pose[0]), atol=1e-4)  # turns near pi


def test_edges_tell_the_right_one_where_perspective_shows() -> None:
    pose = tilted(0.4, 0.1)
    right, wrong = candidate(pose, squares_px2=4.0, stds=2.0), candidate(mirrored(pose), squares_px2=9.0, stds=2.0)
    assert choose([wrong, right]) == (right, None)


def test_gravity_tells_the_right_one_where_edges_do_not() -> None:
    pose = tilted(0.4, 0.1)
    level, leaning = candidate(pose, squares_px2=4.0, stds=0.3), candidate(mirrored(pose), squares_px2=4.0, stds=3.9)
    assert choose([leaning, level]) == (level, None)


@pytest.mark.parametrize(("roll_rad", "is_seen"), [(0.4, False), (0.1, True)])
def test_poses_that_nothing_tells_apart_are_refused_unless_they_are_nearly_one(roll_rad: float, is_seen: bool) -> None:
    pose = tilted(roll_rad, 0.0)
    one, other = candidate(pose, squares_px2=4.0, stds=1.0), candidate(mirrored(pose), squares_px2=4.1, stds=1.0)
    assert choose([one, other]) == ((one, other) if is_seen else None)


def test_a_pose_at_which_few_tags_are_read_is_not_better_for_having_fewer_edges_to_agree_with() -> None:
    pose = tilted(0.4, 0.1)
    many = candidate(pose, squares_px2=36.0, stds=1.0, tags=9)
    few = candidate(mirrored(pose), squares_px2=4.0, stds=0.2, tags=1)
    assert choose([few, many]) == (many, None)


def test_a_board_that_would_stand_on_edge_is_no_deck() -> None:
    assert choose([candidate(tilted(0.1, 0.1), squares_px2=4.0, stds=4.1)]) is None
    upright = matrix_from_quaternion(quaternion_from_roll_pitch_yaw(0.5 * math.pi, 0.0, 0.0))
    assert tilt_stds(upright, is_level_known=True) > 10.0
    assert tilt_stds(upright, is_level_known=False) < tilt_stds(upright, is_level_known=True)
