"""The command `retries`."""

import json
import sys
from collections.abc import Mapping, Sequence
from contextlib import closing
from statistics import median
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.errors import UserError
from link.program.cli import JsonOption, note
from link.program.extras import require
from scenarios.commands.options import LANDINGS_MAX, FirstSeedOption, OneFirmwareOption, WorkersOption

if TYPE_CHECKING:
    from scenarios.config import FirmwareName
    from scenarios.faults.retry import Retried, RetryCase

_SCENARIOS = (
    "straight_5+sensors=nominal+wind=nominal+link=nominal",
    "straight_10+sensors=nominal+wind=nominal+link=nominal",
)
_HEIGHTS_M = (1.0, 0.3)  # where a descent may still wait, and where it is committed
_SHARE_MIN = 0.95  # accepted: of the next approaches that land
_OVERSHOOT_MAX_M = 0.5  # accepted
_WIDTHS = {
    "firmware": 11,
    "height_m": 10,
    "seeds": 7,
    "broken_off": 12,
    "lands_at_once": 15,
    "lands": 7,
    "unsafe": 8,
    "overshoot_m": 13,
    "overshoot_max_m": 17,
    "takes_s": 9,
}


def register(app: typer.Typer) -> None:
    """Add `retries` to `app`."""
    app.command("retries")(retries_command)


def retries_command(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENARIO...", help="What is flown [default: straight_5 and straight_10, nominal]."),
    ] = None,
    *,
    height: Annotated[
        list[float] | None,
        typer.Option("--height", min=0.05, metavar="M", help="Over the pad, may be repeated [default: 1 and 0.3]."),
    ] = None,
    seeds: Annotated[
        int, typer.Option("--seeds", min=1, max=LANDINGS_MAX, metavar="N", help="Of each scenario and height.")
    ] = 10,
    first_seed: FirstSeedOption = 1,
    firmware: OneFirmwareOption = None,
    workers: WorkersOption = None,
    as_json: JsonOption = False,
) -> int:
    """Break descents off and see whether the next approach lands; exit code 1 when fewer than 95 % do."""
    require("campaign", "scenarios retries")
    from link.program.settings import refuse_variables
    from scenarios.catalogue.catalogue import load_scenario
    from scenarios.catalogue.firmware_option import with_firmware
    from scenarios.config import FIRMWARES

    refuse_variables()
    if firmware is not None and firmware not in FIRMWARES:
        raise UserError(f"--firmware is one of {', '.join(FIRMWARES)}, not '{firmware}'")
    firmwares = tuple(one for one in FIRMWARES if firmware in {None, one})
    heights_m = height or _HEIGHTS_M
    for name in names or _SCENARIOS:
        scenario = load_scenario(with_firmware(name, firmwares[0]))  # tells what is wrong before anything is flown
        _check_heights(heights_m, name, scenario.system.companion.chase.height_m)
    drawn = range(first_seed, first_seed + seeds)
    groups = _groups(names or _SCENARIOS, firmwares, heights_m, drawn)
    found: dict[RetryCase, Retried] = {}
    try:
        _fly(groups, found, workers)
    except KeyboardInterrupt:
        note(f"broken off: {len(found)} of {sum(map(len, groups))} descents are flown")
        _write(groups, found, as_json=as_json)
        raise
    rows = _write(groups, found, as_json=as_json)
    return 0 if all(row["right"] for row in rows) else 1


def _check_heights(heights_m: Sequence[float], name: str, chased_m: float) -> None:
    """Refuse heights at which no descent is: it begins at that of the chase."""
    if (highest_m := max(heights_m)) > chased_m:
        raise UserError(f"--height {highest_m:g}: on {name} a descent begins {chased_m:g} m over the pad; give less")


def _groups(
    names: Sequence[str], firmwares: Sequence["FirmwareName"], heights_m: Sequence[float], seeds: Sequence[int]
) -> "list[list[RetryCase]]":
    """Return the descents to be broken off, by scenario, firmware and height."""
    from scenarios.faults.retry import RetryCase

    return [
        [RetryCase(scenario=name, firmware=firmware, height_m=height_m, seed=seed) for seed in seeds]
        for name in names
        for firmware in firmwares
        for height_m in heights_m
    ]


def _fly(groups: "Sequence[Sequence[RetryCase]]", found: "dict[RetryCase, Retried]", workers: int | None) -> None:
    """Break off each descent, and put down in `found` what came of it."""
    from scenarios.faults.retry import fly_retry, lost
    from scenarios.processes.local_workers import LocalWorkers, core_count
    from scenarios.processes.pool import run_tasks

    fliers = LocalWorkers(fly_retry, workers or core_count())
    with closing(run_tasks(fliers, [case for group in groups for case in group], lost=lost)) as results:
        found.update((retried.case, retried) for retried in results)


def _write(
    groups: "Sequence[Sequence[RetryCase]]", found: "Mapping[RetryCase, Retried]", *, as_json: bool
) -> list[dict[str, Any]]:
    """Write the figures of the groups of which something is flown, and return them."""
    flown = [[found[case] for case in group if case in found] for group in groups]
    rows = [_row(group) for group in flown if group]
    if as_json:
        sys.stdout.write(json.dumps({"groups": rows}, indent=2) + "\n")
    else:
        sys.stdout.writelines(_lines(rows))
    return rows


def _row(group: "Sequence[Retried]") -> dict[str, Any]:
    """Return the figures of the landings of one scenario, firmware and height."""
    from scenarios.recordings.result import LANDED
    from scenarios.scoring.score import Tier

    case = group[0].case
    climbs_m = [one.overshoot_m for one in group if one.overshoot_m is not None]
    times_s = [one.takes_s for one in group if one.takes_s is not None and one.lands_at_once]
    at_once = sum(one.lands_at_once for one in group)
    most_m = max(climbs_m, default=None)
    return {
        "scenario": case.scenario,
        "firmware": case.firmware,
        "height_m": case.height_m,
        "seeds": len(group),
        "broken_off": len(climbs_m),
        "lands_at_once": at_once,
        "lands": sum(one.tier in LANDED for one in group),
        "unsafe": sum(one.tier is Tier.UNSAFE for one in group),
        "overshoot_m": _rounded(median(climbs_m) if climbs_m else None),
        "overshoot_max_m": _rounded(most_m),
        "takes_s": _rounded(median(times_s) if times_s else None),
        "others": [
            {"seed": one.case.seed, "tier": one.tier.value, "judged": one.judged, "reasons": list(one.reasons)}
            for one in group
            if not one.lands_at_once
        ],
        "right": at_once >= _SHARE_MIN * len(group) and most_m is not None and most_m <= _OVERSHOOT_MAX_M,
    }


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 2)


def _lines(rows: Sequence[dict[str, Any]]) -> list[str]:
    lines = [_line({name: name for name in _WIDTHS}, "scenario")]
    for row in rows:
        lines.append(_line(row, row["scenario"] + ("" if row["right"] else "  NOT RIGHT")))
        lines += [
            f"  seed {one['seed']}: {one['tier']}, {one['judged']} {' '.join(one['reasons'])}\n"
            for one in row["others"]
        ]
    return lines


def _line(row: dict[str, Any], last: str) -> str:
    return "".join(f"{row[name]!s:{width}}" for name, width in _WIDTHS.items()) + f"{last}\n"
