"""The search for a world that is unsafe, start after start, each about another seed.

A start is aimed at the contact of a plain world where the space has an event to aim, else it is about the medians. The
first plain world is at the medians, since what is unsafe there is the easiest to read; the others are drawn.

The seed decides what no quantity does: the noise, the turbulence, the road's roughness. Only what is asked for, in its
order, decides what comes out, not how many processes fly it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from scenarios.config import Scenario
from scenarios.falsify.aim import Aim, aimed_start, plain_world
from scenarios.falsify.flights import Flight
from scenarios.falsify.space import Array, uniforms
from scenarios.falsify.strategy import EvolutionStrategy, RandomStrategy, Strategy, wide_start
from scenarios.falsify.trial import Outcome

_NO_MARGIN = 1.0  # of a landing without a result: nothing to go towards

Fly = Callable[[Sequence[Flight], Callable[[Outcome], bool]], list[Outcome]]
"""Flies landings and returns their outcomes in order, up to the first of which it is told that it is the last."""
Draw = Callable[[int, Mapping[str, float]], Scenario]
"""Makes the scenario of a seed with chosen uniform numbers, by the quantities' names."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """What is searched: the quantities by name, how a scenario is made of them, and the event to aim, if any."""

    names: tuple[str, ...]
    draw: Draw
    aim: Aim | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """An unsafe world.

    Attributes:
        landing: which one of the search it was, from 1 on.
        seed: of the world and of its run.
        chosen: the uniform numbers by the quantities' names.
        outcome: of the run.
    """

    landing: int
    seed: int
    chosen: Mapping[str, float]
    outcome: Outcome


def search(space: Space, fly: Fly, *, first_seed: int, landings: int, random: bool = False) -> Found | None:
    """Return the first unsafe world within so many landings, None without one.

    Args:
        space: that is searched.
        fly: flies them.
        first_seed: of the first start; each further start has the next.
        landings: how many may be flown.
        random: whether worlds are drawn at random, to compare with.
    """
    flown, seed = _Flown(space, fly, landings), first_seed
    while not flown.is_over:
        strategy = RandomStrategy(len(space.names), seed) if random else _strategy(space, seed, flown)
        while strategy is not None and not flown.is_over and not strategy.is_stale:
            points = strategy.ask()
            outcomes = flown.fly(seed, points)
            if len(outcomes) == len(points):
                strategy.tell([_NO_MARGIN if one.margin is None else one.margin for one in outcomes])
        seed += 1
    return flown.found


def _strategy(space: Space, seed: int, flown: "_Flown") -> Strategy | None:
    """Return how a seed's worlds are searched, None where its plain world has no contact that can be aimed at."""
    if space.aim is None:
        return EvolutionStrategy(wide_start(len(space.names)), seed)
    plain = plain_world(space.names, seed if flown.has_any else None, space.aim)
    (outcome,) = flown.fly(seed, [plain])
    if outcome.time_to_contact_s is None or outcome.margin is None:
        return None
    contact_s, margin = outcome.time_to_contact_s, outcome.margin
    start = aimed_start(space.names, seed, space.aim, plain, contact_s=contact_s, margin=margin)
    return None if start is None else EvolutionStrategy(start, seed)


class _Flown:
    """Flies the points of a search until one is unsafe or no landings are left."""

    def __init__(self, space: Space, fly: Fly, landings: int) -> None:
        self.found: Found | None = None
        self._space = space
        self._fly = fly
        self._landings = landings
        self._count = 0

    @property
    def is_over(self) -> bool:
        """Whether nothing is to be flown any more."""
        return self.found is not None or self._count >= self._landings

    @property
    def has_any(self) -> bool:
        """Whether a landing was flown."""
        return self._count > 0

    def fly(self, seed: int, points: Sequence[Array]) -> list[Outcome]:
        """Return the outcomes of as many of the points as may be flown, up to the first that is unsafe."""
        asked = [uniforms(self._space.names, z) for z in points[: self._landings - self._count]]
        outcomes = self._fly([(self._space.draw(seed, chosen), seed) for chosen in asked], lambda one: one.is_unsafe)
        self._count += len(outcomes)
        if outcomes[-1].is_unsafe:
            chosen = asked[len(outcomes) - 1]
            self.found = Found(landing=self._count, seed=seed, chosen=chosen, outcome=outcomes[-1])
        return outcomes
