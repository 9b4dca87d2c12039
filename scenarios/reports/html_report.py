"""One page about a run or a campaign that opens offline: verdict, figures, tables, configuration and versions.

The figures are those of `scenarios figures`; a run's path and motion can also be turned and zoomed (plotly, embedded).
"""

import io
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import plotly.graph_objects as go  # type: ignore[import-untyped]  # it has no annotations
from matplotlib.figure import Figure
from plotly.offline import get_plotlyjs  # type: ignore[import-untyped]  # it has no annotations
from plotly.subplots import make_subplots  # type: ignore[import-untyped]  # it has no annotations

from link.errors import UserError
from link.program.toml_config import dump_toml
from scenarios.campaigns.folder import read_landings, read_plan
from scenarios.campaigns.summary import summarize
from scenarios.campaigns.tables import print_summary
from scenarios.reports.campaign_figures import campaign_figures
from scenarios.reports.figure_files import STYLES
from scenarios.reports.figures import is_campaign
from scenarios.reports.path_figures import bounds_m
from scenarios.reports.run_data import RunData, read_run
from scenarios.reports.run_figures import run_figures
from scenarios.reports.run_shown import distances, heights, landing_window

_ASPECT_MIN = 0.3
_CHART_SIZE = 1.7  # of the longest axis, so that a straight road fills the width
_CHART_EYE = {"x": -0.5, "y": -1.5, "z": 0.9}
_EVERY = 4  # samples of the truth, 25 a second
_CAPTIONS = {
    "path_3d": "The way in space",
    "path_above": "The way from above, and where each phase began",
    "motion": "Position, speed, height and distance; phases shaded, the contact dotted",
    "funnel": "The approach as the deck sees it",
    "touchdown": "The touchdown on the pad",
    "estimate": "The estimate's error inside its band of two standard deviations",
    "touchdowns": "First contacts on the pad, forward up",
    "errors": "Share of the landings within a distance of the pad's centre",
}
_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 76rem; margin: 2rem auto; padding: 0 1rem; color: #111; }
table { border-collapse: collapse; margin: .5rem 0 1.5rem; }
td, th { padding: .15rem .9rem .15rem 0; text-align: left; }
td { border-top: 1px solid #ddd; } figure { margin: 1.5rem 0; } figure svg { max-width: 100%; height: auto; }
figcaption { color: #444; } pre { background: #f5f5f5; padding: .8rem; overflow-x: auto; font-size: 11.5px; }
.verdict { font-size: 1.3rem; border-left: .4rem solid #111; padding-left: .8rem; }
"""
_UNITS = (("_m_s", "m/s"), ("_rad", "rad"), ("_m", "m"), ("_s", "s"))


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
    verdict = f"{result['tier']}: {result['reason']}"
    phases = "".join(
        f"<tr><td>{escape(span.phase)}</td><td>{span.from_s:.2f}</td><td>{span.to_s - span.from_s:.2f}</td>"
        f"<td>{escape(span.reason)}</td></tr>"
        for span in run.phases
    )
    parts = [
        f'<p class="verdict">{escape(verdict)}</p>',
        f"<p>{escape(run.scenario.description)}</p>",
        "<h2>Result</h2>",
        _table(_known(result)),
        "<h2>Path</h2>",
        _path_chart(run),
        "<h2>Motion</h2>",
        _motion_chart(run),
        "<h2>Figures</h2>",
        _figures(run_figures(run)),
        "<h2>Phases</h2><table><tr><th>phase</th><th>from [s]</th><th>for [s]</th><th>reason</th></tr>",
        f"{phases}</table>",
        "<h2>Scenario and configuration</h2>",
        f"<details><summary>scenario.toml</summary><pre>{escape(dump_toml(run.scenario))}</pre></details>",
        f"<details><summary>companion.toml</summary><pre>{escape(dump_toml(run.config))}</pre></details>",
        "<h2>Versions</h2>",
        _table({key: value for key, value in run.head.metadata.items() if key != "seed"}),
    ]
    return _page(f"{result['scenario']}, seed {result['seed']}", parts)


def _campaign_page(folder: Path) -> str:
    plan, rows = read_plan(folder), read_landings(folder)
    text = io.StringIO()
    print_summary(summarize(rows), text)
    landed = sum(row.get("tier") == "S3" for row in rows)
    scenarios = "".join(
        f"<details><summary>{escape(cell)}</summary><pre>{escape(dump_toml(scenario))}</pre></details>"
        for cell, scenario in plan.scenarios.items()
    )
    parts = [
        f'<p class="verdict">{landed} of {len(rows)} landings reached S3</p>',
        "<h2>Summary</h2>",
        f"<pre>{escape(text.getvalue())}</pre>",
        "<h2>Figures</h2>",
        _figures(campaign_figures(plan, rows)),
        "<h2>Scenarios and configuration</h2>",
        scenarios,
        "<h2>Versions</h2>",
        _table(plan.versions),
    ]
    return _page(f"Campaign {folder.resolve().name}", parts)


def _page(title: str, parts: list[str]) -> str:
    script = f"<script>{get_plotlyjs()}</script>" if any("plotly-graph-div" in part for part in parts) else ""
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style>{script}</head><body><h1>{escape(title)}</h1>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )


def _figures(figures: Mapping[str, Figure]) -> str:
    return "\n".join(
        f"<figure>{_svg(figure, name)}<figcaption>{escape(_CAPTIONS[name])}</figcaption></figure>"
        for name, figure in figures.items()
    )


def _svg(figure: Figure, name: str) -> str:
    """Return a figure to be put into a page; ids are its own, so that figures do not draw each other's parts."""
    text = io.StringIO()
    with mpl.rc_context({**STYLES, "svg.hashsalt": name}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def _table(rows: Mapping[str, str]) -> str:
    return (
        "<table>" + "".join(f"<tr><td>{escape(k)}</td><td>{escape(v)}</td></tr>" for k, v in rows.items()) + "</table>"
    )


def _known(result: Mapping[str, Any]) -> dict[str, str]:
    """Return the rows of a result's table; what a run of its kind cannot know is left out."""
    told_elsewhere = {"phases_s", "reason"}
    return {_label(k): _value(v) for k, v in result.items() if v is not None and k not in told_elsewhere}


def _label(key: str) -> str:
    for ending, unit in _UNITS:
        if key.endswith(ending):
            return f"{key.removesuffix(ending).replace('_', ' ')} [{unit}]"
    return key.replace("_", " ")


def _value(value: Any) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.3f}"
        case _:
            return str(value)


def _path_chart(run: RunData) -> str:
    shown = run.t_s >= landing_window(run)[0]
    drone = run.log.position_enu_m[shown][::_EVERY]
    vehicle = run.log.vehicle_position_enu_m[shown][::_EVERY]
    height_m = vehicle[:, 2] + run.scenario.vehicle.roof_height_m
    lines = (
        ("drone", drone.T, {"color": "black", "width": 5}),
        ("pad", (*vehicle.T[:2], height_m), {"color": "gray", "width": 4, "dash": "dash"}),
    )
    chart = go.Figure(
        [go.Scatter3d(x=x, y=y, z=z, mode="lines", name=name, line=style) for name, (x, y, z), style in lines]
    )
    ranges_m = [bounds_m(np.concatenate([drone[:, k], vehicle[:, k]])) for k in range(3)]
    ranges_m[2] = (0.0, ranges_m[2][1])
    spans_m = [high_m - low_m for low_m, high_m in ranges_m]
    ratio = [_CHART_SIZE * max(span_m / max(spans_m), _ASPECT_MIN) for span_m in spans_m]
    titles = ("East [m]", "North [m]", "height [m]")
    axes = {
        f"{name}axis": {"title": title, "range": range_m, "nticks": 8 if name == "x" else 4}
        for name, title, range_m in zip("xyz", titles, ranges_m, strict=True)
    }
    view = {"aspectmode": "manual", "aspectratio": dict(zip("xyz", ratio, strict=True)), "camera": {"eye": _CHART_EYE}}
    scene = axes | view
    legend = {"x": 0.02, "y": 0.98}  # the buttons stand on the right
    chart.update_layout(height=520, margin={"l": 0, "r": 0, "t": 10, "b": 0}, scene=scene, legend=legend)
    return _div(chart, "path")


def _motion_chart(run: RunData) -> str:
    shown = run.t_s >= landing_window(run)[0]
    t_s = run.t_s[shown][::_EVERY]
    curves = (
        ("distance from the pad's centre [m]", distances(run)),
        ("height above the pad [m]", heights(run)),
    )
    chart = make_subplots(rows=len(curves), cols=1, shared_xaxes=True, vertical_spacing=0.06)
    for row, (name, values) in enumerate(curves, 1):
        line = {"color": "black"}
        chart.add_trace(go.Scatter(x=t_s, y=values[shown][::_EVERY], name=name, line=line, showlegend=False), row, 1)
        chart.update_yaxes(title_text=name.replace(" [", "<br>["), row=row, col=1)
    for index, span in enumerate(run.phases):
        if span.to_s <= t_s[0]:
            continue
        color = "rgba(0,0,0,0.08)" if index % 2 == 0 else "rgba(0,0,0,0)"
        chart.add_vrect(x0=max(span.from_s, float(t_s[0])), x1=span.to_s, fillcolor=color, line_width=0)
        middle_s = 0.5 * (max(span.from_s, float(t_s[0])) + span.to_s)
        label = {"text": span.phase, "showarrow": False, "textangle": -50, "yanchor": "bottom", "font": {"size": 11}}
        chart.add_annotation(x=middle_s, xref="x", y=1.0, yref="paper", **label)
    chart.update_xaxes(title_text="Time [s]", row=len(curves), col=1)
    chart.update_layout(height=520, margin={"l": 70, "r": 10, "t": 80, "b": 40}, template="simple_white")
    return _div(chart, "motion")


def _div(chart: Any, name: str) -> str:
    return str(chart.to_html(full_html=False, include_plotlyjs=False, div_id=f"chart-{name}"))
