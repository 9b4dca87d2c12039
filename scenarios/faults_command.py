"""The command `faults`."""

import json
import sys
from contextlib import closing
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from scenarios.faults import Ended

_WIDTHS = {"fault": 32, "phase": 11, "ended": 18, "tier": 8, "right": 6}


def register(app: typer.Typer) -> None:
    """Add `faults` to `app`."""
    app.command("faults")(faults_command)


def faults_command(
    *,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, metavar="N", help="Local processes [default: one a core].")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
) -> int:
    """Let every fault happen in every phase of a landing; exit code 1 when a reaction is not as expected."""
    from scenarios.faults import EXPECTED, fly_case, lost
    from scenarios.pool import core_count, run_tasks

    with closing(run_tasks(fly_case, EXPECTED, workers=workers or core_count(), lost=lost)) as results:
        found = {ended.case: ended for ended in results}
    rows = [_row(found[case]) for case in EXPECTED]
    if as_json:
        sys.stdout.write(json.dumps({"cases": rows}, indent=2) + "\n")
    else:
        sys.stdout.write(_line({name: name for name in (*_WIDTHS, "reason")}))
        sys.stdout.writelines(_line(row | {"right": "yes" if row["right"] else "NO"}) for row in rows)
    return 0 if all(row["right"] for row in rows) else 1


def _row(ended: "Ended") -> dict[str, Any]:
    return {
        "fault": ended.case.fault.value,
        "phase": ended.case.phase.value,
        "ended": ended.phase.value,
        "reason": ended.reason,
        "tier": ended.tier.value,
        "judged": ended.judged,
        "setpoints_when_out": ended.setpoints,
        "taken_back": ended.taken_back,
        "right": ended.is_right,
    }


def _line(row: dict[str, Any]) -> str:
    return "".join(f"{row[name]:{width}}" for name, width in _WIDTHS.items()) + f"{row['reason']}\n"
