"""Which numbers of a stranger are believed. Authority: numpy's eigenvalues."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from link.payloads.checks import PayloadError, checked_covariance, checked_quaternion, t_ns_of

Array = NDArray[np.float64]
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


@pytest.mark.parametrize("place", [(0, 1), (0, 2), (1, 2)])
def test_matrix_that_is_not_symmetric_is_no_covariance(place: tuple[int, int]) -> None:
    matrix = np.eye(3)
    matrix[place] = 0.1
    assert not is_believed(matrix)


@example(yaw_rad=3.0, share=1.0)
@given(yaw_rad=st.floats(-3.1, 3.1), share=st.floats(0.9991, 1.0009))
def test_quaternion_that_is_almost_of_unit_length_is_made_so(yaw_rad: float, share: float) -> None:
    w, x, y, z = checked_quaternion((share * math.cos(0.5 * yaw_rad), 0.0, 0.0, share * math.sin(0.5 * yaw_rad)))
    assert (w, x, y, z) == pytest.approx((math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad)), abs=1e-9)


@pytest.mark.parametrize(("seconds", "nanoseconds"), [(-1, 0), (0, -1), (0, 10**9)])
def test_stamp_before_1970_or_of_more_than_a_second_of_nanoseconds_is_none(seconds: int, nanoseconds: int) -> None:
    with pytest.raises(PayloadError):
        t_ns_of(seconds, nanoseconds)
    assert t_ns_of(0, 0) == 0
    assert t_ns_of(1, 999_999_999) == 1_999_999_999
