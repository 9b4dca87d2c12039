"""Compiled products and inverses of the filter's small matrices, which are mostly zeros.

Of the 225 numbers of a transition fewer than 50 are not zero: leaving out the others takes a third of the time of the
library's dense product, and needs no linear algebra library loaded.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel


@compiled_kernel
def times(left: Array, right: Array) -> Array:
    """Return the product (m, n) of `left` (m, k), whose zeros are left out, and `right` (k, n)."""
    m, k = left.shape
    n = right.shape[1]
    product = np.zeros((m, n))
    for i in range(m):
        for inner in range(k):
            factor = left[i, inner]
            if factor != 0.0:
                for j in range(n):
                    product[i, j] += factor * right[inner, j]
    return product


@compiled_kernel
def carried_through(left: Array, covariance: Array) -> Array:
    """Return `left @ covariance @ left.T`, (m, m), of a symmetric `covariance` (n, n)."""
    return times(left, times(left, covariance).T)


@compiled_kernel
def less_outer(matrix: Array, left: Array, right: Array) -> Array:
    """Return `matrix - left.T @ right`, (n, n), of `left` and `right`, each (m, n) with few rows."""
    difference = matrix.copy()
    n = len(matrix)
    for row in range(len(left)):
        for i in range(n):
            factor = left[row, i]
            for j in range(n):
                difference[i, j] -= factor * right[row, j]
    return difference


@compiled_kernel
def inverse_of(covariance: Array) -> tuple[Array, float]:
    """Return the inverse (m, m) of a covariance, and the logarithm of its determinant, by Cholesky's factors.

    They are NaN where the covariance is not positive definite.
    """
    m = len(covariance)
    factor, back = np.zeros((m, m)), np.zeros((m, m))
    log_determinant = 0.0
    for i in range(m):
        for j in range(i + 1):
            rest = covariance[i, j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            if i > j:
                factor[i, j] = rest / factor[j, j]
            else:
                factor[i, i] = math.sqrt(rest) if rest > 0.0 else math.nan
        log_determinant += 2.0 * math.log(factor[i, i])
        back[i, i] = 1.0 / factor[i, i]
        for j in range(i):
            for k in range(j, i):
                back[i, j] -= factor[i, k] * back[k, j] * back[i, i]
    return times(back.T, back), log_determinant
