"""The figures of a campaign: where its landings touched down, and how the errors add up, by cell.

Beside them the reliability diagram, how often what was forecast came true beside the band of right forecasts, and of a
population of worlds the rates of what failed, over what the worlds were drawn with.
"""

import math
import textwrap
from collections.abc import Mapping, Sequence
from itertools import cycle, islice
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from scenarios.campaigns.cells import Cell
from scenarios.campaigns.intervals import wilson
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.plan import Plan
from scenarios.campaigns.reliability import reliability
from scenarios.campaigns.worlds_report import worlds_report
from scenarios.campaigns.worlds_sheets import heading_of
from scenarios.catalogue.firmware_option import without_firmware
from scenarios.config import Scenario
from scenarios.recordings.contact_forecasts import INSTANTS
from scenarios.reports.figure_files import BLUE, GREEN, LIGHT, MIDDLE, ORANGE, PURPLE, STYLES, VERMILION
from scenarios.reports.run_figures import draw_pad, show_around_pad
from scenarios.scoring.score import Tier
from scenarios.scoring.touchdown import S1_LIMITS, S2_LIMITS

_TITLE_WIDTH = 34  # characters over a panel
_COLUMNS_MAX = 3
_S1_M, _S2_M = S1_LIMITS.horizontal_error_m, S2_LIMITS.horizontal_error_m
_WORLDS_REACH_M = 1.0
_REACH_MAX_M = 3.0  # beyond, no landing is on a pad
_INTERVALS_MAX = 6  # cells; the intervals of more would cover each other


def campaign_figures(plan: Plan, rows: Sequence[Row]) -> dict[str, Figure]:
    """Return the figures by the names of their files."""
    with mpl.rc_context(STYLES):
        figures = {"touchdowns": _touchdowns(plan, rows), "errors": _errors(plan, rows)}
        forecasts = reliability(rows)
        if forecasts:
            figures["reliability"] = draw_reliability(forecasts)
        reports = {report["worlds"].replace(":", "_"): report for report in worlds_report(rows, plan.populations)}
        return figures | {f"rates_{worlds}": draw_rates(report) for worlds, report in reports.items()}


def _touchdowns(plan: Plan, rows: Sequence[Row]) -> Figure:
    """The contacts on the pad's outline, one panel a cell."""
    columns = min(len(plan.cells), _COLUMNS_MAX)
    lines = math.ceil(len(plan.cells) / columns)
    figure = Figure(figsize=(0.6 + 3.6 * columns, 0.3 + 3.8 * lines), layout="constrained")
    grid = figure.subplots(lines, columns, squeeze=False)
    for axes in grid.flat[len(plan.cells) :]:
        axes.set_visible(False)
    for axes, cell in zip(grid.flat, plan.cells, strict=False):
        _draw_target(axes, plan.flown[cell])
        touched = [row for row in rows if row["cell"] == cell and row.get("contact_forward_m") is not None]
        for secured, marker, color in ((True, "o", BLUE), (False, "x", VERMILION)):
            chosen = [row for row in touched if (row["tier"] == "S3") is secured]
            if chosen:
                axes.plot(
                    [-row["contact_left_m"] for row in chosen],
                    [row["contact_forward_m"] for row in chosen],
                    color=color,
                    marker=marker,
                    markersize=4,
                    alpha=0.6,
                    linestyle="none",
                    label=f"{'S3' if secured else 'other'} ({len(chosen)})",
                )
        if touched:
            axes.legend(loc="upper right", fontsize=8)
        axes.set_title(textwrap.fill(_name(plan, cell).replace("+", " +"), _TITLE_WIDTH), fontsize=9)
    return figure


def _draw_target(axes: Axes, cell: Cell) -> None:
    """Draw the pad that the cell has, or, where each world has its own, only how far from its centre a tier may be."""
    if isinstance(cell, Scenario):
        draw_pad(axes, cell.vehicle.pad_size_m)
        return
    show_around_pad(axes, _WORLDS_REACH_M)
    for limit_m, tier in ((_S1_M, "S1"), (_S2_M, "S2")):
        axes.add_patch(Circle((0.0, 0.0), limit_m, fill=False, linewidth=0.8, color=MIDDLE))
        axes.annotate(tier, (0.0, -limit_m), ha="center", va="top", fontsize=7, color=MIDDLE)


def _name(plan: Plan, cell: str) -> str:
    firmware = plan.flown[cell].firmware
    return without_firmware(cell) + ("" if firmware is None else f", {firmware}")


def _errors(plan: Plan, rows: Sequence[Row]) -> Figure:
    """Share of the landings whose contact is within a distance of the pad's centre, with its 95 % interval."""
    figure = Figure(figsize=(7.5, 5.0), layout="constrained")
    axes = figure.subplots()
    styles = [(color, dashes) for dashes in ("-", "--", ":") for color in (BLUE, VERMILION, GREEN, PURPLE, ORANGE)]
    with_intervals = len(plan.cells) <= _INTERVALS_MAX
    reach_m = 0.0
    for cell, (color, dashes) in zip(plan.cells, islice(cycle(styles), len(plan.cells)), strict=True):
        flown = [row for row in rows if row["cell"] == cell]
        errors_m = np.sort([row["horizontal_error_m"] for row in flown if row.get("horizontal_error_m") is not None])
        if not len(errors_m):
            continue
        reach_m = max(reach_m, float(errors_m[-1]))
        edges_m = np.array([0.0, *errors_m, _REACH_MAX_M])
        shares = [wilson(count, len(flown)) for count in (*range(len(errors_m) + 1), len(errors_m))]
        share = [one.value for one in shares]
        axes.step(edges_m, share, where="post", color=color, linestyle=dashes, label=_name(plan, cell))
        if with_intervals:
            low, high = [one.low for one in shares], [one.high for one in shares]
            axes.fill_between(edges_m, low, high, step="post", color=color, alpha=0.12, linewidth=0)
    axes.set(xlim=(0.0, 1.1 * min(reach_m, _REACH_MAX_M) or _S1_M), ylim=(0.0, 1.0))
    for limit_m, tier in ((_S2_M, "S2"), (_S1_M, "S1")):
        if limit_m <= axes.get_xlim()[1]:
            axes.axvline(limit_m, color=LIGHT, linewidth=0.8)
            axes.text(limit_m, 1.01, tier, ha="center", va="bottom", fontsize=8)
    axes.set(xlabel="horizontal error at contact [m]", ylabel="share of landings flown")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right", fontsize=8)
    return figure


def draw_reliability(found: Sequence[Mapping[str, Any]]) -> Figure:
    """Return the figure of `scenarios.campaigns.reliability`: a row for each instant, a column for each outcome."""
    outcomes = list(dict.fromkeys(one["outcome"] for one in found))
    instants = [name for name in INSTANTS if any(one["instant"] == name for one in found)]
    figure = Figure(figsize=(3.4 * len(outcomes), 0.4 + 3.2 * len(instants)), layout="constrained")
    grid = figure.subplots(len(instants), len(outcomes), squeeze=False)
    for one in found:
        _draw_outcome(grid[instants.index(one["instant"])][outcomes.index(one["outcome"])], one)
    return figure


def _draw_outcome(axes: Axes, one: Mapping[str, Any]) -> None:
    bins = one["bins"]
    said, came = [each["said"] for each in bins], [each["came"] for each in bins]
    most = max(0.05, *said, *came, *(each["high"] for each in bins)) * 1.05
    axes.plot([0.0, most], [0.0, most], color=LIGHT, linewidth=0.8, zorder=0)
    axes.vlines(said, [each["low"] for each in bins], [each["high"] for each in bins], color=LIGHT, linewidth=4.0)
    axes.plot(said, came, color=BLUE, marker="o", markersize=4, linestyle="none")
    axes.set(xlim=(0.0, most), ylim=(-0.02 * most, most), xlabel="forecast", ylabel="came true")
    axes.set_title(f"{one['outcome']}, at {one['instant']}: {one['said']:.1f}, came {one['came']}", fontsize=8)


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
        _draw_quantity(axes, name, bins)
    figure.suptitle(report["worlds"], fontsize=10)
    return figure


def _draw_quantity(axes: Axes, name: str, bins: Sequence[Mapping[str, Any]]) -> None:
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
