"""A campaign: many landings of some cells, each with the same seeds, on all cores or on a Dask cluster.

A landing is decided by its scenario and seed, so neither the number of processes nor their order shows in the result.
"""

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from companion.config.companion import CompanionConfig
from link.errors import UserError
from link.program.toml_config import load_config, merge, read_toml, validate
from scenarios.campaigns.folder import Plan, open_journal
from scenarios.campaigns.landing_task import Flights, Flown, Row, Task, failed_row
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import cells_with
from scenarios.config import Scenario
from scenarios.processes.dask_workers import DaskWorkers
from scenarios.processes.local_workers import LocalWorkers, core_count
from scenarios.processes.pool import Workers, run_tasks
from scenarios.recordings.versions import versions


@dataclass(frozen=True, slots=True, kw_only=True)
class Where:
    """Where a campaign is computed.

    Attributes:
        workers: local processes, None for one on each core.
        scheduler: address of a Dask scheduler, None for local processes.
    """

    workers: int | None = None
    scheduler: str | None = None


Progress = Callable[[Flown | None, int, int], None]
"""Called at the beginning and for each landing, with how many are done and how many there are."""


def make_plan(
    cells: Sequence[str], *, first_seed: int, seeds: int, config: Path | None, firmware: str | None = None
) -> Plan:
    """Return what a campaign flies.

    Args:
        cells: names or files, as `load_scenario` takes them.
        firmware: that each cell is flown with, `both` for each with both, None for the cell's own.
        first_seed: the others follow.
        seeds: how many.
        config: the companion's, laid over each scenario's own: only what it sets is changed.

    Raises:
        UserError: no such cell or firmware, two cells of one name, or a configuration that does not fit.
    """
    scenarios = [load_scenario(cell) for cell in cells_with(cells, firmware)]
    names = [scenario.name for scenario in scenarios]
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise UserError(f"cell '{double}' is given twice")
    if config is not None:
        load_config(config, CompanionConfig)  # by itself it has to fit as well
        table = read_toml(config)
        scenarios = [_with_companion(scenario, table, str(config)) for scenario in scenarios]
    return Plan(
        cells=names,
        first_seed=first_seed,
        seeds=seeds,
        versions=versions(),
        scenarios=dict(zip(names, scenarios, strict=True)),
    )


def check_same_versions(plan: Plan) -> None:
    """Check that a campaign can be gone on with by these sources, since results of two would be mixed.

    Raises:
        UserError: something is not what it was.
    """
    now = versions()
    changed = [name for name in sorted({*now, *plan.versions}) if now.get(name) != plan.versions.get(name)]
    if changed:
        raise UserError(f"the campaign was begun with another version of {', '.join(changed)}: start a new one")


def fly_campaign(folder: Path, plan: Plan, where: Where, progress: Progress) -> list[Row]:
    """Fly what is missing of the campaign in `folder`, write its results and return all rows.

    What is done is kept, and written as results, however it ends.

    Raises:
        UserError: the folder is in use, the cluster cannot be reached, or processes cannot start.
    """
    with open_journal(folder) as journal:
        tasks = plan.tasks()
        missing = [task for task in tasks if task not in journal.done]
        done = len(tasks) - len(missing)
        progress(None, done, len(tasks))
        try:
            with closing(_flown(plan, missing, where)) as results:
                for flown in results:
                    journal.add(flown)
                    done += 1
                    progress(flown, done, len(tasks))
        finally:
            journal.write_results()
        return [flown.row for flown in journal.done.values()]


def _flown(plan: Plan, tasks: Sequence[Task], where: Where) -> Generator[Flown, None, None]:
    flights = Flights(scenarios=plan.scenarios, sources=plan.versions["sources"])
    workers: Workers[Task, Flown]
    if where.scheduler is None:
        workers = LocalWorkers(flights, core_count() if where.workers is None else where.workers)
    else:
        jobs = {cell: flights.only(cell) for cell in plan.scenarios}
        workers = DaskWorkers(where.scheduler, lambda task: jobs[task.cell])
    return run_tasks(
        workers,
        tasks,
        lost=lambda task, why: Flown(row=failed_row(task, plan.scenarios[task.cell].firmware, why), wall_s=0.0),
    )


def _with_companion(scenario: Scenario, table: Mapping[str, Any], source: str) -> Scenario:
    """Return `scenario` with a table of the companion's configuration laid over its own."""
    below = scenario.system.companion.model_dump(mode="json")
    companion = validate(CompanionConfig, merge(below, table), source=f"{source} over {scenario.name}")
    system = scenario.system.model_copy(update={"companion": companion})
    return scenario.model_copy(update={"system": system})
