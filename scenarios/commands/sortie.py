"""The command `sortie`."""

import json
import sys
from collections.abc import Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.errors import UserError
from link.program.cli import JsonOption, note
from link.program.extras import require
from scenarios.commands.options import LANDINGS_MAX, WorkersOption

if TYPE_CHECKING:
    from scenarios.sortie.task import FlownSortie

_WIDTHS = {
    "firmware": 11,
    "seed": 7,
    "ended": 10,
    "contacts": 10,
    "error_straight_m": 18,
    "error_bend_m": 14,
    "error_max_m": 13,
    "moved_m": 9,
    "refused": 9,
    "tier": 8,
    "lift_off_s": 12,
    "return_from_m": 15,
    "return_s": 10,
}


def register(app: typer.Typer) -> None:
    """Add `sortie` to `app`."""
    app.command("sortie")(sortie_command)


def sortie_command(
    cell: Annotated[str, typer.Argument(metavar="CELL", help="A scenario whose vehicle drives, or urban.")],
    *,
    seeds: Annotated[int, typer.Option("--seeds", min=1, max=LANDINGS_MAX, metavar="N", help="How many.")] = 1,
    first_seed: Annotated[int, typer.Option("--first-seed", min=1, metavar="N", help="The others follow.")] = 1,
    firmware: Annotated[
        str, typer.Option("--firmware", metavar="px4|ardupilot|both", help="Which autopilot flies.")
    ] = "px4",
    workers: WorkersOption = None,
    as_json: JsonOption = False,
) -> int:
    """Fly whole sorties: launch from the driving deck, stations, out of sight, home.

    Exit code 1 if one is unsafe, or touches anything between lift-off and landing.
    """
    require("campaign", "scenarios sortie")
    from link.program.settings import refuse_variables
    from scenarios.catalogue.firmware_option import BOTH
    from scenarios.config import FIRMWARES
    from scenarios.processes.local_workers import LocalWorkers, core_count
    from scenarios.processes.pool import run_tasks
    from scenarios.sortie.task import SortieTask, fly_sortie, lost_sortie, sortie_scenario

    refuse_variables()
    if firmware not in {*FIRMWARES, BOTH}:
        raise UserError(f"--firmware is one of {', '.join((*FIRMWARES, BOTH))}, not '{firmware}'")
    chosen = FIRMWARES if firmware == BOTH else (firmware,)
    tasks = [
        SortieTask(cell=cell, firmware=one, seed=seed)
        for seed in range(first_seed, first_seed + seeds)
        for one in chosen
    ]
    sortie_scenario(cell, first_seed, chosen[0])
    found: dict[SortieTask, FlownSortie] = {}
    try:
        with closing(run_tasks(LocalWorkers(fly_sortie, workers or core_count()), tasks, lost=lost_sortie)) as results:
            found.update((flown.task, flown) for flown in results)
    except KeyboardInterrupt:
        note(f"broken off: {len(found)} of {len(tasks)} sorties are flown")
        _write(cell, [_row(found[task]) for task in tasks if task in found], as_json=as_json)
        raise
    rows = [_row(found[task]) for task in tasks]
    _write(cell, rows, as_json=as_json)
    return 0 if all(row["tier"] != "unsafe" and row["contacts"] == 0 for row in rows) else 1


def _write(cell: str, rows: Sequence[dict[str, Any]], *, as_json: bool) -> None:
    if as_json:
        sys.stdout.write(json.dumps({"cell": cell, "sorties": rows, "total": _total(rows)}, indent=2) + "\n")
        return
    sys.stdout.write(_line({name: name for name in (*_WIDTHS, "tier_reason")}))
    sys.stdout.writelines(_line(row) for row in rows)
    sys.stdout.write("".join(f"{name}: {value}\n" for name, value in _total(rows).items()))


def _row(flown: "FlownSortie") -> dict[str, Any]:
    return {"firmware": flown.task.firmware, "seed": flown.task.seed, **flown.score.to_json()}


def _total(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return what all sorties come to."""
    landed = [row for row in rows if row["tier"] in {"S1", "S2", "S3"}]
    return {
        "sorties": len(rows),
        "without a contact after lift-off": sum(row["contacts"] == 0 for row in rows),
        "landed, S1 or better": len(landed),
        "unsafe": sum(row["tier"] == "unsafe" for row in rows),
        "largest station error RMS on straight roads, m": _largest(rows, "error_straight_m"),
        "largest station error RMS in bends, m": _largest(rows, "error_bend_m"),
    }


def _largest(rows: Sequence[dict[str, Any]], name: str) -> float | None:
    return max((row[name] for row in rows if row[name] is not None), default=None)


def _line(row: dict[str, Any]) -> str:
    return "".join(f"{row[name]!s:{width}}" for name, width in _WIDTHS.items()) + f"{row['tier_reason']}\n"
