import numpy as np
import pytest

from scenarios.falsify.space import Z_MAX, radius_max
from scenarios.falsify.strategy import EvolutionStrategy, RandomStrategy, Start, wide_start

DIMENSION = 60
WIDE = wide_start(DIMENSION)


def test_first_generation_is_drawn_as_random_worlds_are() -> None:
    points = np.array([z for seed in range(40) for z in EvolutionStrategy(WIDE, seed).ask()])
    assert points.mean() == pytest.approx(0.0, abs=0.02)
    assert points.std() == pytest.approx(1.0, abs=0.02)


def test_every_point_that_is_asked_for_is_plausible() -> None:
    strategy = EvolutionStrategy(WIDE, 3)
    for _ in range(25):
        points = strategy.ask()
        assert max(np.linalg.norm(z) for z in points) <= radius_max(DIMENSION) * (1.0 + 1e-12)
        assert max(np.abs(z).max() for z in points) <= Z_MAX
        strategy.tell([float(-z[0] - z[1]) for z in points])


def test_same_seed_asks_for_the_same_whatever_else_draws_random_numbers() -> None:
    asked = []
    for disturbance in (1, 2):
        strategy = EvolutionStrategy(WIDE, 8)
        for _ in range(4):
            np.random.seed(disturbance)  # noqa: NPY002 (the global generator, which pycma would draw from)
            points = strategy.ask()
            strategy.tell([float(z @ z) for z in points])
        asked.append(np.array(points))
    assert np.array_equal(asked[0], asked[1])


def test_failure_that_random_worlds_meet_once_in_a_hundred_thousand_is_reached_within_300() -> None:
    # Three quantities must add up to 7.4 at standard deviation sqrt(3): 4.27 of them, one in 100,000.
    flown = []
    for seed in range(5):
        strategy, count, worst = EvolutionStrategy(WIDE, seed), 0, 1.0
        while worst > 0.0 and count < 1000:
            margins = [float(1.0 - (z[3] + z[20] - z[41]) / 7.4) for z in strategy.ask()]
            strategy.tell(margins)
            count, worst = count + len(margins), min(margins)
        flown.append(count)
    assert max(flown) < 300


def test_strategy_is_stale_when_nothing_becomes_better() -> None:
    strategy = EvolutionStrategy(WIDE, 1)
    generations = 0
    while not strategy.is_stale:
        strategy.tell([0.5 + 1e-4 * index for index, _ in enumerate(strategy.ask())])
        generations += 1
    assert 5 < generations < 20


def start_of_two(margin: float = np.inf) -> Start:
    """Two quantities of all are spread, the others stay at what is drawn."""
    mean = np.random.default_rng(5).standard_normal(DIMENSION)
    spread = np.zeros(DIMENSION)
    spread[[4, 17]] = 0.1, 1.0
    return Start(mean=mean, spread=spread, margin=margin, patience=1)


def test_first_generation_has_the_spread_of_its_start_and_leaves_the_rest() -> None:
    start = start_of_two()
    points = np.array([z for seed in range(100) for z in EvolutionStrategy(start, seed).ask()])
    off = points - start.mean
    assert off.std(axis=0)[[4, 17]] == pytest.approx([0.1, 1.0], rel=0.1)
    assert not np.delete(off, [4, 17], axis=1).any()


def test_start_goes_on_only_as_long_as_each_generation_comes_nearer() -> None:
    strategy = EvolutionStrategy(start_of_two(margin=0.25), 1)
    for least, is_stale in ((0.2, False), (0.1, False), (0.1, True)):
        strategy.tell([least + 1e-3 * index for index, _ in enumerate(strategy.ask())])
        assert strategy.is_stale == is_stale


def test_start_is_given_up_when_its_first_generation_does_not_come_near() -> None:
    strategy = EvolutionStrategy(start_of_two(margin=0.25), 1)
    strategy.tell([0.3] * len(strategy.ask()))
    assert strategy.is_stale


def test_random_worlds_are_as_plausible_and_are_never_drawn_twice() -> None:
    strategies = [RandomStrategy(DIMENSION, seed) for seed in range(20)]
    points = np.array([z for strategy in strategies for z in strategy.ask()])
    assert len(np.unique(points[:, 0])) == len(points)
    assert np.linalg.norm(points, axis=1).max() <= radius_max(DIMENSION) * (1.0 + 1e-12)
    assert all(strategy.is_stale for strategy in strategies)
