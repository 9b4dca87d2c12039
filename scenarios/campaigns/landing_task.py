"""One landing of a campaign as a task that any process can do, and its result as one flat row."""

import time
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from threading import Lock
from typing import Any

from companion.situation.phases import LANDING_PHASES, Phase
from link.errors import UserError
from scenarios.campaigns.cells import Cell, draw
from scenarios.campaigns.conditions import conditions_of, disturbances_before
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.stopwatch import quantiles_ms, timed_steps
from scenarios.lockstep.warm_up import warm_process
from scenarios.recordings.contact_forecasts import forecast_columns
from scenarios.recordings.reason_counts import Approaches, abort_reasons, anew_reasons, counts_of, counts_text
from scenarios.recordings.recording import Recording
from scenarios.recordings.result import result_table
from scenarios.recordings.versions import sources

Row = dict[str, Any]
"""A landing's result by column: plain values, None where there is none; `error` tells why there is no result."""

_LANDING = frozenset(phase.value for phase in LANDING_PHASES)
_NOT_FLAT = frozenset({"scenario", "seed", "phases_s", "approaches"})  # of a result's table, what a row has otherwise
_ONE_AT_A_TIME = Lock()  # threads of one process would only share its interpreter


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A landing to be flown: the cell's scenario with this seed."""

    cell: str
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Flown:
    """A landing's row, and how long it took to compute, which is no part of the result.

    Attributes:
        row: the result.
        wall_s: of the whole landing.
        times: by column, `cpu_s` of the process and quantiles of the planner's steps in milliseconds.
    """

    row: Row
    wall_s: float
    times: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Flights:
    """The job of a campaign's processes.

    Attributes:
        cells: by their names.
        sources: of the project, as `scenarios.recordings.versions` has them; a process with others refuses.
    """

    cells: Mapping[str, Cell]
    sources: str

    def __call__(self, task: Task) -> Flown:
        """Return what came of a task; one that raises is a row with its error.

        Raises:
            UserError: this process has other sources.
        """
        if sources() != self.sources:
            raise UserError("a worker has other sources than this program: install the same on all, or start again")
        with _ONE_AT_A_TIME:
            warm_process()
            began_s, began_cpu_s = time.perf_counter(), time.process_time()
            with timed_steps() as durations_s:
                row = _row(task, self.cells[task.cell])
            wall_s, cpu_s = time.perf_counter() - began_s, time.process_time() - began_cpu_s
            return Flown(row=row, wall_s=wall_s, times={"cpu_s": cpu_s} | _planner_ms(durations_s["planner"]))

    def only(self, cell: str) -> "Flights":
        """Return the job for tasks of one cell."""
        return Flights(cells={cell: self.cells[cell]}, sources=self.sources)


def _row(task: Task, cell: Cell) -> Row:
    """Return the row of a landing that is drawn and flown; of one that raises, what was known of it until then."""
    known: Row = {"firmware": cell.firmware}
    try:
        drawn = draw(cell, task.seed)
        known = {"firmware": drawn.scenario.firmware, **drawn.columns}
        return known | fly(task, drawn.scenario)
    except Exception as error:  # noqa: BLE001 (one landing's fault must not end a campaign, and is reported)
        return failed_row(task, known, error_line(error))


def _planner_ms(durations_s: Sequence[float]) -> dict[str, float]:
    """Return the planner's quantiles by column, none where nothing was planned."""
    quantiles = quantiles_ms(durations_s) if durations_s else {}
    return {f"planner_{name}_ms": value for name, value in quantiles.items()}


def fly(task: Task, scenario: Scenario) -> Row:
    """Fly a landing in lockstep and return its row."""
    lockstep = Lockstep(scenario, task.seed)
    ended = lockstep.run()
    row = row_of(task, result_table(scenario, task.seed, lockstep.recording, ended), lockstep.recording)
    start_ns = lockstep.recording.drone[0].t_ns
    row |= forecast_columns(lockstep.recording.statuses, start_ns, row, scenario.system.companion.descent)
    return row | conditions_of(scenario) | disturbances_before(scenario, task.seed, row["instant_s"])


def row_of(task: Task, table: Mapping[str, Any], recording: Recording) -> Row:
    """Return a run's result as a row: the table without its nesting, how often it waved off, and why.

    Args:
        task: whose result it is; the cell stands for the table's scenario.
        table: as `result.json` has it.
        recording: of the run.
    """
    values = {name: value for name, value in table.items() if name not in _NOT_FLAT}
    times_s = table["phases_s"]
    phases = {f"phase_{phase.name.lower()}_s": times_s.get(phase.value) for phase in Phase}
    tried = approach_columns(table["approaches"])
    return _head(task) | values | wave_offs([status.phase for status in recording.statuses]) | tried | phases


def failed_row(task: Task, known: Row, error: str) -> Row:
    """Return the row of a task that has no result, with what is known of it all the same, such as its firmware."""
    return known | _head(task) | {"error": error}


def wave_offs(phases: Sequence[str]) -> dict[str, int]:
    """Return how often, in a run's phases, an approach was broken off, and how often another one followed."""
    steps = list(pairwise(phases))
    return {
        "aborts": sum(after == Phase.ABORT.value != before for before, after in steps),
        "retries": sum(before == Phase.ABORT.value and after in _LANDING for before, after in steps),
    }


def approach_columns(approaches: Approaches) -> Row:
    """Return how many approaches there were, and the names of the reasons that ended or delayed them.

    Args:
        approaches: as `result.json` has them.
    """
    aborts, anew = abort_reasons(approaches), anew_reasons(approaches)
    return {
        "approaches": len(approaches),
        "first_abort": aborts[0] if aborts else None,
        "last_abort": aborts[-1] if aborts else None,
        "aborts_by_reason": counts_text(counts_of(aborts)),
        "begun_anew_by_reason": counts_text(counts_of(anew)),
    }


def _head(task: Task) -> Row:
    return {"cell": task.cell, "seed": task.seed, "error": None}


def error_line(error: Exception) -> str:
    """Return an error in one line with the place that raised it, the same on every machine."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    file = last.filename.replace("\\", "/").rsplit("/", 1)[-1]
    return " ".join(f"{type(error).__name__}: {error} ({file}, {last.name})".split())
