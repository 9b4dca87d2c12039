"""How the search chooses worlds, a start at a time: CMA-ES about where the start begins, or at random.

The covariance of CMA-ES, by pycma, stays diagonal: a full one of so many quantities cannot be learnt from some hundred
landings (Ros and Hansen 2008). A point that is not plausible is repaired before it is flown, and the strategy learns
from the repaired one, so that its mean stays plausible too: what does not matter cannot use up the distance from the
medians. A start is given up when it no longer gets better.

Source: Hansen, The CMA Evolution Strategy: A Tutorial, arXiv 1604.00772.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import cma
import numpy as np

from scenarios.falsify.space import Array, plausible
from scenarios.simulation.noise import named_rng

_RANDOM_GENERATION = 16
_PATIENCE = 8  # generations
_BETTER = 0.01  # by less a generation is no better: a hundredth of what separates far inside from the limit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Start:
    """Where CMA-ES begins, in standard normal numbers of `n` quantities.

    Attributes:
        mean: (n,) about which the first generation is drawn.
        spread: (n,) its standard deviations, 0 for what stays.
        margin: that the first generation has to come below.
        patience: generations in a row that may be no better.
    """

    mean: Array
    spread: Array
    margin: float = np.inf
    patience: int = _PATIENCE


def wide_start(dimension: int) -> Start:
    """Return the start whose first generation is drawn as random worlds are."""
    return Start(mean=np.zeros(dimension), spread=np.ones(dimension))


class Strategy(Protocol):
    """Asks for points and is told their margins."""

    @property
    def is_stale(self) -> bool:
        """Whether it is no use to go on with it."""

    def ask(self) -> list[Array]:
        """Return the plausible points of the next generation."""

    def tell(self, margins: Sequence[float]) -> None:
        """Take the margins of the points last asked for, in their order."""


class RandomStrategy:
    """Plausible worlds as they are drawn, to compare with; each generation is a start of its own.

    Args:
        dimension: of the space.
        seed: of its random numbers.
    """

    def __init__(self, dimension: int, seed: int) -> None:
        points = named_rng(seed, "falsify random").standard_normal((_RANDOM_GENERATION, dimension))
        self._points = [plausible(z) for z in points]
        self.is_stale = False

    def ask(self) -> list[Array]:
        """Return the points."""
        self.is_stale = True
        return self._points

    def tell(self, margins: Sequence[float]) -> None:
        """Learn nothing."""


class EvolutionStrategy:
    """CMA-ES over the quantities that a start spreads.

    Args:
        start: where it begins.
        seed: of its random numbers.
    """

    def __init__(self, start: Start, seed: int) -> None:
        rng = named_rng(seed, "falsify")
        self._start = start
        self._free = np.flatnonzero(start.spread)
        options = {
            "CMA_diagonal": True,
            "CMA_stds": start.spread[self._free],
            "randn": lambda *shape: rng.standard_normal(shape),
            "seed": np.nan,  # leaves the global generator alone
            "verbose": -9,
            "verb_log": 0,
            "signals_filename": "",
        }
        self._cma = cma.CMAEvolutionStrategy(start.mean[self._free], 1.0, options)
        self._asked: list[Array] = []
        self._best = start.margin
        self._generations_since = 0

    @property
    def is_stale(self) -> bool:
        """Whether it has not become better for as long as the start has patience."""
        return self._generations_since >= self._start.patience or bool(self._cma.stop())

    def ask(self) -> list[Array]:
        """Return the plausible points of the next generation."""
        self._asked = [self._point(free) for free in self._cma.ask()]
        return self._asked

    def tell(self, margins: Sequence[float]) -> None:
        """Take the margins of the points last asked for, in their order."""
        self._cma.tell([z[self._free] for z in self._asked], list(margins))
        if min(margins) < self._best - _BETTER:
            self._best, self._generations_since = min(margins), 0
        else:
            self._generations_since += 1

    def _point(self, free: Array) -> Array:
        z = self._start.mean.copy()
        z[self._free] = free
        return plausible(z)
