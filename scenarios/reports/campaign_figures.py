"""The figures of a campaign: where its landings touched down, and how the errors add up, by cell."""

import math
import textwrap
from collections.abc import Sequence
from itertools import cycle

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from scenarios.campaigns.cells import Cell
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.plan import Plan
from scenarios.campaigns.reliability import reliability
from scenarios.campaigns.worlds_report import worlds_report
from scenarios.catalogue.firmware_option import without_firmware
from scenarios.config import Scenario
from scenarios.reports.figure_files import DARK, LIGHT, MIDDLE, STYLES
from scenarios.reports.reliability_figures import draw_reliability
from scenarios.reports.run_figures import draw_pad, show_around_pad
from scenarios.reports.worlds_figures import draw_rates
from scenarios.scoring.limits import S1_LIMITS, S2_LIMITS

_TITLE_WIDTH = 34  # characters over a panel
_COLUMNS_MAX = 3
_S1_M, _S2_M = S1_LIMITS.horizontal_error_m, S2_LIMITS.horizontal_error_m
_WORLDS_REACH_M = 1.0


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
        for secured, marker in ((True, "o"), (False, "x")):
            chosen = [row for row in touched if (row["tier"] == "S3") is secured]
            if chosen:
                axes.plot(
                    [-row["contact_left_m"] for row in chosen],
                    [row["contact_forward_m"] for row in chosen],
                    color=DARK,
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
    for limit_m in (_S1_M, _S2_M):
        axes.add_patch(Circle((0.0, 0.0), limit_m, fill=False, linewidth=0.8, color=MIDDLE))


def _name(plan: Plan, cell: str) -> str:
    firmware = plan.flown[cell].firmware
    return without_firmware(cell) + ("" if firmware is None else f", {firmware}")


def _errors(plan: Plan, rows: Sequence[Row]) -> Figure:
    """Share of the landings whose contact is within a distance of the pad's centre."""
    figure = Figure(figsize=(7.5, 5.0), layout="constrained")
    axes = figure.subplots()
    styles = cycle([(DARK, "-"), (DARK, "--"), (MIDDLE, "-"), (DARK, ":"), (MIDDLE, "--"), (LIGHT, "-"), (DARK, "-.")])
    reach_m = _S1_M
    for cell, (grey, dashes) in zip(plan.cells, styles, strict=False):
        flown = [row for row in rows if row["cell"] == cell]
        errors_m = np.sort([row["horizontal_error_m"] for row in flown if row.get("horizontal_error_m") is not None])
        share = np.arange(1, len(errors_m) + 1) / max(len(flown), 1)
        if len(errors_m):
            reach_m = max(reach_m, float(errors_m[-1]))
            axes.step(
                [0.0, *errors_m, 10.0],
                [0.0, *share, share[-1]],
                where="post",
                color=grey,
                linestyle=dashes,
                label=_name(plan, cell),
            )
    for limit_m, tier in ((_S2_M, "S2"), (_S1_M, "S1")):
        axes.axvline(limit_m, color=LIGHT, linewidth=0.8)
        axes.text(limit_m, 1.01, tier, ha="center", va="bottom", fontsize=8)
    axes.set(xlim=(0.0, 1.05 * min(reach_m, 3.0)), ylim=(0.0, 1.0))
    axes.set(xlabel="horizontal error at contact [m]", ylabel="share of landings flown")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right")
    return figure
