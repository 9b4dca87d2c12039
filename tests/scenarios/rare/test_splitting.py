import numpy as np
import pytest
from scipy import stats

from scenarios.rare.estimate import ANCESTORS_MIN, MOVED_MIN, Verdict, estimate
from scenarios.rare.noise import MovedNoise
from scenarios.rare.splitting import Population
from tests.scenarios.rare.limit_states import (
    MarginOf,
    linear,
    region,
    split_landings,
    split_margin,
    two_regions,
    waiting,
    waiting_probability,
)

REPETITIONS = 16
LEVEL = 0.01


def value_of(population: Population) -> float:
    """The estimate of a splitting that has converged."""
    interval = estimate(population).probability
    assert interval is not None
    return interval.value


@pytest.mark.parametrize(
    ("margin_of", "probability", "particles"),
    [
        (linear(0.05), 0.05, 60),
        pytest.param(two_regions(1e-2), 1e-2, 100, marks=pytest.mark.slow),
    ],
)
def test_interval_has_its_coverage_and_the_estimate_no_bias(
    margin_of: MarginOf, probability: float, particles: int
) -> None:
    found = [estimate(split_margin(margin_of, particles=particles, seed=seed)) for seed in range(REPETITIONS)]
    intervals = [one.probability for one in found if one.probability is not None]
    assert len(intervals) >= 0.9 * REPETITIONS
    covered = sum(one.low <= probability <= one.high for one in intervals)
    assert stats.binomtest(covered, len(intervals), 0.95, alternative="less").pvalue > LEVEL
    ratios = np.array([one.value for one in intervals]) / probability
    assert stats.ttest_1samp(ratios, 1.0).pvalue > LEVEL


@pytest.mark.slow
def test_drawing_anew_in_time_gives_no_bias() -> None:
    probability = waiting_probability(0.02)
    found = [estimate(split_landings(waiting(0.02), particles=80, seed=seed)) for seed in range(REPETITIONS)]
    intervals = [one.probability for one in found if one.probability is not None]
    assert len(intervals) > 0.8 * REPETITIONS
    covered = sum(one.low <= probability <= one.high for one in intervals)
    assert stats.binomtest(covered, len(intervals), 0.95, alternative="less").pvalue > LEVEL
    ratios = np.array([one.value for one in intervals]) / probability
    assert stats.ttest_1samp(ratios, 1.0).pvalue > LEVEL


@pytest.mark.slow
def test_one_in_a_million_is_found_with_thousands_of_landings() -> None:
    population = split_margin(two_regions(1e-6), particles=200, seed=1)
    found = estimate(population)
    assert found.verdict is Verdict.CONVERGED
    assert found.probability is not None
    assert found.probability.low < 1e-6 < found.probability.high < 30.0 * found.probability.low
    assert population.flown < 10_000


@pytest.mark.slow
def test_both_ways_of_failing_are_found() -> None:
    margin_of = two_regions(1e-3)
    population = split_margin(margin_of, particles=100, seed=2)
    distance = -float(stats.norm.ppf(1.0 - np.sqrt(1.0 - 1e-3)))
    ways = [tuple(region(one.noise, name, distance) < 0.0 for name in "ab") for one in population.unsafe]
    assert {(True, False), (False, True)} <= set(ways)


def test_frequent_failures_are_counted_as_a_plain_campaign_does() -> None:
    population = split_margin(linear(0.6), particles=200, seed=1)
    unsafe = sum(linear(0.6)(one.noise) < 0.0 for one in population.particles)
    assert population.levels == []
    assert population.flown == 200
    assert value_of(population) == unsafe / 200


def test_population_stays_below_its_levels_which_descend_by_half_at_least() -> None:
    population = split_margin(linear(1e-3), particles=100, seed=3)
    margins = [level.margin for level in population.levels]
    assert margins == sorted(margins, reverse=True)
    assert all(0 < level.survivors <= 50 for level in population.levels)  # less where copies are alike
    assert max(one.margin for one in population.particles) < margins[-1]


def test_same_seed_gives_the_same_population_and_another_seed_another() -> None:
    first, again, other = (split_margin(linear(1e-2), particles=40, seed=seed) for seed in (4, 4, 5))
    assert first == again
    assert first != other


def no_number(population: Population) -> Verdict:
    found = estimate(population)
    assert found.probability is None
    return found.verdict


def test_nothing_unsafe_down_to_the_least_probability_gives_no_number() -> None:
    population = split_margin(linear(1e-9), particles=40, seed=1, least=0.01)
    assert no_number(population) is Verdict.NONE_UNSAFE
    assert population.probability >= 0.01


def test_landings_of_the_same_margin_give_no_number() -> None:
    assert no_number(split_margin(lambda _: 1.0, particles=40, seed=1)) is Verdict.NOTHING_WORSE


def test_too_few_ancestors_give_no_number() -> None:
    population = split_margin(linear(1e-4), particles=40, seed=1)
    assert len({one.ancestor for one in population.unsafe}) < ANCESTORS_MIN
    assert no_number(population) is Verdict.FEW_ANCESTORS


def test_copies_that_do_not_move_give_no_number() -> None:
    def rugged(noise: MovedNoise) -> float:
        """Return a margin that every move raises."""
        return 1.0 if noise.changes else float(noise.stream("z").random()) - 0.1

    population = split_margin(rugged, particles=60, seed=1)
    assert any(level.moved < MOVED_MIN for level in population.levels)
    assert no_number(population) is Verdict.STUCK
