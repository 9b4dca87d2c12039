import math

import numpy as np
import pytest

from companion.core.data import Array
from companion.vehicle.small_matrices import carried_through, inverse_of, less_outer, times


def sparse(seed: int, shape: tuple[int, int]) -> Array:
    """Numbers of which about two thirds are zero."""
    rng = np.random.default_rng(seed)
    return np.where(rng.uniform(size=shape) < 0.65, 0.0, rng.standard_normal(shape))


def covariance(seed: int, n: int) -> Array:
    root = np.random.default_rng(seed).standard_normal((n, n))
    return np.asarray(root @ root.T + 0.1 * np.eye(n))


@pytest.mark.parametrize("seed", range(4))
def test_product_is_numpys(seed: int) -> None:
    left, right = sparse(seed, (3, 15)), sparse(seed + 10, (15, 7))
    assert times(left, right) == pytest.approx(left @ right, abs=1e-14)


@pytest.mark.parametrize("shape", [(15, 15), (3, 15), (1, 15)])
def test_covariance_is_carried_through_as_numpy_does(shape: tuple[int, int]) -> None:
    left, P = sparse(3, shape), covariance(4, 15)
    assert carried_through(left, P) == pytest.approx(left @ P @ left.T, abs=1e-12)


def test_outer_product_is_taken_off() -> None:
    matrix, left, right = covariance(1, 15), sparse(2, (3, 15)), sparse(3, (3, 15))
    assert less_outer(matrix, left, right) == pytest.approx(matrix - left.T @ right, abs=1e-13)


@pytest.mark.parametrize("n", [1, 2, 3])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e5])
def test_inverse_and_determinant_are_numpys(n: int, scale: float) -> None:
    P = scale * covariance(n, n)
    inverse, log_determinant = inverse_of(P)
    assert inverse == pytest.approx(np.linalg.inv(P), rel=1e-9)
    assert log_determinant == pytest.approx(np.linalg.slogdet(P)[1], rel=1e-12)


def test_what_is_no_covariance_has_no_inverse() -> None:
    inverse, log_determinant = inverse_of(np.array([[1.0, 2.0], [2.0, 1.0]]))
    assert math.isnan(log_determinant)
    assert np.isnan(inverse).any()
