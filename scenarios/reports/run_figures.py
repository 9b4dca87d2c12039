"""The figures of one run: its path, its motion over time, its approach, the estimate, and the touchdown."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from scenarios.reports.estimate_figure import estimate
from scenarios.reports.figure_files import DARK, LIGHT, MIDDLE, PHASE_COLORS, STYLES
from scenarios.reports.motion_figure import motion
from scenarios.reports.path_figures import path_3d, path_above
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import contact_index, distances, heights, is_during, is_shown, title

_FUNNEL_MAX_M, _CONE_M = 4.0, 3.0  # how much of the approach is shown, and of the cone
_LAST_S = 3.0  # of the way to the contact


def run_figures(run: RunData) -> dict[str, Figure]:
    """Return the figures by the names of their files."""
    with mpl.rc_context(STYLES):
        figures = {
            "path_3d": path_3d(run),
            "path_above": path_above(run),
            "motion": motion(run),
            "funnel": _funnel(run),
            "touchdown": _touchdown(run),
        }
        if run.estimate is not None:
            figures["estimate"] = estimate(run, run.estimate)
    return figures


def _funnel(run: RunData) -> Figure:
    """The approach as the deck sees it: height over distance, with the cone it must stay in to sink."""
    figure = Figure(figsize=(6.5, 5.0), layout="constrained")
    axes = figure.subplots()
    distance_m, height_m = distances(run), heights(run)
    approaching = is_shown(run) & (distance_m <= _FUNNEL_MAX_M)
    axes.plot(distance_m[approaching], height_m[approaching], color=LIGHT, linewidth=1.0, label="flown")
    for phase, dashes in (("align", "--"), ("descend", "-"), ("abort", "-.")):
        flown = approaching & is_during(run, phase)
        if flown.any():
            shown = np.where(flown, height_m, np.nan)
            axes.plot(distance_m, shown, color=PHASE_COLORS[phase], linestyle=dashes, linewidth=2.0, label=phase)
    contact = contact_index(run)
    if contact is not None:
        axes.plot(distance_m[contact], height_m[contact], color=DARK, marker="v", linestyle="none", label="contact")
    descent = run.config.descent
    cone_m = np.array([0.0, _CONE_M])
    axes.plot(descent.cone.radius_at_pad_m + descent.cone.slope * cone_m, cone_m, color=MIDDLE, label="descent cone")
    axes.axvline(0.5 * min(run.scenario.vehicle.pad_size_m), color=MIDDLE, linestyle=":", label="pad's edge")
    axes.set(xlabel="distance from pad's centre [m]", ylabel="height of the feet above the pad [m]", title=title(run))
    reach_m = float(
        np.max(distance_m[approaching], initial=descent.cone.radius_at_pad_m + descent.cone.slope * _CONE_M)
    )
    axes.set_xlim(0.0, 1.05 * reach_m)
    axes.legend(loc="lower right")
    return figure


def _touchdown(run: RunData) -> Figure:
    """The last of the way over the pad, and the contact."""
    figure = Figure(figsize=(5.0, 5.0), layout="constrained")
    axes = figure.subplots()
    draw_pad(axes, run.scenario.vehicle.pad_size_m)
    until_s = float(run.result.get("contact_s") or run.t_s[-1])
    low = (run.t_s >= until_s - _LAST_S) & (run.t_s <= until_s)
    # Forward is up, so left is left.
    axes.plot(
        -run.log.position_v_m[low, 1],
        run.log.position_v_m[low, 0],
        color=PHASE_COLORS["descend"],
        linewidth=1.2,
        label=f"last {_LAST_S:g} s",
    )
    contact = contact_index(run)
    if contact is not None:
        x_m, y_m, _ = run.log.position_v_m[contact]
        axes.plot(
            -y_m,
            x_m,
            color=PHASE_COLORS["touchdown"],
            marker="x",
            markersize=10,
            markeredgewidth=2.5,
            linestyle="none",
            label="contact",
        )
    if contact is not None or low.any():
        axes.legend(loc="upper right")
    axes.set_title(title(run))
    return figure


def draw_pad(axes: Axes, pad_size_m: tuple[float, float]) -> None:
    """Draw the pad's outline from above."""
    length_m, width_m = pad_size_m
    axes.add_patch(Rectangle((-0.5 * width_m, -0.5 * length_m), width_m, length_m, fill=False, linewidth=1.5))
    show_around_pad(axes, 0.65 * max(pad_size_m))


def show_around_pad(axes: Axes, reach_m: float) -> None:
    """Show what is around the pad's centre from above, forward up, with its centre lines."""
    axes.axhline(0.0, color="0.75", linewidth=0.7)
    axes.axvline(0.0, color="0.75", linewidth=0.7)
    axes.set(xlim=(-reach_m, reach_m), ylim=(-reach_m, reach_m))
    axes.set(xlabel="to the vehicle's right [m]", ylabel="forward [m]")
    axes.locator_params(nbins=5)
    axes.set_aspect("equal")
