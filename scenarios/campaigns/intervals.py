"""The statistics of campaigns: shares with their intervals, and two variants on the same seeds.

Sources: E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209; Q. McNemar, Psychometrika 12 (1947) 153, in its exact form;
B. Efron, Ann. Statist. 7 (1979) 1, percentile interval.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv

_LEVEL = 0.95
_Z = NormalDist().inv_cdf(0.5 + 0.5 * _LEVEL)
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
    share, weight = successes / trials, _Z**2 / trials
    middle = (share + 0.5 * weight) / (1.0 + weight)
    half = math.sqrt(share * (1.0 - share) * weight + 0.25 * weight**2) / (1.0 + weight)
    low = 0.0 if successes == 0 else middle - half
    return Interval(value=share, low=low, high=1.0 if successes == trials else middle + half)


def mean_band(dof: int) -> tuple[float, float] | tuple[None, None]:
    """Return between what the mean of `dof` squared normal numbers lies with 95 %, None of none (chi-square)."""
    if dof == 0:
        return None, None
    low, high = (2.0 * float(gammaincinv(0.5 * dof, 0.5 + side * 0.5 * _LEVEL)) / dof for side in (-1.0, 1.0))
    return low, high


def mcnemar_p(only_first: int, only_second: int) -> float:
    """Return how likely so uneven a split is (two-sided, exact) if neither variant is better.

    Args:
        only_first: pairs in which only the first succeeded.
        only_second: pairs in which only the second did.
    """
    discordant = only_first + only_second
    tail = sum(math.comb(discordant, k) for k in range(min(only_first, only_second) + 1))
    return float(min(1.0, 2 * tail / 2**discordant))


def median_difference(first: Sequence[float], second: Sequence[float]) -> Interval:
    """Return the median of second minus first over pairs, with its bootstrap interval; the same for the same pairs.

    Args:
        first: (n,) at least one.
        second: (n,) of the same unit.
    """
    differences = np.asarray(second, dtype=float) - np.asarray(first, dtype=float)
    low, high = np.quantile(_resampled_medians(differences), [0.5 - 0.5 * _LEVEL, 0.5 + 0.5 * _LEVEL])
    return Interval(value=float(np.median(differences)), low=float(low), high=float(high))


def _resampled_medians(values: NDArray[np.float64]) -> NDArray[np.float64]:
    rng = np.random.default_rng(_BOOTSTRAP_SEED)
    rows = max(1, _RESAMPLED_AT_ONCE // len(values))
    counts = [min(rows, _RESAMPLES - done) for done in range(0, _RESAMPLES, rows)]
    return np.concatenate([np.median(rng.choice(values, size=(count, len(values))), axis=1) for count in counts])
