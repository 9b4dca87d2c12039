"""One page about a run or a campaign that opens offline: verdict, figures, tables, configuration and versions.

The figures are those of `scenarios figures`; `scenarios view` turns and plays a run.
What the pages look like is in `templates`.
"""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib.figure import Figure

from link.errors import UserError
from link.program.toml_config import dump_toml
from scenarios.campaigns.folder import read_landings, read_plan
from scenarios.campaigns.reliability import reliability, reliability_sheets
from scenarios.campaigns.summary import summarize
from scenarios.campaigns.tables import summary_sheets
from scenarios.campaigns.worlds_report import worlds_report
from scenarios.campaigns.worlds_sheets import worlds_sheets
from scenarios.reports.campaign_figures import campaign_figures
from scenarios.reports.figure_files import STYLES
from scenarios.reports.figures import is_campaign
from scenarios.reports.result_rows import result_rows
from scenarios.reports.run_data import RunData, read_run
from scenarios.reports.run_figures import run_figures

_CAPTIONS = {
    "path_3d": "The way in space; scenarios view turns it",
    "path_above": "The way from above, in the colours of the phases",
    "motion": "Speed, height, distance and tilt; phases shaded, the contact dotted",
    "funnel": "The approach as the deck sees it: while it sinks, the drone has to stay left of the cone's wall",
    "touchdown": "The touchdown on the pad, forward up",
    "estimate": "The estimate's error, its band of two standard deviations, and its NEES: the squared error over the"
    " covariance, 3 on average if that is right. Axes fit the landing; before it both may go beyond",
    "touchdowns": "First contacts on the pad, forward up",
    "errors": "Share of the landings within a distance of the pad's centre, with its 95 % intervals",
    "reliability": "How often what was forecast of the contact came true; the bars are where right forecasts lie, 95 %",
    "rates": "Landings of the worlds that were unsafe, and that were given up, with 95 % intervals",
}


def write_report(folder: Path, out: Path | None) -> Path:
    """Write the page about the run or campaign in `folder` and return its path.

    Raises:
        UserError: there is neither, or the page cannot be written.
    """
    path = out or folder / "report.html"
    page = _campaign_page(folder) if is_campaign(folder) else _run_page(read_run(folder))
    try:
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --out") from None
    return path


def _run_page(run: RunData) -> str:
    result = run.result
    return _page(
        "run.html",
        title=f"{result['scenario']}, {run.scenario.firmware}, seed {result['seed']}",
        verdict=f"{result['tier']}: {result['reason']}",
        description=run.scenario.description,
        result=result_rows(result),
        figures=_captions(run_figures(run)),
        phases=run.phases,
        approaches=result.get("approaches", ()),
        scenario=dump_toml(run.scenario),
        config=dump_toml(run.config),
        versions={key: value for key, value in run.head.metadata.items() if key != "seed"},
    )


def _campaign_page(folder: Path) -> str:
    plan, rows = read_plan(folder), read_landings(folder)
    landed = sum(row.get("tier") == "S3" for row in rows)
    return _page(
        "campaign.html",
        title=f"Campaign {folder.resolve().name}",
        verdict=f"{landed} of {len(rows)} landings reached S3",
        summary=summary_sheets(summarize(rows)),
        worlds=[worlds_sheets(report) for report in worlds_report(rows, plan.populations)],
        forecasts=reliability_sheets(reliability(rows)),
        figures=_captions(campaign_figures(plan, rows)),
        scenarios={name: dump_toml(cell) for name, cell in plan.flown.items()},
        versions={"commit": plan.commit or "not known"} | plan.versions,
    )


def _page(template: str, **values: Any) -> str:
    """Return a page; every value is escaped in it, but for the figures, which their libraries have escaped."""
    loader = PackageLoader("scenarios.reports")
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.get_template(template).render(values)


def _captions(figures: Mapping[str, Figure]) -> dict[str, str]:
    """Return figures by what stands below them."""
    return {_caption(name): _svg(figure, name) for name, figure in figures.items()}


def _caption(name: str) -> str:
    """Return what stands below a figure; of those that there are for each slice of the worlds, also of which it is."""
    if name in _CAPTIONS:
        return _CAPTIONS[name]
    kind, _, worlds = name.partition("_")
    return f"{_CAPTIONS[kind]}: {worlds}"


def _svg(figure: Figure, name: str) -> str:
    """Return a figure to be put into a page; ids are its own, so that figures do not draw each other's parts."""
    text = io.StringIO()
    with mpl.rc_context({**STYLES, "svg.hashsalt": name}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]
