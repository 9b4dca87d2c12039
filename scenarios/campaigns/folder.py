"""A campaign's folder: what is flown, and the rows as they come, so that nothing done is lost.

`campaign.json` says what is flown, `landings.jsonl` takes a line for each landing when it is done, and from these
come `landings.parquet`, which only cells, seeds and sources decide, and `timing.parquet`. These two are read
where there are no lines; beside them they may lack what was flown by a process that was killed.
"""

import fcntl
import json
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from link.errors import UserError
from link.program.text import read_bounded
from link.program.toml_config import validate
from scenarios.campaigns.landing_task import Flown, Row, Task
from scenarios.campaigns.landings_file import as_written, read_rows, write_rows
from scenarios.campaigns.plan import Plan
from scenarios.recordings.result import write_json

_SHOWN = 60  # characters of what a line says
_PLAN_BYTES_MAX = 256 << 20  # a cell takes 20 kB
_PLAN, _JOURNAL, _LANDINGS, _TIMING = "campaign.json", "landings.jsonl", "landings.parquet", "timing.parquet"


def create_folder(path: Path | None, plan: Plan) -> Path:
    """Make the folder of a new campaign, `runs/<time>-campaign` if not told otherwise.

    Raises:
        UserError: it holds something already, or cannot be made.
    """
    folder = path or Path("runs") / f"{datetime.now(UTC):%Y%m%dT%H%M%S}-{os.getpid()}-campaign"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise UserError(f"{folder}: not empty; choose another --out, or go on with --resume")
        write_json(folder / _PLAN, plan.model_dump(mode="json"))
    except OSError as error:
        raise UserError(f"{folder}: cannot be made ({error.strerror}); choose another --out") from None
    return folder


def read_plan(folder: Path) -> Plan:
    """Return what the campaign in `folder` flies.

    Raises:
        UserError: there is none, or it does not fit.
    """
    path = folder / _PLAN
    try:
        table = json.loads(read_bounded(path, _PLAN_BYTES_MAX))
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); is this a campaign's folder?") from None
    except (ValueError, RecursionError):
        raise UserError(f"{path}: not valid JSON") from None
    return validate(Plan, table, source=str(path))


def read_landings(folder: Path) -> list[Row]:
    """Return the rows of the campaign in `folder`; of one that was killed, or still goes on, those that are done.

    Raises:
        UserError: there are none.
    """
    plan = read_plan(folder)
    if (folder / _LANDINGS).exists() and not (folder / _JOURNAL).exists():
        return [_with_firmware(row, plan, folder / _LANDINGS) for row in read_rows(folder / _LANDINGS)]
    rows = [_with_firmware(flown.row, plan, folder / _JOURNAL) for flown in _list_newest(folder)]
    if not rows:
        raise UserError(f"{folder}: no landing is done; go on with: scenarios campaign --resume {folder}")
    return as_written(rows, folder / _JOURNAL)


def _with_firmware(row: Row, plan: Plan, path: Path) -> Row:
    """Return a row that names its firmware, as those of earlier versions do not.

    Raises:
        UserError: it is of no cell of the campaign.
    """
    cell = str(row.get("cell"))
    if cell not in plan.flown:
        raise UserError(
            f"{path}: has a landing of {cell[:_SHOWN]!r}, which is not in {_PLAN}; is it another campaign's?"
        )
    return {"firmware": plan.flown[cell].firmware} | row


def read_timing(folder: Path) -> list[Row]:
    """Return how long the landings of the campaign in `folder` took to compute, by cell and seed.

    Raises:
        UserError: nobody wrote it down.
    """
    if not (folder / _JOURNAL).exists():
        return read_rows(folder / _TIMING)
    return as_written([_timing(flown) for flown in _list_newest(folder)], folder / _JOURNAL)


def missing_landings(folder: Path) -> str | None:
    """Return a line that says what of a campaign is not done yet, None when nothing is missing or it is no campaign.

    Raises:
        UserError: nothing is done.
    """
    if not (folder / _PLAN).exists():
        return None
    done, planned = len(read_landings(folder)), len(read_plan(folder).tasks())
    if done >= planned:
        return None
    return f"{done} of {planned} landings are done; go on with: scenarios campaign --resume {folder}"


def _list_newest(folder: Path) -> Collection[Flown]:
    """Return the newest line of each landing in the journal; the one at which a process was interrupted is left out.

    The Parquet files are written from it, but only when a campaign ends by itself.
    """
    path = folder / _JOURNAL
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None
    return {_task_of(one.row): one for one in _lines(path, data[: data.rfind(b"\n") + 1])}.values()


class Journal:
    """The rows of a campaign that is being flown; to be had from `open_journal`.

    Args:
        folder: of the campaign.
        done: what was flown before, by task.
        descriptor: of the open file.
    """

    def __init__(self, folder: Path, done: dict[Task, Flown], descriptor: int) -> None:
        self._folder = folder
        self._done = done
        self._descriptor = descriptor

    @property
    def done(self) -> dict[Task, Flown]:
        """What is flown."""
        return dict(self._done)

    def add(self, flown: Flown) -> None:
        """Write a landing down.

        Raises:
            UserError: the disk is full, or takes nothing else either.
        """
        line = json.dumps({"wall_s": flown.wall_s, "times": dict(flown.times)} | flown.row) + "\n"
        left = memoryview(line.encode())
        try:
            while left:
                left = left[os.write(self._descriptor, left) :]
        except OSError as error:
            raise UserError(
                f"{self._folder}: cannot be written ({error.strerror}); make room, and go on with: "
                f"scenarios campaign --resume {self._folder}"
            ) from None
        self._done[_task_of(flown.row)] = flown

    def write_results(self) -> None:
        """Write the Parquet files of what is flown, if anything is."""
        if not self._done:
            return
        plan = read_plan(self._folder)
        versions = {"commit": plan.commit or "not known"} | plan.versions
        write_rows(self._folder / _LANDINGS, [flown.row for flown in self._done.values()], versions)
        write_rows(self._folder / _TIMING, [_timing(flown) for flown in self._done.values()], versions)


@contextmanager
def open_journal(folder: Path) -> Iterator[Journal]:
    """Open the journal of the campaign in `folder` for one writer; rows that are errors count as not done.

    Raises:
        UserError: another process writes into it, or it cannot be opened.
    """
    path = folder / _JOURNAL
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
    except OSError as error:
        raise UserError(f"{path}: cannot be opened ({error.strerror})") from None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield Journal(folder, _read_journal(path, descriptor), descriptor)
    except BlockingIOError:
        raise UserError(f"{folder}: another campaign is writing here") from None
    finally:
        os.close(descriptor)


def _read_journal(path: Path, descriptor: int) -> dict[Task, Flown]:
    """Return what was flown; the line at which the last process was interrupted is cut off."""
    data = path.read_bytes()
    whole = data.rfind(b"\n") + 1
    os.ftruncate(descriptor, whole)
    return {_task_of(one.row): one for one in _lines(path, data[:whole]) if one.row["error"] is None}


def _lines(path: Path, data: bytes) -> list[Flown]:
    found: list[Flown] = []
    for number, line in enumerate(data.splitlines(), 1):
        try:
            found.append(_flown_of(json.loads(line)))
        except (ValueError, RecursionError, AttributeError, KeyError, TypeError):
            raise UserError(f"{path}: line {number} is no landing; delete it, and go on with --resume") from None
    return found


def _flown_of(table: Any) -> Flown:
    """Return a landing as its line has it.

    Raises:
        AttributeError, KeyError, TypeError: it is none.
    """
    flown = Flown(wall_s=float(table.pop("wall_s")), times=dict(table.pop("times", {})), row=table)
    task, times, error = _task_of(table), flown.times.values(), table["error"]
    kinds = (isinstance(task.cell, str), type(task.seed) is int, error is None or isinstance(error, str))
    if not all(kinds) or not all(isinstance(one, int | float) for one in times):
        raise TypeError
    return flown


def _timing(flown: Flown) -> Row:
    times = {"wall_s": flown.wall_s, **flown.times}
    head = _key(flown.row) | {"firmware": flown.row.get("firmware")}
    return head | {name: round(value, 6) for name, value in times.items()}


def _key(row: Row) -> dict[str, Any]:
    return {"cell": row["cell"], "seed": row["seed"]}


def _task_of(row: Row) -> Task:
    return Task(**_key(row))
