"""Landings of a splitting as tasks that any process can do: the noise decides everything random in them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol

from link.errors import UserError
from scenarios.campaigns.landing_task import error_line
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import with_firmware
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.warm_up import warm_process
from scenarios.processes.local_workers import LocalWorkers
from scenarios.processes.pool import run_batch
from scenarios.rare.chain import Walk, Walked, walk
from scenarios.rare.noise import MovedNoise
from scenarios.rare.splitting import Fly
from scenarios.recordings.result import score_run
from scenarios.worlds.odd import quantities_of
from scenarios.worlds.world import draw_world

WHOLE = "world"
"""The whole domain; `world:urban` and the like are its slices."""


class Subject(Protocol):
    """What is landed on."""

    @property
    def name(self) -> str:
        """As it is reported."""

    def scenario(self, noise: MovedNoise) -> Scenario:
        """Return what is flown with `noise`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One scenario, which only the run's own noise changes."""

    cell: Scenario

    @property
    def name(self) -> str:
        """Of the scenario."""
        return self.cell.name

    def scenario(self, noise: MovedNoise) -> Scenario:  # noqa: ARG002 (a cell is the same for all)
        """Return the scenario."""
        return self.cell


def subject_of(name: str, firmware: str | None = None) -> Subject:
    """Return what a name means: a slice of the domain, `world` or `world:SLICE`, else a scenario.

    Args:
        name: as it is given to the command.
        firmware: of a scenario, None for its own.

    Raises:
        UserError: there is no such slice or scenario, or a slice is given a firmware, which worlds draw.
    """
    if name != WHOLE and not name.startswith(f"{WHOLE}:"):
        return Cell(cell=load_scenario(name if firmware is None else with_firmware(name, firmware)))
    if firmware is not None:
        raise UserError(f"a world draws its firmware: leave out --firmware with '{name}'")
    quantities_of(name)
    return World(slice=name)


def fly_margin(subject: Subject, noise: MovedNoise) -> float:
    """Fly a landing in lockstep and return its margin, negative exactly if it is unsafe."""
    scenario = subject.scenario(noise)
    lockstep = Lockstep(scenario, noise)
    lockstep.run()
    return score_run(scenario, noise, lockstep.recording).margin


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """A world of a slice of the operational design domain, which the noise draws with all that happens in it."""

    slice: str

    @property
    def name(self) -> str:
        """Of the slice."""
        return self.slice

    def scenario(self, noise: MovedNoise) -> Scenario:
        """Return the scenario of the world that `noise` draws."""
        return draw_world(self.slice, noise).scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Chains:
    """The job of the processes: a chain of landings on a subject."""

    subject: Subject

    def __call__(self, start: Walk) -> Walked:
        """Return where a chain ends; one with a landing that raises ends where it began, with the error."""
        warm_process()
        try:
            return walk(start, lambda noise: fly_margin(self.subject, noise))
        except UserError:
            raise
        except Exception as error:  # noqa: BLE001 (it is reported, and no probability is given)
            return _failed(start, error_line(error))


def _failed(start: Walk, why: str) -> Walked:
    margin = 0.0 if start.margin is None else start.margin
    return Walked(noise=start.noise, margin=margin, flown=0, taken=0, error=why)


@contextmanager
def flying(subject: Subject, workers: int) -> Iterator[Fly]:
    """Yield what flies chains on `workers` processes of this machine, which end with the context."""
    pool: LocalWorkers[Walk, Walked] = LocalWorkers(Chains(subject=subject), workers)
    with pool:

        def fly(walks: Sequence[Walk]) -> list[Walked]:
            ends = dict(run_batch(pool, walks, lost=_failed))
            return [ends[start] for start in walks]

        yield fly
