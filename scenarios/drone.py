"""The simulated drone of a scenario: the configuration that `sim-autopilot` takes, and the wind that it draws."""

import math

from link.messages import Vector3
from scenarios.config import Scenario
from scenarios.noise import named_rng
from sim_autopilot.config import SimAutopilotConfig, StartConfig, VehicleConfig, WindConfig


def sim_autopilot_config(scenario: Scenario, seed: int, *, instant: bool) -> SimAutopilotConfig:
    """Return what the scenario's simulated autopilot is started with.

    Args:
        scenario: what is flown.
        seed: of the wind.
        instant: ready at once, without the seconds that a boot takes.
    """
    body = scenario.vehicle
    return SimAutopilotConfig(
        firmware=scenario.firmware,
        instant=instant,
        seed=seed,
        datum=scenario.datum,
        start=StartConfig(position_enu_m=scenario.drone_start_enu_m),
        drone=scenario.system.drone,
        wind=WindConfig(
            mean_m_s=scenario.wind.mean_m_s,
            from_rad=_wind_from_rad(scenario, seed),
            turbulence=scenario.wind.turbulence,
        ),
        vehicle=VehicleConfig(length_m=body.length_m, width_m=body.width_m, roof_height_m=body.roof_height_m),
        parameters=scenario.system.parameters,
    )


def mean_wind_enu_m_s(scenario: Scenario, seed: int) -> Vector3:
    """Return the mean wind of `scenario` with `seed`."""
    from_rad, mean_m_s = _wind_from_rad(scenario, seed), scenario.wind.mean_m_s
    return (-mean_m_s * math.cos(from_rad), -mean_m_s * math.sin(from_rad), 0.0)


def _wind_from_rad(scenario: Scenario, seed: int) -> float:
    if scenario.wind.from_rad is not None:
        return scenario.wind.from_rad
    return float(named_rng(seed, "wind").uniform(-math.pi, math.pi))
