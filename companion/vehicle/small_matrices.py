"""Compiled products and inverses of the filter's small matrices, which are mostly zeros, and the Kalman update by them.

Of the 625 numbers of a transition 77 are not zero: leaving out the others takes a third of the time of the
library's dense product, and needs no linear algebra library loaded.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel

WhiteJerk = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


@compiled_kernel
def white_jerk(d: float) -> WhiteJerk:
    """Return what white jerk of density 1 adds within `d` to the covariance of place, velocity and acceleration.

    Bar-Shalom, Li and Kirubarajan 2001, eq. 6.2.3-9.
    """
    return ((d**5 / 20, d**4 / 8, d**3 / 6), (d**4 / 8, d**3 / 3, d**2 / 2), (d**3 / 6, d**2 / 2, d))


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


@compiled_kernel
def correct(x: Array, P: Array, residual: Array, H: Array, R: Array) -> tuple[Array, Array, float, float]:
    """Return mean, covariance, NIS and log-likelihood after a measurement.

    The covariance is Joseph's form `(1 - KH) P (1 - KH)' + KRK'`, multiplied out in an order that has m rows only.

    Args:
        x: mean (n,).
        P: covariance (n, n).
        residual: measured minus expected (m,).
        H: Jacobian (m, n).
        R: covariance of the measurement (m, m).
    """
    HP = times(H, P)
    inverse, log_determinant = inverse_of(times(H, HP.T) + R)
    K = times(inverse, HP)  # transposed, (m, n)
    nis = 0.0
    for i in range(len(residual)):
        for j in range(len(residual)):
            nis += residual[i] * inverse[i, j] * residual[j]
    kept = less_outer(P, K, HP)
    joseph = less_outer(kept, times(H, kept.T) - times(R, K), K)
    log_likelihood = -0.5 * (nis + log_determinant + len(residual) * math.log(2.0 * math.pi))
    y = x.copy()
    for i in range(len(residual)):
        y += residual[i] * K[i]
    return y, 0.5 * (joseph + joseph.T), nis, log_likelihood
