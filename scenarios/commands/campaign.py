"""The commands about campaigns: `campaign`, `table` and `compare`."""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.errors import UserError
from link.program.cli import JsonOption, SetOption, note
from link.program.extras import require
from scenarios.commands.options import LANDINGS_MAX, WorkersOption

if TYPE_CHECKING:
    from scenarios.campaigns.campaign import Where
    from scenarios.campaigns.landing_task import Row
    from scenarios.campaigns.plan import Plan

_ERRORS_SHOWN = 5
_SEEDS, _FIRST_SEED = 100, 1

FolderArgument = Annotated[Path, typer.Argument(metavar="CAMPAIGN", help="Folder of a campaign.")]


def register(app: typer.Typer) -> None:
    """Add `campaign` and `compare` to `app`; `table` is also about the report, and in `scenarios.commands.report`."""
    app.command("campaign")(campaign_command)
    app.command("compare")(compare_command)


_CellsArgument = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="CELL...",
        help="Scenarios, such as straight_5+sensors=nominal; world or world:urban is another one for each seed.",
    ),
]
_SeedsOption = Annotated[
    int | None,
    typer.Option("--seeds", min=1, max=LANDINGS_MAX, metavar="N", help="Landings of each cell [default: 100]."),
]
_FirstSeedOption = Annotated[
    int | None, typer.Option("--first-seed", min=0, metavar="N", help="The others follow [default: 1].")
]
_SchedulerOption = Annotated[
    str | None, typer.Option("--scheduler", metavar="tcp://HOST:8786", help="Of an existing Dask cluster.")
]
_OutOption = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="The campaign's folder [default: in runs].")
]
_ResumeOption = Annotated[
    Path | None, typer.Option("--resume", metavar="DIR", help="Go on with what is missing or failed there.")
]
_ConfigOption = Annotated[
    Path | None, typer.Option("--config", metavar="FILE", help="The companion's configuration for all cells.")
]
_FirmwareOption = Annotated[
    str | None, typer.Option("--firmware", metavar="px4|ardupilot|both", help="In place of each cell's.")
]
_HeldBackOption = Annotated[
    bool, typer.Option("--held-back", help="Fly worlds from seed 500000 on, for a published figure, once.")
]


def campaign_command(
    cells: _CellsArgument = None,
    *,
    seeds: _SeedsOption = None,
    first_seed: _FirstSeedOption = None,
    workers: WorkersOption = None,
    scheduler: _SchedulerOption = None,
    out: _OutOption = None,
    resume: _ResumeOption = None,
    config: _ConfigOption = None,
    changes: SetOption = None,
    firmware: _FirmwareOption = None,
    held_back: _HeldBackOption = False,
    as_json: JsonOption = False,
) -> int:
    """Fly each cell with many seeds and print the summary; exit code 1 when a landing raised an error."""
    require("campaign", "scenarios campaign")
    from link.program.settings import COMPANION, refuse_variables
    from scenarios.campaigns.campaign import Where
    from scenarios.campaigns.plan import make_plan

    refuse_variables(apart_from=COMPANION)
    where = Where(workers=workers, scheduler=scheduler)
    if workers is not None and scheduler is not None:
        raise UserError("--workers is about local processes: leave it out with --scheduler")
    if resume is not None:
        if cells or held_back or any(one is not None for one in (config, changes, out, seeds, first_seed, firmware)):
            raise UserError(
                f"{resume} says what is flown: with --resume leave out cells, --config, --set, --firmware, "
                "--held-back, --out, --seeds and --first-seed"
            )
        return _resume(resume, where, as_json=as_json)
    if not cells:
        raise UserError("no cell is given; `scenarios list` shows the scenarios")
    plan = make_plan(
        cells,
        first_seed=_FIRST_SEED if first_seed is None else first_seed,
        seeds=_SEEDS if seeds is None else seeds,
        config=config,
        given=changes,
        firmware=firmware,
    )
    return _begin(plan, where, out, held_back=held_back, as_json=as_json)


def table_command(folder: FolderArgument, *, as_json: JsonOption = False, markdown: bool = False) -> None:
    """Print a campaign's summary again."""
    require("campaign", "scenarios table")
    from scenarios.campaigns.folder import read_landings, read_plan, read_timing

    say_missing(folder)
    rows, plan = read_landings(folder), read_plan(folder)
    if markdown:
        _write_markdown(rows, plan)
    else:
        _print_summary(rows, read_timing(folder), plan, as_json=as_json)


def compare_command(
    first: FolderArgument,
    second: FolderArgument,
    *,
    apart_from: Annotated[
        str | None,
        typer.Option("--apart-from", metavar="OPTION", help="Of the cells, in which they differ, such as system."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Compare two campaigns on the same cells and seeds."""
    require("campaign", "scenarios compare")
    from scenarios.campaigns.compare import compare_campaigns
    from scenarios.campaigns.tables import print_comparison

    comparison = compare_campaigns(first, second, apart_from)
    for folder in (first, second):
        say_missing(folder)
    if as_json:
        _print_json(comparison)
    else:
        print_comparison(comparison, sys.stdout)


def say_missing(folder: Path) -> None:
    """Say, beside the results, when a campaign was broken off or still goes on."""
    from scenarios.campaigns.folder import missing_landings

    text = missing_landings(folder)
    if text is not None:
        note(text)


def _begin(plan: "Plan", where: "Where", out: Path | None, *, held_back: bool, as_json: bool) -> int:
    """Make a campaign's folder and fly it."""
    from scenarios.campaigns.folder import create_folder
    from scenarios.campaigns.held_back import check_worlds, write_down_held_back

    check_worlds(plan, held_back=held_back)
    if where.scheduler is not None:
        from scenarios.processes.dask_workers import check_scheduler

        check_scheduler(where.scheduler)  # before there is a folder of a campaign that cannot begin
    folder = create_folder(out, plan)
    if held_back:
        write_down_held_back(plan)
    return _fly(folder, plan, where, as_json=as_json)


def _resume(folder: Path, where: "Where", *, as_json: bool) -> int:
    """Fly what is missing or failed in a campaign."""
    from scenarios.campaigns.folder import read_plan
    from scenarios.campaigns.plan import check_same_versions

    plan = read_plan(folder)
    check_same_versions(plan)
    return _fly(folder, plan, where, as_json=as_json)


def _fly(folder: Path, plan: "Plan", where: "Where", *, as_json: bool) -> int:
    from scenarios.campaigns.campaign import fly_campaign
    from scenarios.campaigns.folder import read_timing
    from scenarios.campaigns.progress import CampaignProgress

    note(f"campaign in {folder}")
    try:
        with CampaignProgress() as progress:
            rows = fly_campaign(folder, plan, where, progress.update)
    except KeyboardInterrupt:
        note(f"what is done is kept; go on with: scenarios campaign --resume {folder}")
        raise
    _print_summary(rows, read_timing(folder), plan, as_json=as_json)
    failed = [row for row in rows if row["error"] is not None]
    for row in failed[:_ERRORS_SHOWN]:
        note(f"{row['cell']}, seed {row['seed']}: {row['error']}")
    if len(failed) > _ERRORS_SHOWN:
        note(f"{len(failed) - _ERRORS_SHOWN} further errors; all are in {folder / 'landings.parquet'}")
    return 1 if failed else 0


def _print_summary(rows: Sequence["Row"], times: Sequence["Row"], plan: "Plan", *, as_json: bool) -> None:
    from scenarios.campaigns.reliability import reliability, reliability_sheets
    from scenarios.campaigns.sheets import print_sheets
    from scenarios.campaigns.summary import summarize
    from scenarios.campaigns.tables import print_summary
    from scenarios.campaigns.worlds_report import worlds_report
    from scenarios.campaigns.worlds_sheets import worlds_sheets

    summary, worlds = summarize(rows, times), worlds_report(rows, plan.populations)
    if as_json:
        forecasts = reliability(rows)
        found = ({"worlds": worlds} if worlds else {}) | ({"forecasts": forecasts} if forecasts else {})
        _print_json(summary | found)
        return
    print_summary(summary, sys.stdout)
    for report in worlds:
        print_sheets(worlds_sheets(report), sys.stdout)
    print_sheets(reliability_sheets(reliability(rows)), sys.stdout)


def _write_markdown(rows: Sequence["Row"], plan: "Plan") -> None:
    from scenarios.campaigns.markdown import write_markdown
    from scenarios.campaigns.reliability import reliability, reliability_sheets
    from scenarios.campaigns.sheets import write_sheets
    from scenarios.campaigns.summary import summarize
    from scenarios.campaigns.worlds_report import worlds_report
    from scenarios.campaigns.worlds_sheets import worlds_sheets

    write_markdown(summarize(rows), sys.stdout)
    for report in worlds_report(rows, plan.populations):
        write_sheets(worlds_sheets(report), sys.stdout)
    write_sheets(reliability_sheets(reliability(rows)), sys.stdout)


def _print_json(table: Mapping[str, Any]) -> None:
    sys.stdout.write(json.dumps(table, indent=2, allow_nan=False) + "\n")
