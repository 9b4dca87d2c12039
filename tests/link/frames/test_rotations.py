"""Rotations and axis conventions against their laws and against scipy."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from link.frames import rotations
from link.messages import Quaternion, Vector3

ANGLES = st.floats(-3.1, 3.1)
COMPONENTS = st.floats(-1e3, 1e3)
VECTORS = st.tuples(COMPONENTS, COMPONENTS, COMPONENTS)

SEED = 20261121
Q: Quaternion = rotations.normalized((0.6, -0.3, 0.5, 0.2))
P: Quaternion = rotations.normalized((0.1, 0.7, -0.4, 0.55))


def random_quaternions(count: int) -> list[Quaternion]:
    rows = Rotation.random(count, rng=np.random.default_rng(SEED)).as_quat(scalar_first=True)
    return [rotations.canonical(row.tolist()) for row in rows]


def scipy_rotation(q: Quaternion) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


def test_enu_to_ned_swaps_the_horizontal_axes_and_points_down() -> None:
    assert rotations.ned_from_enu((1.0, 2.0, 3.0)) == (2.0, 1.0, -3.0)


def test_flu_to_frd_keeps_forward() -> None:
    assert rotations.frd_from_flu((1.0, 2.0, 3.0)) == (1.0, -2.0, -3.0)


@given(VECTORS)
def test_vector_conversions_return_when_undone(vector: Vector3) -> None:
    assert rotations.enu_from_ned(rotations.ned_from_enu(vector)) == vector
    assert rotations.flu_from_frd(rotations.frd_from_flu(vector)) == vector


@given(ANGLES)
def test_yaw_conversion_returns_when_undone(yaw_rad: float) -> None:
    back_rad = rotations.yaw_enu_from_ned(rotations.yaw_ned_from_enu(yaw_rad))
    assert abs(rotations.wrap_angle(back_rad - yaw_rad)) < 1e-12


@pytest.mark.parametrize(
    ("yaw_enu_rad", "yaw_ned_rad"), [(0.0, pi / 2), (pi / 2, 0.0), (pi / 6, pi / 3), (-pi / 2, pi), (3.0, pi / 2 - 3.0)]
)
def test_yaw_is_counted_from_north_clockwise_in_ned(yaw_enu_rad: float, yaw_ned_rad: float) -> None:
    assert rotations.yaw_ned_from_enu(yaw_enu_rad) == pytest.approx(yaw_ned_rad, abs=1e-12)


@given(st.floats(-1e4, 1e4))
def test_wrapped_angle_is_the_same_angle_within_half_a_turn(angle_rad: float) -> None:
    wrapped = rotations.wrap_angle(angle_rad)
    assert -pi < wrapped <= pi
    assert np.cos(wrapped) == pytest.approx(np.cos(angle_rad), abs=1e-9)
    assert np.sin(wrapped) == pytest.approx(np.sin(angle_rad), abs=1e-9)


def test_wrap_angle_takes_minus_pi_to_pi() -> None:
    assert rotations.wrap_angle(-pi) == pi


def test_mavlink_quaternion_turns_frd_vectors_into_ned() -> None:
    """The same physical vector comes out, whichever axes it is carried through."""
    r_B = (0.3, -1.2, 2.1)
    for q in random_quaternions(50):
        expected = rotations.ned_from_enu(rotations.rotate(q, r_B))
        through_mavlink = rotations.rotate(rotations.quaternion_ned_frd_from_enu_flu(q), rotations.frd_from_flu(r_B))
        assert through_mavlink == pytest.approx(expected, abs=1e-12)


def test_mavlink_quaternion_conversion_returns_when_undone() -> None:
    for q in random_quaternions(50):
        there = rotations.quaternion_ned_frd_from_enu_flu(q)
        assert there[0] >= 0.0
        assert rotations.quaternion_enu_flu_from_ned_frd(there) == pytest.approx(q, abs=1e-12)


def test_heading_north_is_the_identity_on_mavlink() -> None:
    q = rotations.quaternion_ned_frd_from_enu_flu(rotations.quaternion_from_yaw(pi / 2))
    assert q == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-12)


def test_product_equals_scipy() -> None:
    expected = (scipy_rotation(P) * scipy_rotation(Q)).as_quat(canonical=True, scalar_first=True)
    assert rotations.canonical(rotations.multiply(P, Q)) == pytest.approx(expected.tolist(), abs=1e-12)


@given(VECTORS)
def test_rotate_equals_scipy(vector: Vector3) -> None:
    assert rotations.rotate(Q, vector) == pytest.approx(scipy_rotation(Q).apply(vector).tolist(), abs=1e-9)


def test_conjugate_undoes_a_rotation() -> None:
    vector = (0.3, -4.0, 2.0)
    assert rotations.rotate(rotations.conjugate(Q), rotations.rotate(Q, vector)) == pytest.approx(vector, abs=1e-12)


@given(ANGLES, st.floats(-1.5, 1.5), ANGLES)
def test_roll_pitch_yaw_equals_scipy_and_returns(roll_rad: float, pitch_rad: float, yaw_rad: float) -> None:
    q = rotations.quaternion_from_roll_pitch_yaw(roll_rad, pitch_rad, yaw_rad)
    expected = Rotation.from_euler("ZYX", (yaw_rad, pitch_rad, roll_rad))
    assert abs(np.dot(q, expected.as_quat(scalar_first=True))) == pytest.approx(1.0, abs=1e-12)
    assert rotations.roll_pitch_yaw_of(q) == pytest.approx((roll_rad, pitch_rad, yaw_rad), abs=1e-6)


def test_pitch_of_a_vertical_attitude_stays_a_quarter_turn() -> None:
    up = rotations.quaternion_from_roll_pitch_yaw(0.0, -pi / 2, 0.4)
    stretched = tuple(component * (1.0 + 1e-12) for component in up)
    assert rotations.roll_pitch_yaw_of(stretched)[1] == pytest.approx(-pi / 2, abs=1e-6)


@given(ANGLES)
def test_yaw_returns_through_its_quaternion(yaw_rad: float) -> None:
    q = rotations.quaternion_from_yaw(yaw_rad)
    assert q[0] >= 0.0
    assert rotations.yaw_of(q) == pytest.approx(yaw_rad, abs=1e-12)


def test_arrays_are_taken_as_well_as_tuples() -> None:
    plain = rotations.rotate(Q, (1.0, 2.0, 3.0))
    assert rotations.rotate(np.array(Q), np.array((1.0, 2.0, 3.0))) == pytest.approx(plain)


@pytest.mark.parametrize("q", [(0.0, 0.0, 0.0, 0.0), (float("nan"), 0.0, 0.0, 1.0), (float("inf"), 0.0, 0.0, 0.0)])
def test_a_quaternion_without_a_direction_is_refused(q: Quaternion) -> None:
    with pytest.raises(ValueError, match="finite length"):
        rotations.normalized(q)
