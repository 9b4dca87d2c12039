"""How a run is made, its folder, and what came of it."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from link.errors import UserError
from link.recording.recorder import DirectRecorder
from scenarios.recordings.recording import Recording
from scenarios.recordings.result import units_of, write_json
from scenarios.recordings.truth_file import TruthFile
from scenarios.recordings.versions import versions

Progress = Callable[[Recording, float], None]
"""Called a few times a second with what is recorded so far and the real-time factor."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How a run is made.

    Attributes:
        seed: of everything random.
        speed: simulated seconds per wall second.
        folder: to be made for the run.
        record: write what goes in and out of the companion, and the truth, as MCAP.
        view_port: of a page that shows the landing; None for none.
    """

    seed: int
    speed: float
    folder: Path
    record: bool = False
    view_port: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOutcome:
    """What came of a run: the content of `result.json` and `timing.json`."""

    result: dict[str, Any]
    timing: dict[str, Any]


def run_folder(parent: Path, name: str) -> Path:
    """Make the folder of a run and let `latest` beside it point there.

    Raises:
        UserError: `parent` cannot be written.
    """
    try:
        folder = _new_folder(parent, name)
        link = parent / f".latest-{os.getpid()}"
        link.symlink_to(folder.name)
        link.replace(parent / "latest")
    except OSError as error:
        raise UserError(f"{parent}: no folder can be made there ({error.strerror}); choose another --out") from None
    return folder


def _new_folder(parent: Path, name: str) -> Path:
    """Make a folder named by the time; where another run took this millisecond, by the next."""
    while True:
        folder = parent / f"{datetime.now(UTC).strftime('%Y%m%dT%H%M%S.%f')[:-3]}-{name}"
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            if not folder.is_dir():
                raise
        else:
            return folder


def count_lost(*recorders: DirectRecorder | TruthFile | None) -> dict[str, int]:
    """Return how many records a failing disk has cost; nothing where nothing was recorded."""
    dropped = [recorder.dropped for recorder in recorders if recorder is not None]
    return {"records_dropped": sum(dropped)} if dropped else {}


def write_outcome(folder: Path, result: dict[str, Any], timing: dict[str, Any]) -> RunOutcome:
    """Write what came of a run into its folder, the result with its units and the versions behind it, and return it."""
    result = result | {"about": {"units": units_of(result), "versions": versions()}}
    write_json(folder / "result.json", result)
    write_json(folder / "timing.json", timing)
    return RunOutcome(result=result, timing=timing)
