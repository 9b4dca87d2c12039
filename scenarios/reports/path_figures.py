"""The figures of a run's way: in space and from above."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from scenarios.reports.figure_files import DARK, LIGHT, MIDDLE
from scenarios.reports.run_data import RunData
from scenarios.reports.run_shown import AXIS_MIN_M, FLOWN, contact_index, is_shown, title

_WIDTH_IN = 8.0
_SLOPE_MIN = 0.4  # height over width of a figure of a straight road
_LABEL_SHARE = 0.12  # of the path's extent, above and below it: room for the phases' names


def path_3d(run: RunData) -> Figure:
    """Draw the drone and the pad in space."""
    figure = Figure(figsize=(7.0, 5.5), layout="constrained")
    axes: Any = figure.add_subplot(projection="3d")  # its methods are not typed
    shown = is_shown(run)
    drone, roof = run.log.position_enu_m[shown], run.log.vehicle_position_enu_m[shown].copy()
    roof[:, 2] += run.scenario.vehicle.roof_height_m
    axes.plot(*drone.T, color=DARK, linewidth=1.8, label="drone")
    axes.plot(*roof.T, color=MIDDLE, linestyle="--", label="pad")
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
    """Draw the drone and the vehicle from above, and where each phase began."""
    shown = is_shown(run)
    drone, vehicle = run.log.position_enu_m[shown], run.log.vehicle_position_enu_m[shown]
    both = np.concatenate([drone, vehicle])
    (left_m, right_m), (low_m, high_m) = bounds_m(both[:, 0]), bounds_m(both[:, 1])
    room_m = _LABEL_SHARE * (high_m - low_m)
    low_m, high_m = low_m - room_m, high_m + room_m
    slope = min(max((high_m - low_m) / (right_m - left_m), _SLOPE_MIN), 1.0)
    x_limits_m = _widen_m(left_m, right_m, (high_m - low_m) / slope)
    y_limits_m = _widen_m(low_m, high_m, (right_m - left_m) * slope)
    figure = Figure(figsize=(_WIDTH_IN, _WIDTH_IN * slope), layout="constrained")
    axes = figure.subplots()
    axes.plot(vehicle[:, 0], vehicle[:, 1], color=LIGHT, linewidth=5, solid_capstyle="butt", label="vehicle")
    axes.plot(drone[:, 0], drone[:, 1], color=DARK, linewidth=1.4, label="drone")
    contact = contact_index(run)
    if contact is not None:
        x_m, y_m, _ = run.log.position_enu_m[contact]
        axes.plot(x_m, y_m, color=DARK, marker="v", linestyle="none", label="contact")
    _mark_phases(run, axes)
    axes.set(xlabel="East [m]", ylabel="North [m]", title=title(run), xlim=x_limits_m, ylim=y_limits_m)
    axes.set_aspect("equal")
    axes.legend(loc="best")
    return figure


def _widen_m(low_m: float, high_m: float, extent_m: float) -> tuple[float, float]:
    """Return the limits, widened on both sides where they span less than `extent_m`."""
    margin_m = max(0.5 * (extent_m - (high_m - low_m)), 0.0)
    return low_m - margin_m, high_m + margin_m


def _mark_phases(run: RunData, axes: Axes) -> None:
    """Write where each phase of the landing began, in turns above and below the path."""
    begun = [span for span in run.phases if span.phase in FLOWN]
    for index, span in enumerate(begun[:8]):
        x_m, y_m, _ = run.log.position_enu_m[int(np.searchsorted(run.t_s, span.from_s))]
        axes.plot(x_m, y_m, color=DARK, marker="o", markersize=3)
        rise = (16 + 13 * (index // 2)) * (1 if index % 2 == 0 else -1)
        axes.annotate(
            span.phase,
            (x_m, y_m),
            xytext=(0, rise),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=8,
            arrowprops={"arrowstyle": "-", "color": MIDDLE, "linewidth": 0.6},
        )
