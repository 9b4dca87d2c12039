"""How the search chooses worlds, a start at a time: CMA-ES, or at random.

CMA-ES, by pycma, starts from the medians with the population's own spread.

The first generation is therefore drawn as random worlds are. The covariance stays diagonal: a full one of so many
quantities cannot be learnt from some hundred landings (Ros and Hansen 2008). A point that is not plausible is repaired
before it is flown, and the strategy learns from the repaired one, so that its mean stays plausible too: what does not
matter cannot use up the distance from the medians. A start is given up when it no longer gets better.

Source: Hansen, The CMA Evolution Strategy: A Tutorial, arXiv 1604.00772.
"""

from collections.abc import Sequence
from typing import Protocol

import cma
import numpy as np

from scenarios.falsify.space import Array, plausible
from scenarios.simulation.noise import named_rng

_COST_OUTSIDE = (
    0.02  # for each squared unit outside: margins are of the order of 1, and what lies outside of some units
)
_RANDOM_GENERATION = 16
_PATIENCE = 8  # generations
_BETTER = 0.01  # by less a generation is no better: a hundredth of what separates far inside from the limit


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
    """CMA-ES.

    Args:
        dimension: of the space.
        seed: of its random numbers.
    """

    def __init__(self, dimension: int, seed: int) -> None:
        rng = named_rng(seed, "falsify")
        options = {
            "CMA_diagonal": True,
            "randn": lambda *shape: rng.standard_normal(shape),
            "seed": np.nan,  # leaves the global generator alone
            "verbose": -9,
            "verb_log": 0,
            "signals_filename": "",
        }
        self._cma = cma.CMAEvolutionStrategy(np.zeros(dimension), 1.0, options)
        self._asked: list[Array] = []
        self._best = np.inf
        self._generations_since = 0

    @property
    def is_stale(self) -> bool:
        """Whether it has not become better for some generations."""
        return self._generations_since >= _PATIENCE or bool(self._cma.stop())

    def ask(self) -> list[Array]:
        """Return the plausible points of the next generation."""
        self._asked = [plausible(z) for z in self._cma.ask()]
        return self._asked

    def tell(self, margins: Sequence[float]) -> None:
        """Take the margins of the points last asked for, in their order."""
        self._cma.tell(self._asked, list(margins))
        if min(margins) < self._best - _BETTER:
            self._best, self._generations_since = min(margins), 0
        else:
            self._generations_since += 1
