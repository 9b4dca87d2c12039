import math
import pickle

import numpy as np
import pytest
from scipy import stats

from scenarios.rare.noise import Move, MovedNoise, NoiseInFlight, Redraw

SAMPLES = 20_000
SIGNIFICANCE = 1e-3  # fixed seeds: a test that passes once passes always


def moved(angles_rad: tuple[float, ...], seed: int = 5) -> MovedNoise:
    changes = tuple(Move(seed=100 + i, angle_rad=angle_rad) for i, angle_rad in enumerate(angles_rad))
    return MovedNoise(seed=seed, changes=changes)


REDRAWN = moved((0.4,)).changed(Redraw(seed=9, kept=(("fix", 50), ("imu", 0)))).changed(Move(seed=8, angle_rad=0.6))


@pytest.mark.parametrize("noise", [moved(()), moved((0.7, 0.2, 1.3)), moved((math.pi / 2,)), REDRAWN])
def test_changes_leave_the_distributions_as_they_are(noise: MovedNoise) -> None:
    stream = noise.stream("fix")
    assert stats.kstest(stream.standard_normal(SAMPLES), "norm").pvalue > SIGNIFICANCE
    assert stats.kstest(stream.random(SAMPLES), "uniform").pvalue > SIGNIFICANCE


@pytest.mark.parametrize("before", [moved((0.4, 0.9)), REDRAWN])
def test_move_keeps_the_cosine_of_its_angle_of_what_was_before(before: MovedNoise) -> None:
    angle_rad = 0.65
    after = before.changed(Move(seed=77, angle_rad=angle_rad))
    pair = [noise.stream("fix").standard_normal(SAMPLES) for noise in (before, after)]
    error = math.sin(angle_rad) ** 2 / math.sqrt(SAMPLES)
    assert stats.pearsonr(*pair).statistic == pytest.approx(math.cos(angle_rad), abs=4.0 * error)


def test_parts_are_independent_of_each_other() -> None:
    pair = [REDRAWN.stream(name).standard_normal(SAMPLES) for name in ("fix", "imu")]
    assert stats.pearsonr(*pair).pvalue > SIGNIFICANCE


def test_stream_is_the_same_however_it_is_divided_among_calls() -> None:
    noise = pickle.loads(pickle.dumps(REDRAWN))  # noqa: S301 (our own bytes)
    whole = noise.stream("fix").standard_normal(6000)
    stream = noise.stream("fix")
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


def fly(flight: NoiseInFlight, seconds: int = 400) -> list[list[float]]:
    """Draw one number a second of one part, and three every tenth second of another, which begins late."""
    now_s = 0
    flight.now_s = lambda: now_s
    fix, rows = flight.stream("fix"), []
    for now_s in range(seconds):
        rows.append([fix.standard_normal()])
        if now_s == 100:
            late = flight.stream("late")
        if now_s >= 100 and now_s % 10 == 0:
            rows.append(late.standard_normal(3).tolist())
    return rows


@pytest.mark.parametrize("from_s", [57.5, 250.0])
def test_redrawing_changes_all_after_its_instant_and_nothing_before(from_s: float) -> None:
    plain, redrawn = fly(NoiseInFlight(REDRAWN)), fly(NoiseInFlight(REDRAWN, redraw_seed=31, from_s=from_s))
    same = [before == after for before, after in zip(plain, redrawn, strict=True)]
    assert same == sorted(same, reverse=True)
    seconds_before = math.ceil(from_s)
    rows_of_the_late_part = max(0, math.ceil((from_s - 100.0) / 10.0))
    assert sum(same) == seconds_before + rows_of_the_late_part


@pytest.mark.parametrize("from_s", [57.5, 250.0, 1e9])
def test_flown_noise_flies_the_same_again(from_s: float) -> None:
    flight = NoiseInFlight(REDRAWN, redraw_seed=31, from_s=from_s)
    first = fly(flight)
    assert fly(NoiseInFlight(flight.flown())) == first
