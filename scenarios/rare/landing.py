"""Landings of a splitting as tasks that any process can do: the noise decides everything random in them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol

from link.errors import UserError
from scenarios.campaigns.landing_task import error_line
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.warm_up import warm_process
from scenarios.processes.local_workers import LocalWorkers
from scenarios.processes.pool import run_batch
from scenarios.rare.chain import Walk, Walked, walk
from scenarios.rare.noise import MovedNoise
from scenarios.rare.splitting import Fly
from scenarios.recordings.result import score_run


class Subject(Protocol):
    """What is landed on."""

    def scenario(self, noise: MovedNoise) -> Scenario:
        """Return what is flown with `noise`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One scenario, which only the run's own noise changes."""

    cell: Scenario

    def scenario(self, noise: MovedNoise) -> Scenario:  # noqa: ARG002 (a cell is the same for all)
        """Return the scenario."""
        return self.cell


def fly_margin(subject: Subject, noise: MovedNoise) -> float:
    """Fly a landing in lockstep and return its margin, negative exactly if it is unsafe."""
    scenario = subject.scenario(noise)
    lockstep = Lockstep(scenario, noise)
    lockstep.run()
    return score_run(scenario, noise, lockstep.recording).margin


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    place: int
    walk: Walk


@dataclass(frozen=True, slots=True, kw_only=True)
class _Done:
    place: int
    walked: Walked


@dataclass(frozen=True, slots=True, kw_only=True)
class Chains:
    """The job of the processes: a chain of landings on a subject."""

    subject: Subject

    def __call__(self, task: _Task) -> _Done:
        """Return where a chain ends; one with a landing that raises ends where it began, with the error."""
        warm_process()
        try:
            walked = walk(task.walk, lambda noise: fly_margin(self.subject, noise))
        except UserError:
            raise
        except Exception as error:  # noqa: BLE001 (it is reported, and no probability is given)
            return _failed(task, error_line(error))
        return _Done(place=task.place, walked=walked)


def _failed(task: _Task, why: str) -> _Done:
    start = task.walk
    margin = 0.0 if start.margin is None else start.margin
    return _Done(place=task.place, walked=Walked(noise=start.noise, margin=margin, flown=0, taken=0, error=why))


@contextmanager
def flying(subject: Subject, workers: int) -> Iterator[Fly]:
    """Yield what flies chains on `workers` processes of this machine, which end with the context."""
    pool: LocalWorkers[_Task, _Done] = LocalWorkers(Chains(subject=subject), workers)
    with pool:

        def fly(walks: Sequence[Walk]) -> list[Walked]:
            tasks = [_Task(place=place, walk=one) for place, one in enumerate(walks)]
            results = [done for _, done in run_batch(pool, tasks, lost=_failed)]
            return [done.walked for done in sorted(results, key=lambda done: done.place)]

        yield fly
