"""Charts of a run that can be turned and zoomed in a browser, by plotly; the only file that imports it."""

from typing import Any

import numpy as np
import plotly.graph_objects as go  # type: ignore[import-untyped]  # it has no annotations
from plotly.offline import get_plotlyjs  # type: ignore[import-untyped]  # it has no annotations
from plotly.subplots import make_subplots  # type: ignore[import-untyped]  # it has no annotations

from scenarios.reports.path_figures import bounds_m
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import distances, heights, landing_window

_ASPECT_MIN = 0.3
_CHART_SIZE = 1.7  # of the longest axis, so that a straight road fills the width
_CHART_EYE = {"x": -0.5, "y": -1.5, "z": 0.9}
_EVERY = 4  # samples of the truth, 25 a second


def path_chart(run: RunData) -> str:
    """Return the paths of drone and pad in space, to be turned."""
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


def motion_chart(run: RunData) -> str:
    """Return distance and height over time, to be zoomed, with the phases shaded."""
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


def plotly_script() -> str:
    """Return what draws the charts; it belongs into the head of their page."""
    return str(get_plotlyjs())


def _div(chart: Any, name: str) -> str:
    return str(chart.to_html(full_html=False, include_plotlyjs=False, div_id=f"chart-{name}"))
