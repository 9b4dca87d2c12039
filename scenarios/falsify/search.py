"""The search for a world that is unsafe, start after start, each about another seed.

The seed decides what no quantity does: the noise, the turbulence, the road's roughness. Only what is asked for, in its
order, decides what comes out, not how many processes fly it.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from scenarios.config import Scenario
from scenarios.falsify.flights import Flight
from scenarios.falsify.space import uniforms
from scenarios.falsify.strategy import EvolutionStrategy, Strategy
from scenarios.falsify.trial import Outcome

_NO_MARGIN = 1.0  # of a landing without a result: nothing to go towards

Fly = Callable[[Sequence[Flight], Callable[[Outcome], bool]], list[Outcome]]
"""Flies landings and returns their outcomes in order, up to the first of which it is told that it is the last."""
Draw = Callable[[int, Mapping[str, float]], Scenario]
"""Makes the scenario of a seed with chosen uniform numbers, by the quantities' names."""
MakeStrategy = Callable[[int, int], Strategy]


@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """What is searched: the quantities by name, and how a scenario is made of them."""

    names: tuple[str, ...]
    draw: Draw


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


def search(
    space: Space, fly: Fly, *, first_seed: int, landings: int, make_strategy: MakeStrategy = EvolutionStrategy
) -> Found | None:
    """Return the first unsafe world within so many landings, None without one.

    Args:
        space: that is searched.
        fly: flies them.
        first_seed: of the first start; each further start has the next.
        landings: how many may be flown.
        make_strategy: of a start, from the number of quantities and its seed.
    """
    flown, seed = 0, first_seed
    while flown < landings:
        strategy = make_strategy(len(space.names), seed)
        while flown < landings and not strategy.is_stale:
            points = [uniforms(space.names, z) for z in strategy.ask()]
            asked = points[: landings - flown]
            outcomes = fly([(space.draw(seed, chosen), seed) for chosen in asked], lambda one: one.is_unsafe)
            flown += len(outcomes)
            if outcomes[-1].is_unsafe:
                return Found(landing=flown, seed=seed, chosen=asked[len(outcomes) - 1], outcome=outcomes[-1])
            if len(asked) == len(points):
                strategy.tell([_NO_MARGIN if one.margin is None else one.margin for one in outcomes])
        seed += 1
    return None
