"""The command `faults`."""

import json
import math
import sys
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.errors import UserError
from link.program.cli import JsonOption
from link.program.extras import require
from scenarios.commands.options import OneFirmwareOption, WorkersOption

if TYPE_CHECKING:
    from scenarios.faults.matrix import Case
    from scenarios.faults.trial import Ended

_WIDTHS = {
    "firmware": 11,
    "fault": 40,
    "phase": 11,
    "ended": 18,
    "tier": 8,
    "motors": 8,
    "tilt_max_deg": 14,
    "right": 7,
}


def register(app: typer.Typer) -> None:
    """Add `faults` to `app`."""
    app.command("faults")(faults_command)


def faults_command(
    *,
    workers: WorkersOption = None,
    firmware: OneFirmwareOption = None,
    fault: Annotated[
        str | None, typer.Option("--fault", metavar="TEXT", help="Only faults with this in their name.")
    ] = None,
    phase: Annotated[str | None, typer.Option("--phase", metavar="NAME", help="Only in this phase.")] = None,
    wire: Annotated[
        bool, typer.Option("--wire", help="With real programs, in real time: the faults that allow it.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Let every fault happen in every phase of a landing or sortie; exit code 1 when a reaction is not as expected."""
    require("campaign", "scenarios faults")
    from scenarios.config import FIRMWARES
    from scenarios.faults.matrix import EXPECTED, EXPECTED_OVER_WIRE
    from scenarios.faults.sortie_matrix import EXPECTED_IN_SORTIE
    from scenarios.faults.wire_flight import WIRE_FAULTS

    if firmware is not None and firmware not in FIRMWARES:
        raise UserError(f"--firmware is one of {', '.join(FIRMWARES)}, not '{firmware}'")
    possible = [
        case
        for case in (*EXPECTED, *(EXPECTED_OVER_WIRE if wire else EXPECTED_IN_SORTIE))
        if firmware in {None, case.firmware} and (not wire or case.fault in WIRE_FAULTS)
    ]
    named = [case for case in possible if fault is None or fault in case.fault.value]
    cases = [case for case in named if phase in {None, case.phase.value}]
    if not named:
        raise UserError(f"no fault that is flown so has '{fault}' in its name; there are: {_listed(possible, 'fault')}")
    if not cases:
        raise UserError(f"none is flown so in the phase '{phase}'; there are: {_listed(named, 'phase')}")
    with closing(_fly(cases, workers, wire=wire)) as flown:
        rows = list(map(_row, flown) if as_json else _told(map(_row, flown)))
    if as_json:
        sys.stdout.write(json.dumps({"cases": rows}, indent=2) + "\n")
    else:
        sys.stdout.write(f"{sum(row['right'] for row in rows)} of {len(rows)} are right\n")
    return 0 if all(row["right"] for row in rows) else 1


def _listed(cases: "Sequence[Case]", what: str) -> str:
    return "; ".join(sorted({getattr(case, what).value for case in cases}))


def _fly(cases: Sequence["Case"], workers: int | None, *, wire: bool) -> Generator["Ended", None, None]:
    """Let each fault happen in its phase; yield how that ended, in the order of the cases, while others still fly."""
    from scenarios.faults.trial import fly_case, fly_case_over_wire, lost
    from scenarios.processes.local_workers import LocalWorkers, core_count
    from scenarios.processes.pool import run_tasks

    fliers = LocalWorkers(fly_case_over_wire, workers or 1) if wire else LocalWorkers(fly_case, workers or core_count())
    found: dict[Case, Ended] = {}
    with closing(run_tasks(fliers, cases, lost=lost)) as results:
        for case in cases:
            while case not in found:
                ended = next(results)
                found[ended.case] = ended
            yield found.pop(case)


def _told(rows: Iterable[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Pass rows on, each written first: all of them take the better part of an hour."""
    sys.stdout.write(_line({name: name for name in (*_WIDTHS, "reason")}))
    for row in rows:
        sys.stdout.write(_line(row | {"right": "yes" if row["right"] else "NO"}))
        sys.stdout.flush()
        yield row


def _row(ended: "Ended") -> dict[str, Any]:
    return {
        "firmware": ended.case.firmware,
        "fault": ended.case.fault.value,
        "phase": ended.case.phase.value,
        "ended": ended.phase.value,
        "reason": ended.reason,
        "tier": ended.tier.value,
        "judged": ended.judged,
        "motors": "off" if ended.motors_off else "on",
        "tilt_max_deg": round(math.degrees(ended.tilt_max_rad), 1),
        "setpoints_when_out": ended.setpoints,
        "taken_back": ended.taken_back,
        "right": ended.is_right,
    }


def _line(row: dict[str, Any]) -> str:
    return "".join(f"{row[name]!s:{width}}" for name, width in _WIDTHS.items()) + f"{row['reason']}\n"
