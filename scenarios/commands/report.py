"""The commands about what was flown, runs, campaigns and the source report: `table`, `figures`, `report`, `replay`."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.errors import UserError
from link.program.cli import JsonOption
from link.program.extras import require
from scenarios.commands.campaign import say_missing, table_command
from scenarios.commands.options import LANDINGS_MAX, WorkersOption

_REPORT = "report"
_SEEDS = 100


def register(app: typer.Typer) -> None:
    """Add the commands to `app`."""
    app.command("table")(report_or_campaign_table)
    app.command("figures")(figures_command)
    app.command("report")(html_command)
    app.command("replay")(replay_command)


def report_or_campaign_table(
    what: Annotated[str, typer.Argument(metavar="report|CAMPAIGN", help="The report, or a campaign's folder.")],
    *,
    seeds: Annotated[
        int | None,
        typer.Option(
            "--seeds", min=1, max=LANDINGS_MAX, metavar="N", help="Flights of each case of the report [default: 100]."
        ),
    ] = None,
    workers: WorkersOption = None,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print tables as docs/report.md and docs/benchmark.md have them.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Print the report's outcomes, published against measured; or a campaign's summary again."""
    if markdown and as_json:
        raise UserError("--markdown and --json are two forms of the same: give one of them")
    if what != _REPORT:
        if seeds is not None or workers is not None:
            raise UserError(f"--seeds and --workers fly the report: leave them out with {what}, which is flown")
        table_command(Path(what), as_json=as_json, markdown=markdown)
        return
    require("campaign", "scenarios table report")
    from scenarios.source_report.table import fly_report, print_report, write_markdown

    table = fly_report(_SEEDS if seeds is None else seeds, workers)
    if as_json:
        sys.stdout.write(json.dumps(table, indent=2, allow_nan=False) + "\n")
    elif markdown:
        write_markdown(table, sys.stdout)
    else:
        print_report(table, sys.stdout)


def _check_folder(path: Path, meant: str) -> None:
    """Find out before the libraries are loaded, which takes seconds.

    Raises:
        UserError: there is no such folder.
    """
    if not path.is_dir():
        raise UserError(f"{path}: there is no such folder; give {meant}")


def figures_command(
    what: Annotated[
        str,
        typer.Argument(metavar="report|RUN|CAMPAIGN", help="The source report, or the folder of a run or campaign."),
    ],
    *,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Where they are written [default: in the folder].")
    ] = None,
) -> None:
    """Draw figures as PNG and SVG: of a run, of a campaign, or the source report's, measured."""
    require("report", "scenarios figures")
    if what != _REPORT:
        _check_folder(Path(what), f"that of a run or a campaign, or '{_REPORT}'")
    from scenarios.reports.figures import draw_figures

    if what == _REPORT:
        from scenarios.source_report.figures import draw_report

        files = draw_report(out or Path("runs/figures"))
    else:
        files = draw_figures(Path(what), out)
        say_missing(Path(what))
    for file in files:
        sys.stdout.write(f"{file}\n")


def html_command(
    what: Annotated[Path, typer.Argument(metavar="RUN|CAMPAIGN", help="Folder of a run or campaign.")],
    *,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The page [default: report.html in the folder].")
    ] = None,
) -> None:
    """Write a run or a campaign as one page that opens offline: verdict, figures, tables, configuration, versions."""
    require("report", "scenarios report")
    _check_folder(what, "that of a run or a campaign")
    from scenarios.reports.html_report import write_report

    page = write_report(what, out)
    say_missing(what)
    sys.stdout.write(f"{page}\n")


def replay_command(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders with a companion's recording.")],
    *,
    config: Annotated[
        Path | None, typer.Option("--config", metavar="FILE", help="Replay with this configuration instead.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Give a recording's inputs to the companion again and compare every output; exit code 1 when one differs."""
    from companion.config.companion import CompanionConfig
    from link.program.toml_config import load_config
    from scenarios.recordings.replay import read_flights, replay, text_lines

    settings = None if config is None else load_config(config, CompanionConfig)
    results = [(name, replay(flight, settings)) for run in runs for name, flight in read_flights(run)]
    if as_json:
        rows = [{"run": name, **result.to_json()} for name, result in results]
        sys.stdout.write(json.dumps({"replays": rows}, indent=2, allow_nan=False) + "\n")
    else:
        sys.stdout.write("\n".join(text_lines(results)) + "\n")
    return 1 if any(result.differences for _, result in results) else 0
