"""The probability that a splitting found, its interval, and whether the splitting can be believed.

The interval comes from the one population, by how its unsafe landings descend from the first ones. Landings of
different ancestors are independent of each other, so that with m_a unsafe landings of ancestor a, M in all,

    v = 1 - N / (N - 1) * prod_l N^2 / (N^2 - N + S_l) * (1 - sum_a m_a^2 / M^2)

estimates the relative variance of p, copies that hardly moved included: the more alike the landings, the fewer the
ancestors that are left. (A. Lee and N. Whiteley, Biometrika 105 (2018) 609, for adaptive levels Q. Du and A. Guyader,
Ann. Appl. Probab. 31 (2021) 1021; the factor is that of a splitting which keeps the S_l survivors and copies N - S_l
times.) It is at least what independent landings would give. The logarithm of p is taken as normal, and v as known to
as many degrees of freedom as there are ancestors but one.
"""

import math
from collections import Counter
from dataclasses import dataclass
from enum import Enum

from scipy import stats

from scenarios.campaigns.intervals import Interval, wilson
from scenarios.rare.splitting import Population

ANCESTORS_MIN = 6
"""Of the unsafe landings. With six the interval's factor is still 2.6 of a normal one's 2; with two it would be 12."""
MOVED_MIN = 0.25
"""Share of the copies at each level. What stays shows in the ancestors, but with fewer a level shows little new."""


class Verdict(Enum):
    """Whether a splitting has converged, else why not."""

    CONVERGED = "converged"
    FAILED = "a landing raised an error"
    NOTHING_WORSE = "most landings have the same margin, so that none is worse than the others"
    NONE_UNSAFE = "no landing is unsafe down to the least probability: it may be lower (--level)"
    STUCK = "at some level most copies did not move: more moves are needed (--moves)"
    FEW_ANCESTORS = "the unsafe landings descend from too few of the first ones: more landings are needed (--particles)"


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """What came of a splitting.

    Attributes:
        verdict: whether it has converged.
        probability: with its 95 % interval, None where it has not.
        unsafe: landings of the last population that are.
        ancestors: of the first population, of which those descend.
    """

    verdict: Verdict
    probability: Interval | None
    unsafe: int
    ancestors: int


def estimate(population: Population) -> Estimate:
    """Return the probability of an unsafe landing."""
    unsafe = population.unsafe
    families = Counter(particle.ancestor for particle in unsafe)
    verdict = _verdict(population, families)
    probability = _interval(population, families) if verdict is Verdict.CONVERGED else None
    return Estimate(verdict=verdict, probability=probability, unsafe=len(unsafe), ancestors=len(families))


def _verdict(population: Population, families: Counter[int]) -> Verdict:
    margins = [particle.margin for particle in population.particles]
    if population.errors:
        return Verdict.FAILED
    if not families:
        return Verdict.NOTHING_WORSE if 2 * margins.count(min(margins)) > len(margins) else Verdict.NONE_UNSAFE
    if any(level.moved < MOVED_MIN for level in population.levels):
        return Verdict.STUCK
    return Verdict.CONVERGED if len(families) >= ANCESTORS_MIN else Verdict.FEW_ANCESTORS


def _interval(population: Population, families: Counter[int]) -> Interval:
    count, unsafe = len(population.particles), families.total()
    if not population.levels:  # a plain campaign
        return wilson(unsafe, count)
    value = population.probability * unsafe / count
    variance = math.log1p(_relative_variance(population, families))  # of the logarithm
    reach = float(stats.t.ppf(0.975, len(families) - 1)) * math.sqrt(variance)
    low, high = (value * math.exp(0.5 * variance + side * reach) for side in (-1.0, 1.0))
    return Interval(value=value, low=low, high=min(1.0, high))


def _relative_variance(population: Population, families: Counter[int]) -> float:
    count, unsafe = len(population.particles), families.total()
    survivors = [level.survivors for level in population.levels]
    together = sum(size**2 for size in families.values()) / unsafe**2
    factor = count / (count - 1) * math.prod(count**2 / (count**2 - count + kept) for kept in survivors)
    independent = sum(1.0 / kept - 1.0 / count for kept in (*survivors, unsafe))
    return max(independent, 1.0 - factor * (1.0 - together))
