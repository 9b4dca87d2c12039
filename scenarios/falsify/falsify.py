"""A falsification: the search, the reduction of what it finds, and what is kept of both.

Its folder has `landings.jsonl`, a line for each landing as it was flown, and from the moment that there is one
`found.toml`, the world as it was found, and `case.toml`, as far as it is reduced: what ends it early loses no result.
"""

import json
import os
import re
import textwrap
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import tomli_w

from link.errors import UserError
from link.program.toml_config import merge
from scenarios.config import Scenario
from scenarios.falsify.flights import Flight, Flights
from scenarios.falsify.reduction import Case, Reduction
from scenarios.falsify.search import Found, Space, search
from scenarios.falsify.trial import Outcome
from scenarios.recordings.result import write_text

_SECTIONS = ("track", "sensors", "wind", "link", "vehicle", "system")
"""All stand in the file, those of nothing but defaults too: without them the catalogue's presets would be taken."""
_WIDTH = 120
_ARRAY = re.compile(r"\[\n([^\[\]]*),\n *\]")
"""Of plain values; tomli_w gives each a line of its own."""


def case_text(scenario: Scenario, notes: Sequence[str]) -> str:
    """Return the TOML of `scenario`: what differs from the defaults, under `notes` as comments.

    Args:
        scenario: whose name is the file's to give.
        notes: a paragraph each.
    """
    table: dict[str, Any] = scenario.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    table.pop("name")
    own = {key: value for key, value in table.items() if key not in _SECTIONS}
    sections = {key: table.get(key, {}) for key in _SECTIONS}
    sections["track"] = {"kind": scenario.track.kind} | sections["track"]
    frames = scenario.system.companion.integrity.receiver_frames.value  # not told, the catalogue would tell of it
    sections["system"] = merge(sections["system"], {"companion": {"integrity": {"receiver_frames": frames}}})
    lines = [line for note in notes for line in textwrap.wrap(note, _WIDTH - 2, break_long_words=False)]
    comment = "".join(f"# {line}\n" for line in lines)
    return f"{comment}\n{_ARRAY.sub(_in_one_line, tomli_w.dumps(own | sections))}"


def _in_one_line(array: re.Match[str]) -> str:
    values = [line.strip().removesuffix(",") for line in array[1].splitlines()]
    return f"[{', '.join(values)}]"


LANDINGS, FOUND, CASE = "landings.jsonl", "found.toml", "case.toml"

Progress = Callable[[str, Outcome], None]
"""Called for each landing with the part that it belongs to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked for.

    Attributes:
        slice: of the domain that is searched.
        seed: of the first start.
        landings: that the search may fly.
        reduction: landings that the reduction may fly.
        workers: local processes.
        only: first parts of the names of the quantities that are searched, such as `driver`; empty for all.
        random: whether worlds are drawn at random, to compare with.
    """

    slice: str
    seed: int
    landings: int
    reduction: int
    workers: int
    only: tuple[str, ...] = ()
    random: bool = False

    @property
    def command(self) -> str:
        """The command that asks for it; the number of processes does not show in the result."""
        options = ["--landings", self.landings, "--seed", self.seed, "--reduction", self.reduction]
        options += ["--only", ",".join(self.only)] if self.only else []
        options += ["--random"] if self.random else []
        return " ".join(str(part) for part in ("scenarios falsify", self.slice, *options))


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What came of it; `found` and `case` are None where no unsafe world was found."""

    landings: int
    errors: int
    margin_min: float | None
    found: Found | None
    case: Case | None

    def to_json(self, request: Request) -> dict[str, Any]:
        """Return the result as a table of plain values."""
        case = self.case
        return {
            "slice": request.slice,
            "seed": request.seed,
            "landings": self.landings,
            "errors": self.errors,
            "margin_min": self.margin_min,
            "found": None if self.found is None else _shown(self.found.outcome) | {"landing": self.found.landing},
            "case": None
            if case is None
            else _shown(case.outcome) | {"seed": case.seed, "quantities": len(case.chosen)},
        }


def falsify(request: Request, space: Space, folder: Path, progress: Progress) -> Result:
    """Search `space` for an unsafe world, reduce it, and keep everything in `folder`.

    Raises:
        UserError: the folder cannot be written, or processes cannot start.
    """
    with _Recorder(request, folder, progress) as flown:
        found = search(
            space,
            flown.fly,
            first_seed=request.seed,
            landings=request.landings,
            random=request.random,
        )
        case = None
        if found is not None:
            reduction = Reduction(found, space, flown.fly, landings=request.reduction, keep=flown.keep)
            for flown.part, reduce in (("medians", reduction.put_to_medians), ("ideal", reduction.make_ideal)):
                reduce()
            case = reduction.case
        return flown.result(found, case)


def create_folder(path: Path | None) -> Path:
    """Make the folder of a falsification, `runs/<time>-falsify` if not told otherwise.

    Raises:
        UserError: it holds something already, or cannot be made.
    """
    folder = path or Path("runs") / f"{datetime.now(UTC):%Y%m%dT%H%M%S}-{os.getpid()}-falsify"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise UserError(f"{folder}: not empty; choose another --out")
    except OSError as error:
        raise UserError(f"{folder}: cannot be made ({error.strerror}); choose another --out") from None
    return folder


class _Recorder(AbstractContextManager["_Recorder"]):
    """Flies landings, and writes each batch down; `part` says what they are for."""

    def __init__(self, request: Request, folder: Path, progress: Progress) -> None:
        self.part = "search"
        self._request = request
        self._folder = folder
        self._flights = Flights(request.workers, lambda outcome: progress(self.part, outcome))
        self._lines: list[str] = []
        self._outcomes: list[Outcome] = []

    def __enter__(self) -> Self:
        self._flights.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._flights.__exit__(kind, error, trace)

    def fly(self, flights: Sequence[Flight], is_last: Callable[[Outcome], bool]) -> list[Outcome]:
        """Fly a batch and return its outcomes in order, up to the first that is the last one wanted."""
        outcomes = self._flights(flights, is_last)
        for (_, seed), outcome in zip(flights, outcomes, strict=False):
            self._outcomes.append(outcome)
            line = {"landing": len(self._outcomes), "part": self.part, "seed": seed} | asdict(outcome)
            self._lines.append(json.dumps(line) + "\n")
        write_text(self._folder / LANDINGS, "".join(self._lines))
        return outcomes

    def keep(self, case: Case) -> None:
        """Write a case down: the first as it was found, each as far as it is reduced."""
        if self.part == "search":
            write_text(self._folder / FOUND, case_text(case.scenario, _notes(self._request, case, FOUND)))
        write_text(self._folder / CASE, case_text(case.scenario, _notes(self._request, case, CASE)))

    def result(self, found: Found | None, case: Case | None) -> Result:
        """Return what came of it."""
        margins = [one.margin for one in self._outcomes if one.margin is not None]
        return Result(
            landings=len(self._outcomes),
            errors=sum(one.error is not None for one in self._outcomes),
            margin_min=min(margins) if margins else None,
            found=found,
            case=case,
        )


def _shown(outcome: Outcome) -> dict[str, Any]:
    return {"margin": outcome.margin, "reason": outcome.reason}


def _notes(request: Request, case: Case, file: str) -> list[str]:
    """Return what a case's file says about itself."""
    state = "as found" if file == FOUND else "as far as it was reduced"
    changed = ", ".join(f"{name} {u:.4f}" for name, u in case.chosen.items())
    return [
        f"An unsafe landing that a search found, {state}. Found by: {request.command}",
        f"Fly it: scenarios run {file} --lockstep --seed {case.seed}",
        f"Then: margin {case.outcome.margin:.3f}, {case.outcome.reason}",
        f"Quantities of {request.slice} away from their medians (as uniform numbers): {changed or 'none'}",
    ]
