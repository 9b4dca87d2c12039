"""The figures of one run: its path, its motion over time, its approach, the estimate, and the touchdown."""

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import NullLocator

from scenarios.reports.figure_files import DARK, LIGHT, MIDDLE, STYLES
from scenarios.reports.path_figures import path_3d, path_above
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import (
    contact_index,
    distances,
    heights,
    is_during,
    is_shown,
    landing_window,
    shown_spans,
    title,
)

_FUNNEL_MAX_M = 6.0
_LAST_S = 3.0  # of the way to the contact
_EVEN_TO_M = 0.1
_ERROR_TICKS_M = (0.05, 0.1, 1.0, 10.0, 100.0)
_NAME_MIN_SHARE = 0.03  # of the time axis; the name of a shorter phase stands a line lower


def run_figures(run: RunData) -> dict[str, Figure]:
    """Return the figures by the names of their files."""
    with mpl.rc_context(STYLES):
        figures = {
            "path_3d": path_3d(run),
            "path_above": path_above(run),
            "motion": _motion(run),
            "funnel": _funnel(run),
            "touchdown": _touchdown(run),
        }
        if run.estimate is not None:
            figures["estimate"] = _estimate(run)
    return figures


def _motion(run: RunData) -> Figure:
    """Position, speed and distance over time, phases shaded."""
    figure = Figure(figsize=(8.0, 8.5), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(5, 1, sharex=True)
    shown, t_s = is_shown(run), run.t_s[is_shown(run)]
    for index, panel in enumerate(panels[:2]):
        panel.plot(t_s, run.log.position_enu_m[shown, index], color=DARK, label="drone")
        panel.plot(t_s, run.log.vehicle_position_enu_m[shown, index], color=MIDDLE, linestyle="--", label="vehicle")
        panel.set_ylabel(f"{('East', 'North')[index]} [m]")
    panels[2].plot(t_s, np.linalg.norm(run.log.velocity_enu_m_s[shown, :2], axis=1), color=DARK, label="drone")
    panels[2].plot(
        t_s,
        np.linalg.norm(run.vehicle_velocity_enu_m_s[shown, :2], axis=1),
        color=MIDDLE,
        linestyle="--",
        label="vehicle",
    )
    panels[2].set_ylabel("speed [m/s]")
    panels[3].plot(t_s, heights(run)[shown], color=DARK)
    panels[3].set_ylabel("height above\npad [m]")
    panels[4].plot(t_s, np.maximum(distances(run)[shown], 1e-3), color=DARK)
    panels[4].set(ylabel="distance from\npad's centre [m]", yscale="log", xlabel="Time [s]", xlim=landing_window(run))
    for panel in panels:
        _shade(panel, run)
    panels[0].legend(loc="upper left")
    _name_phases(panels[0], run)
    figure.suptitle(title(run))
    return figure


def _shade(axes: Axes, run: RunData) -> None:
    """Shade every second phase, and draw the moment of contact."""
    for index, span in enumerate(shown_spans(run)):
        if index % 2 == 0:
            axes.axvspan(span.from_s, span.to_s, color="0.92", linewidth=0)
    contact_s = run.result.get("contact_s")
    if contact_s is not None:
        axes.axvline(contact_s, color=DARK, linestyle=":", linewidth=1)


def _name_phases(axes: Axes, run: RunData) -> None:
    """Write the phases' names above the panel, those of short ones higher up."""
    from_s, to_s = landing_window(run)
    level, last_s = 0, -math.inf
    for span in shown_spans(run):
        middle_s = 0.5 * (max(span.from_s, from_s) + span.to_s)
        is_near = middle_s - last_s < 3.0 * _NAME_MIN_SHARE * (to_s - from_s)
        level, last_s = (level + 1) % 3 if is_near else 0, middle_s
        axes.annotate(
            span.phase,
            (middle_s, 1.02),
            xycoords=axes.get_xaxis_transform(),
            xytext=(0, 10 * level),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=7.5,
        )


def _funnel(run: RunData) -> Figure:
    """The approach as the deck sees it: height over distance, with the cone it must stay in to sink."""
    figure = Figure(figsize=(6.5, 5.0), layout="constrained")
    axes = figure.subplots()
    distance_m, height_m = distances(run), heights(run)
    approaching = is_shown(run) & (distance_m <= _FUNNEL_MAX_M)
    axes.plot(distance_m[approaching], height_m[approaching], color=LIGHT, linewidth=1.0, label="flown")
    for phase, width in (("align", 1.4), ("descend", 2.4)):
        flown = approaching & is_during(run, phase)
        if flown.any():
            line = "--" if phase == "align" else "-"
            shown = np.where(flown, height_m, np.nan)
            axes.plot(distance_m, shown, color=DARK, linestyle=line, linewidth=width, label=phase)
    descent = run.config.descent
    cone_m = np.array([0.0, 3.0])
    axes.plot(descent.cone.radius_at_pad_m + descent.cone.slope * cone_m, cone_m, color=MIDDLE, label="descent cone")
    axes.axvline(0.5 * min(run.scenario.vehicle.pad_size_m), color=MIDDLE, linestyle=":", label="pad's edge")
    axes.set(xlabel="distance from pad's centre [m]", ylabel="height of the feet above the pad [m]", title=title(run))
    axes.set_xlim(0.0, _FUNNEL_MAX_M)
    axes.legend(loc="lower right")
    return figure


def _estimate(run: RunData) -> Figure:
    """Error of the estimated antenna inside its band of two standard deviations."""
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(3, 1, sharex=True)
    track = run.estimate
    from_s, to_s = landing_window(run)
    if track is not None:
        shown = (track.t_s >= from_s) & (track.t_s <= to_s)
        for index, panel in enumerate(panels):
            error_m, std_m = track.error_m[shown, index], track.std_m[shown, index]
            panel.fill_between(track.t_s[shown], -2 * std_m, 2 * std_m, color="0.85", label="2 sigma")
            panel.plot(track.t_s[shown], error_m, color=DARK, linewidth=1.0, label="error")
            _scale_for_both(panel, float(np.max(np.abs(error_m), initial=2.0 * float(np.max(std_m, initial=0.0)))))
            inside = float(np.mean(np.abs(error_m) <= 2 * std_m)) if len(error_m) else 0.0
            panel.set_ylabel(f"{('East', 'North', 'up')[index]} [m]")
            panel.set_title(f"{inside:.0%} inside", fontsize=8, loc="right")
    panels[0].legend(loc="upper left", ncols=2)
    panels[2].set(xlabel="Time [s]", xlim=(from_s, to_s))
    figure.suptitle(f"{title(run)}: estimated position of the antenna")
    return figure


def _scale_for_both(axes: Axes, largest_m: float) -> None:
    """Scale the error's axis: even within centimetres, by powers beyond, so that error and band are both seen."""
    axes.set_yscale("symlog", linthresh=_EVEN_TO_M, linscale=1.5)
    reach_m = 3.0 * max(largest_m, _EVEN_TO_M)
    sizes_m = [size_m for size_m in _ERROR_TICKS_M if size_m <= reach_m]
    axes.set_yticks([*(-size_m for size_m in reversed(sizes_m)), 0.0, *sizes_m])
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylim(-reach_m, reach_m)
    axes.axhline(0.0, color=MIDDLE, linewidth=0.6)


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
        color=MIDDLE,
        linewidth=1,
        label=f"last {_LAST_S:g} s",
    )
    contact = contact_index(run)
    if contact is not None:
        x_m, y_m, _ = run.log.position_v_m[contact]
        axes.plot(-y_m, x_m, color=DARK, marker="x", markersize=9, linestyle="none", label="contact")
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
    axes.set_aspect("equal")
