"""A campaign: many landings of some cells, each with the same seeds, on all cores or on a Dask cluster.

A landing is decided by its scenario and seed, so neither the number of processes nor their order shows in the result.
"""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from scenarios.campaigns.folder import open_journal
from scenarios.campaigns.landing_task import Flights, Flown, Row, Task, failed_row
from scenarios.campaigns.plan import Plan
from scenarios.processes.dask_workers import DaskWorkers
from scenarios.processes.local_workers import LocalWorkers, core_count
from scenarios.processes.pool import Workers, run_tasks


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
    flown = plan.flown
    flights = Flights(cells=flown, sources=plan.versions["sources"])
    workers: Workers[Task, Flown]
    if where.scheduler is None:
        workers = LocalWorkers(flights, core_count() if where.workers is None else where.workers)
    else:
        jobs = {cell: flights.only(cell) for cell in flown}
        workers = DaskWorkers(where.scheduler, lambda task: jobs[task.cell])
    return run_tasks(
        workers,
        tasks,
        lost=lambda task, why: Flown(row=failed_row(task, {"firmware": flown[task.cell].firmware}, why), wall_s=0.0),
    )
