import numpy as np
import pytest

from companion.eyes.finding.pose import variance_px2

EDGES, POINTS = 400, 9
NUMBERS = np.repeat(np.arange(EDGES), POINTS)
EVEN = np.ones(EDGES * POINTS)


def noise(std_px: float, count: int, seed: int) -> np.ndarray:
    return std_px * np.random.default_rng(seed).standard_normal(count)


def test_points_that_err_each_on_its_own_have_the_variance_of_their_noise() -> None:
    assert variance_px2(noise(0.13, len(EVEN), 3), EVEN, NUMBERS) == pytest.approx(0.13**2, rel=0.12)


def test_points_that_err_with_their_edge_count_as_one() -> None:
    # least squares over n points of one error e has the variance of n equal points: n e^2, half of it for the slopes
    shared = np.repeat(noise(0.2, EDGES, 4), POINTS)
    assert variance_px2(shared, EVEN, NUMBERS) == pytest.approx(0.5 * POINTS * 0.2**2, rel=0.15)


def test_edges_that_agree_by_chance_say_no_less_than_the_points_own_noise() -> None:
    alternating = 0.1 * np.tile([1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0], 4)  # no shift, no slope
    assert variance_px2(alternating, np.ones(32), np.repeat(np.arange(4), 8)) == pytest.approx(0.01 * 32 / 24)


def test_outliers_count_by_their_weights() -> None:
    left, weights = noise(0.1, len(EVEN), 5), EVEN.copy()
    left[::50], weights[::50] = 3.0, 1e-3
    assert variance_px2(left, weights, NUMBERS) < 2.0 * 0.1**2


def test_an_edge_of_one_point_tells_its_shift_alone() -> None:
    numbers = np.arange(10)
    assert variance_px2(np.full(10, 0.3), np.ones(10), numbers) == pytest.approx(10 * 0.09 / 4)
