import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.campaigns.intervals import mcnemar_p, median_difference, wilson

counts = st.integers(0, 300)


def test_wilson_of_all_of_a_hundred_starts_at_96_3_percent() -> None:
    # n / (n + z^2), the interval's closed form where all succeed
    found = wilson(100, 100)
    assert found.low == pytest.approx(100 / (100 + 1.959963985**2))
    assert found.high == 1.0


@given(successes=counts, failures=counts)
def test_wilson_mirrors_failures(successes: int, failures: int) -> None:
    trials = successes + failures + 1
    found, mirrored = wilson(successes, trials), wilson(trials - successes, trials)
    assert found.low == pytest.approx(1.0 - mirrored.high, abs=1e-12)
    assert 0.0 <= found.low <= found.value <= found.high <= 1.0


@pytest.mark.parametrize(("successes", "trials"), [(0, 0), (3, 2), (-1, 2)])
def test_wilson_refuses_what_is_no_share(successes: int, trials: int) -> None:
    with pytest.raises(ValueError, match="is no share"):
        wilson(successes, trials)


@given(only_first=counts, only_second=counts)
def test_mcnemar_is_twice_the_smaller_tail_of_a_fair_coin(only_first: int, only_second: int) -> None:
    both = only_first + only_second
    tail = sum(math.comb(both, k) for k in range(min(only_first, only_second) + 1))
    assert mcnemar_p(only_first, only_second) == pytest.approx(min(1.0, 2 * tail / 2**both), rel=1e-9)


def test_median_difference_of_a_constant_shift_has_no_width() -> None:
    first = [0.3, 1.7, 0.9, 2.2]
    found = median_difference(first, [value + 0.25 for value in first])
    assert [found.value, found.low, found.high] == pytest.approx([0.25] * 3)


def test_median_difference_of_one_pair_has_no_width() -> None:
    found = median_difference([0.25], [1.75])
    assert (found.value, found.low, found.high) == (1.5, 1.5, 1.5)


@pytest.mark.slow
def test_median_difference_covers_the_truth_nineteen_times_in_twenty() -> None:
    rng = np.random.default_rng(11)
    covered = 0
    for _ in range(100):
        differences = rng.normal(0.1, 1.0, 100)
        found = median_difference([0.0] * 100, differences.tolist())
        covered += found.low <= 0.1 <= found.high
    # 95 of 100 are expected; fewer than 88 or none outside would be three standard deviations off
    assert 88 <= covered <= 100


def test_median_difference_is_the_same_each_time() -> None:
    first, second = [0.1, 0.5, 0.2], [0.2, 0.1, 0.9]
    assert median_difference(first, second) == median_difference(first, second)


def test_median_difference_of_many_pairs_is_taken_in_parts() -> None:
    values = np.random.default_rng(3).normal(size=1500)
    found = median_difference([0.0] * 1500, values.tolist())
    # standard error of a normal sample's median is sqrt(pi / 2 n)
    half = 1.96 * math.sqrt(math.pi / 2.0 / 1500)
    assert found.high - found.low == pytest.approx(2.0 * half, rel=0.25)
