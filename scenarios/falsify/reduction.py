"""An unsafe world reduced to what it needs to be unsafe.

First its quantities are put back to their medians, then the details of the scenario that remains are made ideal. What
is kept goes at least half as far beyond the limit as what was found, so that no case hangs on the limit itself.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scenarios.config import Scenario
from scenarios.falsify.minimal import minimal
from scenarios.falsify.search import Fly, Found, Space
from scenarios.falsify.simplify import details, without
from scenarios.falsify.space import MEDIAN
from scenarios.falsify.trial import Outcome

_DEPTH_KEPT = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A case that was reduced.

    Attributes:
        scenario: that is unsafe.
        seed: that it is unsafe with.
        chosen: the uniform numbers that are not at their medians, by the quantities' names.
        outcome: of its run.
    """

    scenario: Scenario
    seed: int
    chosen: Mapping[str, float]
    outcome: Outcome


class Reduction:
    """Flies what is left of a found world, and keeps what is unsafe enough.

    Args:
        found: the world.
        space: that it was found in.
        fly: flies landings.
        landings: how many may be flown; when they are used up, the case stays as it is.
    """

    def __init__(self, found: Found, space: Space, fly: Fly, *, landings: int) -> None:
        self._found = found
        self._space = space
        self._fly = fly
        self._left = landings
        self._known: dict[str, Outcome] = {}

    def found(self) -> Case:
        """Return the case as it was found."""
        scenario = self._space.draw(self._found.seed, self._found.chosen)
        self._known[scenario.model_dump_json()] = self._found.outcome
        return self._case(scenario, self._found.chosen)

    def at_medians(self, case: Case) -> Case:
        """Return `case` with as many of its quantities as can be at their medians, the most ordinary tried first."""

        def scenario_of(names: Sequence[str]) -> Scenario:
            at_median = dict.fromkeys(self._space.names, MEDIAN)
            return self._space.draw(case.seed, at_median | {name: case.chosen[name] for name in names})

        names = sorted(case.chosen, key=lambda name: (abs(case.chosen[name] - MEDIAN), name))
        kept = minimal(names, lambda selections: self._still_fail([scenario_of(one) for one in selections]))
        return self._case(scenario_of(kept), {name: case.chosen[name] for name in sorted(kept)})

    def ideal(self, case: Case) -> Case:
        """Return `case` with as many of its scenario's details as can be ideal or left out."""
        every = details(case.scenario)

        def scenario_of(kept: Sequence[object]) -> Scenario | None:
            return without(case.scenario, set(every) - set(kept))

        kept = minimal(every, lambda selections: self._still_fail([scenario_of(one) for one in selections]))
        return self._case(scenario_of(kept) or case.scenario, case.chosen)

    def _case(self, scenario: Scenario, chosen: Mapping[str, float]) -> Case:
        outcome = self._known[scenario.model_dump_json()]
        return Case(scenario=scenario, seed=self._found.seed, chosen=chosen, outcome=outcome)

    def _still_fail(self, scenarios: Sequence[Scenario | None]) -> list[bool]:
        """Say of each scenario, up to the first that is so, whether it is unsafe enough.

        One that was flown is not flown again.
        """
        valid = {one.model_dump_json(): one for one in scenarios if one is not None}
        new = [text for text in valid if text not in self._known][: self._left]
        if new and not any(self._fails(self._known.get(text)) for text in valid):
            outcomes = self._fly([(valid[text], self._found.seed) for text in new], self._fails)
            self._left -= len(outcomes)
            self._known |= zip(new, outcomes, strict=False)
        return [one is not None and self._fails(self._known.get(one.model_dump_json())) for one in scenarios]

    def _fails(self, outcome: Outcome | None) -> bool:
        worst = self._found.outcome.margin
        if outcome is None or outcome.margin is None or worst is None:
            return False
        return outcome.is_unsafe and outcome.margin <= _DEPTH_KEPT * worst
