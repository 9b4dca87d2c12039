"""The source report's figures 3 and 6 to 10, measured, with the report's axes, as PNG and SVG.

Figure 3 is the step responses, figure 6 the two roads, figures 7 to 10 the flights of scenarios 1 to 4; beside each
flight's trajectory are the same positions over time, and the distance that decides about success.
"""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from link.errors import UserError
from scenarios.catalogue.catalogue import load_scenario
from scenarios.scoring.touch import Flags
from scenarios.source_report.cases import LANDED_M, STANDS_S, Place
from scenarios.source_report.flight import ReportFlight, ReportTask, fly
from scenarios.source_report.step_responses import AIRFRAMES, AXES, Curve, flown_curve, linear_curve
from scenarios.tracks.tracks import course_of
from sim_autopilot.control.parameters import ControllerKind

SEED = 1
_DPI = 150
_DARK, _LIGHT = "0.0", "0.55"  # grey levels: nothing is told by colour alone
_ROADS = (("report_1", "Road 1: straight"), ("report_3", "Road 2: curved"))
_BOXES = {
    "report_1": ((-0.5, 6.0), (-1.0, 1.0)),
    "report_2": ((0.0, 50.0), (-1.0, 1.0)),
    "report_3": ((0.0, 32.0), (-11.0, 1.0)),
    "report_4": ((0.0, 42.0), (-20.0, 1.0)),
}
"""Of each trajectory: x and y that are shown. The report's figure 9 ends at x = 20 m, before its landing."""
_STYLES: dict[Any, Any] = {
    "svg.hashsalt": "decklander",
    "font.size": 9,
    "axes.grid": True,
    "grid.color": "0.85",
    "grid.linewidth": 0.5,
}


def draw_report(folder: Path) -> list[Path]:
    """Draw all figures into `folder` and return the files.

    Raises:
        UserError: the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with mpl.rc_context(_STYLES):
            files = _save(_steps_figure(), folder / "figure_03")
            files += _save(_roads_figure(), folder / "figure_06")
            for number, scenario in enumerate(_BOXES, 7):
                flight = fly(ReportTask(scenario=scenario, system="report", seed=SEED))
                files += _save(_flight_figure(scenario, flight), folder / f"figure_{number:02d}")
    except OSError as error:
        raise UserError(f"{folder}: cannot be written ({error.strerror}); choose another --out") from None
    return files


def _save(figure: Figure, stem: Path) -> list[Path]:
    """Write a figure in both forms, without the time of day, so that the same figure is the same file."""
    files = [stem.with_suffix(".png"), stem.with_suffix(".svg")]
    figure.savefig(files[0], dpi=_DPI)
    figure.savefig(files[1], metadata={"Date": None})
    return files


def _steps_figure() -> Figure:
    """Figure 3: unit steps in x, y, z and heading over 5 s, the report's loop and its successor."""
    figure = Figure(figsize=(7.0, 8.0), layout="constrained")
    all_axes: Sequence[Axes] = figure.subplots(4, 1, sharex=True)
    report = AIRFRAMES["report"]
    for axes, axis in zip(all_axes, AXES, strict=True):
        _curve(axes, linear_curve(axis), "lqr, linear model (the report's figure)", _DARK, "-")
        _curve(axes, flown_curve(ControllerKind.LQR, report, axis), "lqr, nonlinear model", _DARK, ":")
        _curve(axes, flown_curve(ControllerKind.GEOMETRIC, report, axis), "geometric, nonlinear model", _LIGHT, "--")
        axes.set_title(f"Step response in {axis}", fontsize="medium")
        axes.set_ylabel("heading [step]" if axis == "yaw" else f"{axis} [m]")
        axes.set_ylim(0.0, 1.2)
    all_axes[-1].set_xlabel("Time [s]")
    all_axes[-1].set_xlim(0.0, 5.0)
    all_axes[0].legend(loc="lower right")
    return figure


def _curve(axes: Axes, curve: Curve, label: str, grey: str, dashes: str) -> None:
    axes.plot(curve.t_s, curve.output, color=grey, linestyle=dashes, label=label)


def _roads_figure() -> Figure:
    """Figure 6: the roads, x upwards."""
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    for axes, (scenario, title) in zip(figure.subplots(1, 2), _ROADS, strict=True):
        road = course_of(load_scenario(scenario).track, np.random.default_rng(SEED)).road
        points = [road.at(s_m) for s_m in np.linspace(0.0, road.length_m, 200).tolist()]
        x_m, y_m = [point.x_m for point in points], [point.y_m for point in points]
        axes.plot(y_m, x_m, color="0.8", linewidth=8, solid_capstyle="butt")
        axes.plot(y_m, x_m, color=_DARK, linestyle="--", linewidth=1)
        axes.set_title(title, fontsize="medium")
        axes.set_xlabel("y [m]")
        axes.set_ylabel("x [m]")
    figure.axes[0].set(xlim=(-1.0, 1.0), ylim=(0.0, 50.0))
    figure.axes[1].set(xlim=(-20.0, 5.0), ylim=(0.0, 45.0))
    return figure


def _flight_figure(scenario: str, flight: ReportFlight) -> Figure:
    """Figures 7 to 10: the trajectory, and to its right x, y, z and the distance over time."""
    figure = Figure(figsize=(10.0, 5.2), layout="constrained")
    grid = figure.add_gridspec(4, 2, width_ratios=(3, 2))
    landing = flight.landing(noisy=True)
    flown: Flags = flight.t_s <= (flight.road_end_s if landing is None else landing.t_s)
    shown: Flags = flown & (flight.t_s >= 0.0)
    _trajectory(figure.add_subplot(grid[:, 0], projection="3d"), scenario, flight, flown)
    panels = [figure.add_subplot(grid[row, 1]) for row in range(4)]
    for index, panel in enumerate(panels[:3]):
        panel.plot(flight.t_s[shown], flight.drone_m[shown, index], color=_DARK, label="drone")
        panel.plot(flight.t_s[shown], flight.vehicle_m[shown, index], color=_LIGHT, linestyle="--", label="vehicle")
        panel.set_ylabel(f"{'xyz'[index]} [m]")
    _distance(panels[3], flight, shown, landing)
    for above, panel in pairwise(panels):
        above.sharex(panel)
        above.tick_params(labelbottom=False)
    low, high = panels[1].get_ylim()
    panels[1].set_ylim(min(low, -1.0), max(high, 1.0))
    panels[0].legend(loc="upper left")
    outcome = (
        "no landing" if landing is None else f"lands at {landing.t_s:.1f} s, ({landing.x_m:.1f}, {landing.y_m:.1f}) m"
    )
    figure.suptitle(f"Scenario {scenario.removeprefix('report_')}: {outcome}")
    return figure


def _trajectory(axes: Any, scenario: str, flight: ReportFlight, shown: Flags) -> None:  # (the 3-D axes are not typed)
    """Draw both ways in space, seen as in the report."""
    for way_m, grey, dashes, label in (
        (flight.drone_m[shown], _DARK, "-", "drone"),
        (flight.vehicle_m[shown], _LIGHT, "--", "vehicle"),
    ):
        axes.plot(way_m[:, 0], way_m[:, 1], way_m[:, 2], color=grey, linestyle=dashes, linewidth=2, label=label)
    x_m, y_m = _BOXES[scenario]
    axes.set(xlim=x_m, ylim=y_m, zlim=(-1.0, 5.0), xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.view_init(elev=30.0, azim=-135.0)
    axes.set_title("Landing trajectory", fontsize="medium")
    axes.legend(loc="upper right")


def _distance(axes: Axes, flight: ReportFlight, shown: Flags, landing: Place | None) -> None:
    axes.plot(flight.t_s[shown], flight.distance_m(noisy=False)[shown], color=_DARK)
    axes.axhline(LANDED_M, color=_DARK, linestyle=":", label=f"{LANDED_M} m")
    axes.axvline(STANDS_S, color=_LIGHT, linewidth=1, label="vehicle departs")
    if landing is not None:
        axes.axvline(landing.t_s, color=_DARK, linewidth=1, linestyle="-.", label="lands")
    axes.set(xlabel="Time [s]", ylabel="distance [m]", ylim=(0.0, 9.0))
    axes.legend(loc="upper right", ncols=3)
