"""The figure of the estimate's error inside its band, and of whether the two agree."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from scenarios.campaigns.intervals import mean_band
from scenarios.reports.estimate_track import EstimateTrack
from scenarios.reports.figure_files import BLUE, LIGHT, MIDDLE, VERMILION
from scenarios.reports.motion_figure import shade
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import FLOWN, Array, Flags, landing_window, title

_SIGMAS = 2.0
_ROOM = 1.25  # of the axis beyond the largest value that has to be seen
_REACH_MIN_M = 0.05
_SHOWN_SHARE = 0.9  # of the errors of a landing; the first of a chase may be far larger
_AXES = 3
_NEES_TICKS = (0.01, 0.1, 1.0, 10.0, 100.0)


def estimate(run: RunData, track: EstimateTrack) -> Figure:
    """Draw the error of the estimated antenna inside its band of two standard deviations, and its NEES below."""
    figure = Figure(figsize=(8.0, 7.5), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(_AXES + 1, 1, sharex=True)
    from_s, to_s = landing_window(run)
    shown = (track.t_s >= from_s) & (track.t_s <= to_s)
    flown = shown & _during_landing(run, track.t_s)
    for index, panel in enumerate(panels[:_AXES]):
        _draw_error(panel, track, index, shown, flown if flown.any() else shown)
        panel.set_ylabel(f"{('East', 'North', 'up')[index]} [m]")
    _draw_nees(panels[_AXES], track, shown)
    for panel in panels:
        shade(panel, run)
    panels[0].legend(loc="upper right", ncols=4, fontsize=8)
    panels[_AXES].legend(loc="upper right", ncols=3, fontsize=8)
    panels[_AXES].set(xlabel="Time [s]", xlim=(from_s, to_s))
    figure.suptitle(f"{title(run)}\nerror of the estimated position of the antenna")
    return figure


def _during_landing(run: RunData, t_s: Array) -> Flags:
    inside = np.zeros(len(t_s), dtype=bool)
    for span in run.phases:
        if span.phase in FLOWN:
            inside |= (t_s >= span.from_s) & (t_s < span.to_s)
    return inside


def _draw_error(axes: Axes, track: EstimateTrack, index: int, shown: Flags, scaled_by: Flags) -> None:
    """Draw one axis. Its scale is that of the landing: before it the band may be a hundred times as wide."""
    t_s, error_m, band_m = track.t_s[shown], track.error_m[shown, index], _SIGMAS * track.std_m[shown, index]
    outside = np.abs(error_m) > band_m
    axes.fill_between(t_s, -band_m, band_m, color=LIGHT, alpha=0.5, linewidth=0, label="2 sigma")
    axes.plot(t_s, error_m, color=BLUE, linewidth=1.0, label="error")
    axes.plot(t_s[outside], error_m[outside], ".", color=VERMILION, markersize=3, label="out of band")
    axes.axhline(0.0, color=MIDDLE, linewidth=0.6)
    if scaled_by.any():
        widest_m = _SIGMAS * float(np.median(track.std_m[scaled_by, index]))
        most_m = float(np.quantile(np.abs(track.error_m[scaled_by, index]), _SHOWN_SHARE))
        largest_m = max(most_m, widest_m, _REACH_MIN_M)
        axes.set_ylim(-_ROOM * largest_m, _ROOM * largest_m)
    axes.set_title(f"{1.0 - float(np.mean(outside)) if len(outside) else 0.0:.0%} inside", fontsize=8, loc="right")


def _draw_nees(axes: Axes, track: EstimateTrack, shown: Flags) -> None:
    """Draw the squared error over its covariance, and between what it lies 95 % of the time if that is right."""
    t_s, nees = track.t_s[shown], track.nees[shown]
    low, high = mean_band(_AXES)
    if low is None or high is None or not len(nees):
        return
    low, high = _AXES * low, _AXES * high
    outside = (nees < low) | (nees > high)
    axes.axhspan(low, high, color=LIGHT, alpha=0.5, linewidth=0, label="95 % band")
    axes.plot(t_s, nees, color=BLUE, linewidth=1.0, label="NEES")
    axes.plot(t_s[outside], nees[outside], ".", color=VERMILION, markersize=3, label="out of band")
    axes.set(ylabel="NEES of position\n(mean 3 expected)", yscale="log", ylim=(min(_NEES_TICKS), max(_NEES_TICKS)))
    axes.yaxis.set_major_locator(FixedLocator(list(_NEES_TICKS)))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter("{x:g}")
