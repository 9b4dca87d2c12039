"""The reliability diagram: how often what was forecast came true, beside the band of right forecasts."""

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.recordings.contact_forecasts import INSTANTS
from scenarios.reports.figure_files import BLUE, LIGHT


def draw_reliability(found: Sequence[Mapping[str, Any]]) -> Figure:
    """Return the figure of `scenarios.campaigns.reliability`: a row for each instant, a column for each outcome."""
    outcomes = list(dict.fromkeys(one["outcome"] for one in found))
    instants = [name for name in INSTANTS if any(one["instant"] == name for one in found)]
    figure = Figure(figsize=(3.4 * len(outcomes), 0.4 + 3.2 * len(instants)), layout="constrained")
    grid = figure.subplots(len(instants), len(outcomes), squeeze=False)
    for one in found:
        _draw_panel(grid[instants.index(one["instant"])][outcomes.index(one["outcome"])], one)
    return figure


def _draw_panel(axes: Axes, one: Mapping[str, Any]) -> None:
    bins = one["bins"]
    said, came = [each["said"] for each in bins], [each["came"] for each in bins]
    most = max(0.05, *said, *came, *(each["high"] for each in bins)) * 1.05
    axes.plot([0.0, most], [0.0, most], color=LIGHT, linewidth=0.8, zorder=0)
    axes.vlines(said, [each["low"] for each in bins], [each["high"] for each in bins], color=LIGHT, linewidth=4.0)
    axes.plot(said, came, color=BLUE, marker="o", markersize=4, linestyle="none")
    axes.set(xlim=(0.0, most), ylim=(-0.02 * most, most), xlabel="forecast", ylabel="came true")
    axes.set_title(f"{one['outcome']}, at {one['instant']}: {one['said']:.1f}, came {one['came']}", fontsize=8)
