"""The simulated drone of a scenario: its autopilot's configuration and the air that it flies in."""

import math

import numpy as np

from link.messages import Vector3
from scenarios.config import Scenario
from scenarios.noise import named_rng
from scenarios.vehicle_node import datum_of
from sim_autopilot.data import Array, PlantState
from sim_autopilot.firmware.px4 import PX4
from sim_autopilot.memory import AutopilotConfig
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, REPORT_AIRFRAME
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.plant import PlantConfig

_AIRFRAMES = {"report": REPORT_AIRFRAME, "benchmark": BENCHMARK_AIRFRAME}
_FIRMWARES = {"px4": PX4}


def plant_config(scenario: Scenario) -> PlantConfig:
    """Return the drone of `scenario` and its flight controller."""
    return PlantConfig(airframe=_AIRFRAMES[scenario.airframe])


def autopilot_config(scenario: Scenario, *, instant: bool) -> AutopilotConfig:
    """Return the autopilot of `scenario`, its drone standing at the scenario's start."""
    x_m, y_m, z_m = scenario.drone_start_enu_m
    return AutopilotConfig(
        firmware=_FIRMWARES[scenario.firmware],
        datum=datum_of(scenario.datum),
        plant=plant_config(scenario),
        instant=instant,
        position_enu_m=(x_m, y_m, z_m + GEAR_HEIGHT_M),
        yaw_rad=0.0,
    )


class Air:
    """Mean wind from a direction drawn for each seed."""

    def __init__(self, mean_enu_m_s: Array) -> None:
        self._mean_enu_m_s = mean_enu_m_s

    def advance(self, dt_s: float, state: PlantState) -> Array:
        """Return the wind (3,) in W."""
        return self._mean_enu_m_s


def mean_wind_enu_m_s(scenario: Scenario, seed: int) -> Vector3:
    """Return the mean wind of `scenario` with `seed`."""
    from_rad = scenario.wind.from_rad
    if from_rad is None:
        from_rad = float(named_rng(seed, "wind").uniform(-math.pi, math.pi))
    mean_m_s = scenario.wind.mean_m_s
    return (-mean_m_s * math.cos(from_rad), -mean_m_s * math.sin(from_rad), 0.0)


def wind_model(scenario: Scenario, seed: int) -> Air:
    """Return the air of `scenario` with `seed`."""
    return Air(np.array(mean_wind_enu_m_s(scenario, seed)))
