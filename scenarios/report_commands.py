"""The commands about the source report: `table report` and `figures report`."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.errors import UserError
from scenarios.campaign_commands import JsonOption, table_command

_REPORT = "report"


def register(app: typer.Typer) -> None:
    """Add the commands to `app`."""
    app.command("table")(report_or_campaign_table)
    app.command("figures")(figures_command)


def report_or_campaign_table(
    what: Annotated[str, typer.Argument(metavar="report|CAMPAIGN", help="The report, or a campaign's folder.")],
    *,
    seeds: Annotated[
        int, typer.Option("--seeds", min=1, metavar="N", help="Flights of each case of the report.")
    ] = 100,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, metavar="N", help="Local processes [default: one a core].")
    ] = None,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the report's tables as docs/report.md has them.")
    ] = (False),
    as_json: JsonOption = False,
) -> None:
    """Print the report's outcomes, published against measured; or a campaign's summary again."""
    if what != _REPORT:
        table_command(Path(what), as_json=as_json)
        return
    from scenarios.report_table import fly_report, print_report, write_markdown  # noqa: PLC0415 (numerics are slow to load)

    table = fly_report(seeds, workers)
    if as_json:
        sys.stdout.write(json.dumps(table, indent=2, allow_nan=False) + "\n")
    elif markdown:
        write_markdown(table, sys.stdout)
    else:
        print_report(table, sys.stdout)


def figures_command(
    what: Annotated[str, typer.Argument(metavar="report", help="Whose figures.")],
    *,
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Where the figures are written.")] = Path(
        "runs/figures"
    ),
) -> None:
    """Draw the report's figures, measured, as PNG and SVG."""
    if what != _REPORT:
        raise UserError(f"there are no figures of '{what}': only of {_REPORT}")
    from scenarios.report_figures import draw_report  # noqa: PLC0415 (numerics are slow to load)

    for file in draw_report(out):
        sys.stdout.write(f"{file}\n")
