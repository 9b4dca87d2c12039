"""The statistics of campaigns: shares with their intervals, variants on the same seeds, and contrasts, by scipy.stats.

Sources: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209; Q. McNemar, Psychometrika 12 (1947) 153, in its exact form;
B. Efron, Ann. Statist. 7 (1979) 1, percentile interval; H. B. Mann and D. R. Whitney, Ann. Math. Statist. 18 (1947) 50.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

_LEVEL = 0.95
_RESAMPLES = 4000
_RESAMPLED_AT_ONCE = 1_000_000  # values, 8 MB
_BOOTSTRAP_SEED = 20_260_101


@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """An estimate with its 95 % interval."""

    value: float
    low: float
    high: float


def wilson(successes: int, trials: int) -> Interval:
    """Return the share of successes with its Wilson score interval.

    Args:
        successes: 0 to `trials`.
        trials: at least 1.

    Raises:
        ValueError: there are no trials, or more successes than trials.
    """
    if not 0 <= successes <= trials or trials == 0:
        raise ValueError(f"{successes} of {trials} is no share")
    interval = stats.binomtest(successes, trials).proportion_ci(_LEVEL, method="wilson")
    return Interval(value=successes / trials, low=float(interval.low), high=float(interval.high))


def mean_band(dof: int) -> tuple[float, float] | tuple[None, None]:
    """Return between what the mean of `dof` squared normal numbers lies with 95 %, None of none (chi-square)."""
    if dof == 0:
        return None, None
    low, high = stats.chi2.interval(_LEVEL, dof)
    return float(low) / dof, float(high) / dof


def banded(value: float, low: float | None, high: float | None) -> str:
    """Return a value with the band that it should lie in, and on which side it is out of it."""
    if low is None or high is None:
        return f"{value:.2f}"
    side = " above" if value > high else " below" if value < low else ""
    return f"{value:.2f}{side} ({low:.2f} to {high:.2f})"


def mcnemar_p(only_first: int, only_second: int) -> float:
    """Return how likely so uneven a split is (two-sided, exact) if neither variant is better.

    Args:
        only_first: pairs in which only the first succeeded.
        only_second: pairs in which only the second did.
    """
    discordant = only_first + only_second
    return float(stats.binomtest(only_first, discordant).pvalue) if discordant else 1.0


def rank_contrast(first: Sequence[float], second: Sequence[float]) -> tuple[float, float]:
    """Return how often a value of the first group is above one of the second, ties by half, and the two-sided p.

    Args:
        first: (n,) at least one.
        second: (m,) at least one, of the same unit.

    Returns:
        0.5 where the groups do not differ, 1 where all of the first are above all of the second; p by Mann and Whitney.
    """
    found = stats.mannwhitneyu(first, second)
    return float(found.statistic) / (len(first) * len(second)), float(found.pvalue)


def median_difference(first: Sequence[float], second: Sequence[float]) -> Interval:
    """Return the median of second minus first over pairs, with its bootstrap interval; the same for the same pairs.

    Args:
        first: (n,) at least one.
        second: (n,) of the same unit.
    """
    differences = np.asarray(second, dtype=float) - np.asarray(first, dtype=float)
    median = float(np.median(differences))
    if len(differences) == 1:  # nothing to draw from
        return Interval(value=median, low=median, high=median)
    interval = stats.bootstrap(
        (differences,),
        np.median,
        n_resamples=_RESAMPLES,
        batch=max(1, _RESAMPLED_AT_ONCE // len(differences)),
        confidence_level=_LEVEL,
        method="percentile",
        rng=np.random.default_rng(_BOOTSTRAP_SEED),
    ).confidence_interval
    return Interval(value=median, low=float(interval.low), high=float(interval.high))
