"""Which numbers of a stranger are believed. Authority: numpy's eigenvalues."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from link.payloads.checks import PayloadError, checked_covariance, checked_quaternion, t_ns_of

Array = NDArray[np.float64]
UNIT_VECTORS = arrays(np.float64, 4, elements=st.floats(-1.0, 1.0)).filter(lambda one: np.linalg.norm(one) > 0.1)
MATRICES = arrays(np.float64, (3, 3), elements=st.floats(-3.0, 3.0, width=32))


def is_believed(matrix: Array) -> bool:
    a, b, c, d, e, f, g, h, i = matrix.flatten().tolist()
    try:
        return checked_covariance("covariance", (a, b, c, d, e, f, g, h, i)) is not None
    except PayloadError:
        return False


@given(root=MATRICES, scale=st.floats(1e-4, 1e6))
def test_covariance_is_believed_whatever_its_unit(root: Array, scale: float) -> None:
    matrix = scale * (root @ root.T)
    assert is_believed(0.5 * (matrix + matrix.T)) or not matrix.any()


@given(root=MATRICES, scale=st.floats(1e-4, 1e6))
def test_symmetric_matrix_with_a_negative_eigenvalue_is_no_covariance(root: Array, scale: float) -> None:
    matrix = scale * (root + root.T)
    values = np.linalg.eigvalsh(matrix)
    if values.min() < -0.01 * abs(values).max():
        assert not is_believed(matrix)


@pytest.mark.parametrize("place", [(0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)])
@pytest.mark.parametrize(
    ("share", "is_covariance"), [(0.99e-6, True), (1.01e-6, False), (-1.01e-6, False), (0.1, False)]
)
def test_covariance_is_symmetric_within_a_millionth_of_its_trace(
    place: tuple[int, int], share: float, *, is_covariance: bool
) -> None:
    matrix = np.diag([1.0, 2.0, 4.0])
    matrix[place] = share * 7.0
    assert is_believed(matrix) is is_covariance


@given(axis=arrays(np.float64, 3, elements=st.floats(-1.0, 1.0, width=32)), scale=st.floats(1e-4, 1e6))
def test_covariance_along_one_direction_is_believed_though_it_was_carried_in_single_precision(
    axis: Array, scale: float
) -> None:
    matrix = scale * np.outer(axis, axis)
    rounded = matrix.astype(np.float32).astype(np.float64)
    assert is_believed(rounded) or np.linalg.norm(rounded) < 1e-30


@pytest.mark.parametrize("known", [0, 1, 2])
def test_axis_that_is_known_exactly_leaves_the_two_others_a_covariance_of_their_own(known: int) -> None:
    """Of which the determinant, being zero, says nothing."""
    for correlation, is_covariance in ((0.9, True), (-0.9, True), (1.1, False), (-1.1, False)):
        matrix = np.full((3, 3), correlation)
        np.fill_diagonal(matrix, 1.0)
        matrix[known, :] = matrix[:, known] = 0.0
        assert is_believed(matrix) is is_covariance


@pytest.mark.parametrize("lone", [(0, 1), (0, 2), (1, 2)])
@pytest.mark.parametrize(("correlation", "is_covariance"), [(0.49, True), (0.51, False)])
def test_two_that_go_with_a_third_do_not_go_against_each_other(
    lone: tuple[int, int], correlation: float, *, is_covariance: bool
) -> None:
    """Each pair of the axes could be so, which only all three show: the least eigenvalue is 1 - 2 r."""
    matrix = np.full((3, 3), correlation)
    np.fill_diagonal(matrix, 1.0)
    matrix[lone] = matrix[lone[::-1]] = -correlation
    assert is_believed(matrix) is is_covariance


@pytest.mark.parametrize(
    ("least", "beside", "told"),
    [(-1.0, 0.0, "semidefinite"), (1.0, 0.1, "symmetric"), (math.inf, 0.0, "finite"), (math.nan, 0.0, "finite")],
)
def test_it_is_told_what_is_wrong_with_a_covariance(least: float, beside: float, told: str) -> None:
    with pytest.raises(PayloadError, match=told):
        checked_covariance("covariance", (least, beside, 0.0, 0.0, least, 0.0, 0.0, 0.0, least))


@given(vector=UNIT_VECTORS, share=st.floats(0.99901, 1.00099))
def test_quaternion_that_is_almost_of_unit_length_is_made_so_and_means_the_same(vector: Array, share: float) -> None:
    unit = vector / np.linalg.norm(vector)
    w, x, y, z = (share * unit).tolist()
    checked = np.array(checked_quaternion((w, x, y, z)))
    assert checked[0] >= 0.0
    assert np.linalg.norm(checked) == pytest.approx(1.0, abs=1e-12)
    given_turn, checked_turn = (Rotation.from_quat(np.roll(one, -1)) for one in (unit, checked))
    assert (given_turn.inv() * checked_turn).magnitude() < 1e-7


@given(vector=UNIT_VECTORS)
def test_quaternion_that_is_of_unit_length_but_for_rounding_keeps_its_bits(vector: Array) -> None:
    w, x, y, z = (vector / np.linalg.norm(vector)).tolist()
    assert checked_quaternion((w, x, y, z)) == ((w, x, y, z) if w >= 0.0 else (-w, -x, -y, -z))


@pytest.mark.parametrize("length", [0.0, 0.99899, 1.00101, math.inf, math.nan])
def test_quaternion_whose_length_is_off_by_a_thousandth_is_none(length: float) -> None:
    with pytest.raises(PayloadError):
        checked_quaternion((0.6 * length, 0.0, -0.8 * length, 0.0))


@pytest.mark.parametrize(("seconds", "nanoseconds"), [(-1, 0), (0, -1), (0, 10**9)])
def test_stamp_before_1970_or_of_more_than_a_second_of_nanoseconds_is_none(seconds: int, nanoseconds: int) -> None:
    with pytest.raises(PayloadError):
        t_ns_of(seconds, nanoseconds)
    assert t_ns_of(0, 0) == 0
    assert t_ns_of(1, 999_999_999) == 1_999_999_999
