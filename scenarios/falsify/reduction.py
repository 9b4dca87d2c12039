"""An unsafe world reduced to what it needs to be unsafe.

First its quantities are put back to their medians, then the details of the scenario that remains are made ideal. What
is kept goes at least half as far beyond the limit as what was found, so that no case hangs on the limit itself.
"""

from collections.abc import Callable, Mapping, Sequence
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


_Try = tuple[Scenario | None, Mapping[str, float]]
"""A scenario, None where nothing valid remains, and the uniform numbers that are not at their medians."""


class Reduction:
    """Flies what is left of a found world, and keeps what is unsafe enough.

    Args:
        found: the world.
        space: that it was found in.
        fly: flies landings.
        landings: how many may be flown; when they are used up, the case stays as it is.
        keep: is given the case as it was found, and then each smaller one.
    """

    def __init__(
        self, found: Found, space: Space, fly: Fly, *, landings: int, keep: Callable[[Case], None] = lambda _: None
    ) -> None:
        self._found = found
        self._space = space
        self._fly = fly
        self._left = landings
        self._keep = keep
        scenario = space.draw(found.seed, found.chosen)
        self._case = Case(scenario=scenario, seed=found.seed, chosen=found.chosen, outcome=found.outcome)
        self._known = {scenario.model_dump_json(): found.outcome}
        keep(self._case)

    @property
    def case(self) -> Case:
        """The case as far as it is reduced."""
        return self._case

    def put_to_medians(self) -> None:
        """Put as many of the case's quantities as can be back to their medians, the most ordinary tried first."""
        chosen, at_medians = self._case.chosen, dict.fromkeys(self._space.names, MEDIAN)

        def try_of(names: Sequence[str]) -> _Try:
            kept = {name: chosen[name] for name in sorted(names)}
            return self._space.draw(self._case.seed, at_medians | kept), kept

        names = sorted(chosen, key=lambda name: (abs(chosen[name] - MEDIAN), name))
        minimal(names, lambda selections: self._still_fail([try_of(one) for one in selections]))

    def make_ideal(self) -> None:
        """Make as many of the details of the case's scenario as can be ideal, or leave them out."""
        whole = self._case.scenario
        every = details(whole)
        minimal(
            every,
            lambda selections: self._still_fail(
                [(without(whole, set(every) - set(kept)), self._case.chosen) for kept in selections]
            ),
        )

    def _still_fail(self, tries: Sequence[_Try]) -> list[bool]:
        """Say of each try, up to the first that is so, whether it is unsafe enough; that one is the case from then on.

        A scenario that was flown is not flown again.
        """
        valid = {one.model_dump_json(): one for one, _ in tries if one is not None}
        new = [text for text in valid if text not in self._known][: self._left]
        if new and not any(self._fails(self._known.get(text)) for text in valid):
            outcomes = self._fly([(valid[text], self._found.seed) for text in new], self._fails)
            self._left -= len(outcomes)
            self._known |= zip(new, outcomes, strict=False)
        outcomes_by_try = [None if one is None else self._known.get(one.model_dump_json()) for one, _ in tries]
        answers = [self._fails(outcome) for outcome in outcomes_by_try]
        if True in answers:
            first = answers.index(True)
            self._accept(*tries[first], outcomes_by_try[first])
        return answers

    def _accept(self, scenario: Scenario | None, chosen: Mapping[str, float], outcome: Outcome | None) -> None:
        if scenario is not None and outcome is not None:
            self._case = Case(scenario=scenario, seed=self._found.seed, chosen=chosen, outcome=outcome)
            self._keep(self._case)

    def _fails(self, outcome: Outcome | None) -> bool:
        worst = self._found.outcome.margin
        if outcome is None or outcome.margin is None or worst is None:
            return False
        return outcome.is_unsafe and outcome.margin <= _DEPTH_KEPT * worst
