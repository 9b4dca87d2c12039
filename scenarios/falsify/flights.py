"""Batches of landings on local processes, which stay from batch to batch; results in the order asked."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from types import TracebackType
from typing import Self

from scenarios.config import Scenario
from scenarios.falsify.trial import Outcome, Trial, fly_trial, lost
from scenarios.processes.local_workers import LocalWorkers
from scenarios.processes.pool import run_batch

Flight = tuple[Scenario, int]
"""A scenario and the seed that it is flown with."""


class Flights(AbstractContextManager["Flights"]):
    """Flies landings, as long as a `with` block.

    Args:
        workers: local processes.
        landed: called with each outcome as it comes, in any order.
    """

    def __init__(self, workers: int, landed: Callable[[Outcome], None]) -> None:
        self._workers: LocalWorkers[Trial, Outcome] = LocalWorkers(fly_trial, workers)
        self._landed = landed

    def __enter__(self) -> Self:
        self._workers.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._workers.__exit__(kind, error, trace)

    def __call__(self, flights: Sequence[Flight], is_last: Callable[[Outcome], bool]) -> list[Outcome]:
        """Return the outcomes of `flights` in their order, up to the first that is the last one wanted.

        Raises:
            UserError: the processes end before they are ready.
        """
        outcomes: dict[int, Outcome] = {}
        ends = len(flights)

        def trials() -> Iterator[Trial]:
            for index, (scenario, seed) in enumerate(flights):
                if index < ends:
                    yield Trial(index=index, seed=seed, scenario=scenario.model_dump_json())

        for trial, outcome in run_batch(self._workers, trials(), lost=lost):
            outcomes[trial.index] = outcome
            self._landed(outcome)
            if is_last(outcome):
                ends = min(ends, trial.index + 1)
        return [outcomes[index] for index in range(ends)]
