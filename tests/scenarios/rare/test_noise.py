import math
import pickle

import numpy as np
import pytest
from scipy import stats

from scenarios.rare.noise import Move, MovedNoise

SAMPLES = 20_000
SIGNIFICANCE = 1e-3  # fixed seeds: a test that passes once passes always


def moved(angles_rad: tuple[float, ...], seed: int = 5) -> MovedNoise:
    moves = tuple(Move(seed=100 + i, angle_rad=angle_rad) for i, angle_rad in enumerate(angles_rad))
    return MovedNoise(seed=seed, moves=moves)


@pytest.mark.parametrize("angles_rad", [(), (0.3,), (0.7, 0.2, 1.3), (math.pi / 2,)])
def test_moves_leave_the_distributions_as_they_are(angles_rad: tuple[float, ...]) -> None:
    stream = moved(angles_rad).stream("fix")
    assert stats.kstest(stream.standard_normal(SAMPLES), "norm").pvalue > SIGNIFICANCE
    assert stats.kstest(stream.random(SAMPLES), "uniform").pvalue > SIGNIFICANCE


def test_move_keeps_the_cosine_of_its_angle_of_what_was_before() -> None:
    before, angle_rad = moved((0.4, 0.9)), 0.65
    after = before.moved(Move(seed=77, angle_rad=angle_rad))
    pair = [noise.stream("fix").standard_normal(SAMPLES) for noise in (before, after)]
    error = math.sin(angle_rad) ** 2 / math.sqrt(SAMPLES)
    assert stats.pearsonr(*pair).statistic == pytest.approx(math.cos(angle_rad), abs=4.0 * error)


def test_parts_are_independent_of_each_other() -> None:
    noise = moved((0.4, 0.9))
    pair = [noise.stream(name).standard_normal(SAMPLES) for name in ("fix", "imu")]
    assert stats.pearsonr(*pair).pvalue > SIGNIFICANCE


def test_stream_is_the_same_however_it_is_divided_among_calls() -> None:
    noise = pickle.loads(pickle.dumps(moved((0.4, 0.9))))  # noqa: S301 (our own bytes)
    whole = noise.stream("link").standard_normal(6000)
    stream = noise.stream("link")
    parts = [stream.standard_normal(5), stream.standard_normal((10, 3)).ravel(), [stream.standard_normal()]]
    parts += [stream.standard_normal(6000 - 36)]
    np.testing.assert_array_equal(np.concatenate(parts), whole)


def test_uniform_and_normal_numbers_have_their_bounds_and_moments() -> None:
    stream = moved((0.8,)).stream("gust")
    assert stats.kstest(stream.uniform(-2.0, 5.0, SAMPLES), "uniform", args=(-2.0, 7.0)).pvalue > SIGNIFICANCE
    assert stats.kstest(stream.normal(3.0, 0.5, SAMPLES), "norm", args=(3.0, 0.5)).pvalue > SIGNIFICANCE


def test_stream_stands_in_for_a_seed_of_numpy() -> None:
    stream = moved(()).stream("link")
    assert np.random.default_rng(stream) is stream
    assert 0 <= stream.integers(5) < 5


def test_stream_refuses_what_it_would_not_fill() -> None:
    with pytest.raises(ValueError, match="float32"):
        moved(()).stream("link").random(3, dtype=np.float32)
