"""The figure of a population of worlds: the rates of what failed, over what the worlds were drawn with."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.campaigns.worlds_sheets import heading_of
from scenarios.reports.figure_files import BLUE, VERMILION
from scenarios.scoring.score import Tier

_COLUMNS = 3
_SHOWN = ((Tier.UNSAFE, VERMILION, "o", -0.02), (Tier.ABORT, BLUE, "s", 0.02))
"""Tier, colour, marker, and how far aside of a bin's middle, as a share of the axis: bars do not cover each other."""


def draw_rates(report: Mapping[str, Any]) -> Figure:
    """Return the figure: a panel for each quantity, with a point and its 95 % interval for each bin."""
    over: Mapping[str, Sequence[Mapping[str, Any]]] = report["over"]
    lines = max(1, math.ceil(len(over) / _COLUMNS))
    figure = Figure(figsize=(3.6 * _COLUMNS, 0.6 + 2.6 * lines), layout="constrained")
    grid = figure.subplots(lines, _COLUMNS, squeeze=False)
    for axes in grid.flat[len(over) :]:
        axes.set_visible(False)
    for axes, (name, bins) in zip(grid.flat, over.items(), strict=False):
        _draw_panel(axes, name, bins)
    figure.suptitle(report["worlds"], fontsize=10)
    return figure


def _draw_panel(axes: Axes, name: str, bins: Sequence[Mapping[str, Any]]) -> None:
    span = bins[-1]["high"] - bins[0]["low"]
    for tier, color, marker, aside in _SHOWN:
        rates = [one["tiers"][tier.value] for one in bins]
        axes.errorbar(
            [0.5 * (one["low"] + one["high"]) + aside * span for one in bins],
            [100.0 * rate["share"] for rate in rates],
            yerr=[
                [100.0 * (rate["share"] - rate["low"]) for rate in rates],
                [100.0 * (rate["high"] - rate["share"]) for rate in rates],
            ],
            color=color,
            marker=marker,
            markersize=4,
            capsize=2,
            linestyle="none",
            label=tier.value,
        )
    for edge in [one["low"] for one in bins] + [bins[-1]["high"]]:
        axes.axvline(edge, color="0.9", linewidth=0.7, zorder=0)
    axes.set(xlabel=heading_of(name), ylabel="% of the landings", ylim=(0.0, None))
    axes.legend(fontsize=7)
