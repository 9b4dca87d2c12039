"""The figure of a run's motion over time: where the drone is from the pad, how fast, how high, how far tilted."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scenarios.reports.figure_files import BLUE, DARK, LIGHT, MIDDLE, PHASE_COLORS, VERMILION
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import Array, distances, heights, is_shown, landing_window, shown_spans, title

_NAME_MIN_SHARE = 0.03  # of the time axis; the name of a shorter phase stands a line higher
_DISTANCE_MIN_M = 0.01  # nearer is as good as on the centre
_SHADE = 0.16


def motion(run: RunData) -> Figure:
    """Draw the motion over time, with its phases shaded and named."""
    figure = Figure(figsize=(8.0, 8.5), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(5, 1, sharex=True)
    shown = is_shown(run)
    t_s = run.t_s[shown]
    drone_m_s = np.linalg.norm(run.log.velocity_enu_m_s[shown, :2], axis=1)
    vehicle_m_s = np.linalg.norm(run.vehicle_velocity_enu_m_s[shown, :2], axis=1)
    panels[0].plot(t_s, drone_m_s, color=BLUE, label="drone")
    panels[0].plot(t_s, vehicle_m_s, color=VERMILION, linestyle="--", label="vehicle")
    panels[0].set_ylabel("speed [m/s]")
    panels[1].plot(t_s, heights(run)[shown], color=BLUE)
    panels[1].set_ylabel("height above\npad [m]")
    panels[2].plot(t_s, np.maximum(distances(run)[shown], _DISTANCE_MIN_M), color=BLUE)
    panels[2].set(ylabel="distance from\npad's centre [m]", yscale="log")
    panels[2].axhline(0.5 * min(run.scenario.vehicle.pad_size_m), color=MIDDLE, linestyle=":", label="pad's edge")
    _draw_offsets(panels[3], run, t_s)
    panels[4].plot(t_s, np.degrees(_tilts_rad(run)[shown]), color=BLUE)
    panels[4].set(ylabel="tilt [degrees]", xlabel="Time [s]", xlim=landing_window(run))
    for panel in panels:
        shade(panel, run)
    for panel in (panels[0], panels[2], panels[3]):
        panel.legend(loc="best", fontsize=8)
    _name_phases(panels[0], run)
    figure.suptitle(title(run))
    return figure


def _draw_offsets(axes: Axes, run: RunData, t_s: Array) -> None:
    """Draw where the drone is from the pad's centre, as large as the pad: what is farther is in the panel above."""
    shown = is_shown(run)
    axes.plot(t_s, run.log.position_v_m[shown, 0], color=BLUE, label="ahead of the centre")
    axes.plot(t_s, run.log.position_v_m[shown, 1], color=VERMILION, linestyle="--", label="left of it")
    half_m = 0.5 * max(run.scenario.vehicle.pad_size_m)
    axes.set(ylabel="from pad's\ncentre [m]", ylim=(-half_m, half_m))


def _tilts_rad(run: RunData) -> Array:
    """Return the angle between the drone's up and the vertical, (n,)."""
    return np.asarray(np.arccos(np.clip(run.log.rotation[:, 2, 2], -1.0, 1.0)))


def shade(axes: Axes, run: RunData) -> None:
    """Shade the phases in their colours, and draw the moment of contact."""
    for span in shown_spans(run):
        axes.axvspan(span.from_s, span.to_s, color=PHASE_COLORS.get(span.phase, LIGHT), alpha=_SHADE, linewidth=0)
    contact_s = run.result.get("contact_s")
    if contact_s is not None:
        axes.axvline(contact_s, color=DARK, linestyle=":", linewidth=1.2, label="contact")


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
