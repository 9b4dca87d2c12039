"""Step responses of the flight controllers: the report's linear loop, and all of them on the nonlinear model.

Steps of 1 m along x, y, z and of 0.1 rad of heading, from hover at heading zero. The settling time is to 2 %.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from link.records import replace
from sim_autopilot.control.lqr import StepResponse, linear_step, measured_step
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, REPORT_AIRFRAME, Airframe
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.plant import PlantMemory, fly, initial_plant

AXES = ("x", "y", "z", "yaw")
_STEP_M = 1.0
_STEP_RAD = 0.1  # small enough for the limits on the heading's rate to play no part
_HEIGHT_M = 20.0
_PERIOD_S = 0.005
_END_S = 6.0
_CALM = np.zeros(3)

AIRFRAMES = {"report": REPORT_AIRFRAME, "benchmark": BENCHMARK_AIRFRAME}
LOOPS = (
    ("lqr, linear", ControllerKind.LQR, None),
    ("lqr", ControllerKind.LQR, "report"),
    ("lqr_feedforward", ControllerKind.LQR_FEEDFORWARD, "report"),
    ("geometric", ControllerKind.GEOMETRIC, "report"),
    ("lqr_feedforward", ControllerKind.LQR_FEEDFORWARD, "benchmark"),
    ("geometric", ControllerKind.GEOMETRIC, "benchmark"),
)
"""Name, controller, and the airframe that it flies; None is the linear model."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """An output (n,) over time (n,), as parts of its step."""

    t_s: Array
    output: Array

    @property
    def response(self) -> StepResponse:
        """What is read off it."""
        return measured_step(self.t_s, self.output)


def linear_curve(axis: str) -> Curve:
    """Return the answer of the report's closed linear loop along `axis`."""
    t_s, output = linear_step(REPORT_AIRFRAME, AXES.index(axis))
    return Curve(t_s=t_s, output=output)


def flown_curve(controller: ControllerKind, airframe: Airframe, axis: str) -> Curve:
    """Return the answer of the nonlinear model under `controller` along `axis`."""
    config = PlantConfig(airframe=airframe, controller=controller)
    index = AXES.index(axis)
    goal = np.array([0.0, 0.0, _HEIGHT_M, 0.0])
    goal[index] += _STEP_RAD if axis == "yaw" else _STEP_M
    count = round(_END_S / _PERIOD_S)
    memory = _settle(config)
    start = _outputs(memory)[index]
    output = np.empty(count)
    for k in range(count):
        output[k] = (_outputs(memory)[index] - start) / (goal[index] - start)
        memory = fly(memory, _hold(goal), None, _CALM, config, _PERIOD_S)
    return Curve(t_s=np.linspace(0.0, _END_S, count, endpoint=False), output=output)


def _settle(config: PlantConfig) -> PlantMemory:
    """Return a drone that hovers, its controller at rest."""
    memory = initial_plant(config, 0, np.array([0.0, 0.0, _HEIGHT_M]), 0.0)
    hover = np.array([0.0, 0.0, _HEIGHT_M, 0.0])
    spinning = replace(memory.state, rotor_speed_rad_s=np.full(4, config.airframe.hover_speed_rad_s))
    return fly(PlantMemory(state=spinning, internals=memory.internals), _hold(hover), None, _CALM, config, 1.0)


def _hold(goal: Array) -> Reference:
    """Return the reference that rests at x, y, z, heading (4,)."""
    return Reference(
        position_enu_m=goal[:3],
        velocity_enu_m_s=np.zeros(3),
        acceleration_enu_m_s2=np.zeros(3),
        yaw_rad=float(goal[3]),
        yaw_rate_rad_s=0.0,
    )


def _outputs(memory: PlantMemory) -> Array:
    """Return x, y, z, heading (4,)."""
    w, x, y, z = memory.state.orientation_wxyz
    yaw_rad = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.append(memory.state.position_enu_m, yaw_rad)


@cache
def step_rows() -> tuple[dict[str, float | str | None], ...]:
    """Return settling time and overshoot of each loop along each axis."""
    rows: list[dict[str, float | str | None]] = []
    for name, controller, airframe in LOOPS:
        for axis in AXES:
            curve = linear_curve(axis) if airframe is None else flown_curve(controller, AIRFRAMES[airframe], axis)
            response = curve.response
            rows.append(
                {
                    "loop": name,
                    "airframe": airframe,
                    "axis": axis,
                    "settling_s": response.settling_s,
                    "overshoot": response.overshoot,
                }
            )
    return tuple(rows)
