"""The figures of a run's way: in space and from above."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from scenarios.reports.figure_files import BLUE, DARK, LIGHT, PHASE_COLORS, VERMILION
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import AXIS_MIN_M, contact_index, is_shown, shown_spans, title

_SIZE_IN, _SIZE_MIN_IN = 6.5, 1.0  # of the longer and of the shorter side of what is seen from above
_LEGEND_IN, _LABELS_IN = 1.6, 0.9  # room beside it and below


def path_3d(run: RunData) -> Figure:
    """Draw the drone and the pad in space."""
    figure = Figure(figsize=(7.0, 5.5), layout="constrained")
    axes: Any = figure.add_subplot(projection="3d")  # its methods are not typed
    shown = is_shown(run)
    drone, roof = run.log.position_enu_m[shown], run.log.vehicle_position_enu_m[shown].copy()
    roof[:, 2] += run.scenario.vehicle.roof_height_m
    axes.plot(*drone.T, color=BLUE, linewidth=1.8, label="drone")
    axes.plot(*roof.T, color=VERMILION, linestyle="--", label="pad")
    axes.plot(*drone.T[:2], 0.0, color=LIGHT, linewidth=0.8, label="drone's shadow")
    contact = contact_index(run)
    if contact is not None:
        axes.scatter(*run.log.position_enu_m[contact], color=DARK, marker="v", s=40, label="contact")
    limits_m = [bounds_m(np.concatenate([drone[:, axis], roof[:, axis]])) for axis in range(3)]
    axes.set(xlim=limits_m[0], ylim=limits_m[1], zlim=(0.0, limits_m[2][1]))
    axes.locator_params(axis="x", nbins=5)
    axes.locator_params(axis="y", nbins=4)
    wide_m, deep_m = (high - low for low, high in limits_m[:2])
    longest_m = max(wide_m, deep_m)
    axes.set_box_aspect((max(wide_m, 0.3 * longest_m), max(deep_m, 0.3 * longest_m), 0.4 * longest_m))
    axes.set(xlabel="East [m]", ylabel="North [m]", zlabel="height [m]")
    axes.legend(loc="upper left")
    axes.set_title(title(run))
    return figure


def bounds_m(values_m: NDArray[np.float64]) -> tuple[float, float]:
    """Return the limits of an axis, never narrower than a vehicle's length."""
    low_m, high_m = float(values_m.min()), float(values_m.max())
    margin_m = max(0.05 * (high_m - low_m), 0.5 * (AXIS_MIN_M - (high_m - low_m)))
    return low_m - margin_m, high_m + margin_m


def path_above(run: RunData) -> Figure:
    """Draw the vehicle and the drone from above, the drone's way in the colours of its phases."""
    shown = is_shown(run)
    drone, vehicle = run.log.position_enu_m[shown], run.log.vehicle_position_enu_m[shown]
    both = np.concatenate([drone, vehicle])
    (left_m, right_m), (low_m, high_m) = bounds_m(both[:, 0]), bounds_m(both[:, 1])
    across, along = right_m - left_m, high_m - low_m
    scale = _SIZE_IN / max(across, along)
    size_in = (max(scale * across, _SIZE_MIN_IN) + _LEGEND_IN, max(scale * along, _SIZE_MIN_IN) + _LABELS_IN)
    figure = Figure(figsize=size_in, layout="constrained")
    axes = figure.subplots()
    axes.plot(vehicle[:, 0], vehicle[:, 1], color=LIGHT, linewidth=6, solid_capstyle="butt", label="vehicle")
    _draw_phases(run, axes)
    contact = contact_index(run)
    if contact is not None:
        x_m, y_m, _ = run.log.position_enu_m[contact]
        axes.plot(x_m, y_m, color=DARK, marker="v", linestyle="none", label="contact")
    axes.set(xlabel="East [m]", ylabel="North [m]", xlim=(left_m, right_m), ylim=(low_m, high_m))
    axes.locator_params(axis="y" if across > along else "x", nbins=5)
    axes.set_aspect("equal")
    figure.suptitle(title(run))
    figure.legend(loc="outside right upper", fontsize=8)
    return figure


def _draw_phases(run: RunData, axes: Axes) -> None:
    """Draw the drone's way, each phase in its colour and once in the legend."""
    named: set[str] = set()
    for span in shown_spans(run):
        during = (run.t_s >= span.from_s) & (run.t_s <= span.to_s) & is_shown(run)
        way = run.log.position_enu_m[during]
        label = None if span.phase in named else f"drone: {span.phase}"
        named.add(span.phase)
        axes.plot(way[:, 0], way[:, 1], color=PHASE_COLORS.get(span.phase, LIGHT), linewidth=1.8, label=label)
