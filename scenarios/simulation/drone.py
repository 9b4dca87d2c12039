"""The simulated drone of a scenario: the configuration that `sim-autopilot` takes, and the wind that it draws."""

import math

from link.messages import Vector3
from scenarios.config import RangeConfig, Scenario, SensorsConfig
from scenarios.simulation.noise import Seed, instant_s, named_rng
from scenarios.simulation.vehicle import VehicleMemory, vehicle_at
from scenarios.simulation.vehicle_node import plan_of
from sim_autopilot.runtime.config import (
    RECEIVER_ACCURACY_MIN_M,
    OwnStateConfig,
    RangeFinderConfig,
    SimAutopilotConfig,
    StartConfig,
    VehicleConfig,
    WindConfig,
)

# Frames that are 0.5 m apart are those of two base stations, 1.2 m of receivers without corrections (the presets): in
# between, at the geometric mean, the drone's begins to have none.
_CORRECTED_OFFSET_MAX_M = 0.77


def sim_autopilot_config(scenario: Scenario, seed: Seed, *, instant: bool) -> SimAutopilotConfig:
    """Return what the scenario's simulated autopilot is started with.

    Args:
        scenario: what is flown.
        seed: of the wind; one that is no number stays with the caller, who gives its noise to the parts themselves.
        instant: ready at once, without the seconds that a boot takes.
    """
    body = scenario.vehicle
    return SimAutopilotConfig(
        firmware=scenario.firmware,
        instant=instant,
        seed=seed if isinstance(seed, int) else 0,
        datum=scenario.run.datum,
        start=_start(scenario, seed),
        drone=scenario.system.drone,
        wind=_wind(scenario, seed),
        own_state=_own_state(scenario, seed),
        range_finder=_range_finder(scenario.sensors.range_finder),
        vehicle=VehicleConfig(
            length_m=body.length_m,
            width_m=body.width_m,
            roof_height_m=body.roof_height_m,
            is_afloat=body.is_afloat,
            superstructure=body.superstructure,
        ),
        parameters=scenario.system.parameters.get(scenario.firmware, {}),
    )


def _start(scenario: Scenario, seed: Seed) -> StartConfig:
    """Return where the drone stands at first: on the road, or on the deck and carried by it."""
    if scenario.run.place == "road":
        return StartConfig(position_enu_m=scenario.run.drone_start_enu_m)
    vehicle = vehicle_at(VehicleMemory(departs_ns=0), 0, plan_of(scenario, seed))
    east_m, north_m, up_m = vehicle.position_enu_m
    return StartConfig(
        position_enu_m=(east_m, north_m, up_m + scenario.vehicle.roof_height_m),
        velocity_enu_m_s=vehicle.velocity_enu_m_s,
        yaw_rad=vehicle.yaw_rad,
    )


def _wind(scenario: Scenario, seed: Seed) -> WindConfig:
    wind = scenario.wind
    return WindConfig(
        mean_m_s=wind.mean_m_s,
        from_rad=_wind_from_rad(scenario, seed),
        turbulence=wind.turbulence,
        turbulence_std_m_s=wind.turbulence_std_m_s,
        gust_m_s=wind.gust_m_s,
        gust_from_rad=_gust_from_rad(scenario, seed),
        gust_start_s=instant_s(scenario, seed, "gust", wind.gust_at_s),
        gust_duration_s=wind.gust_duration_s,
    )


def _own_state(scenario: Scenario, seed: Seed) -> OwnStateConfig:
    own = scenario.sensors.own_state
    rng = named_rng(seed, "origin step")
    step_m, angle_rad = float(rng.uniform(*own.origin_step_range_m)), float(rng.uniform(-math.pi, math.pi))
    return OwnStateConfig(
        position_std_m=own.position_std_m,
        height_std_m=own.height_std_m,
        velocity_std_m_s=own.velocity_std_m_s,
        receiver_accuracy_m=_receiver_accuracy_m(scenario.sensors),
        origin_step_enu_m=(step_m * math.cos(angle_rad), step_m * math.sin(angle_rad), 0.0) if step_m > 0.0 else None,
        origin_step_s=instant_s(scenario, seed, "origin step", own.origin_step_at_s),
    )


def _range_finder(config: RangeConfig) -> RangeFinderConfig:
    return RangeFinderConfig(white_std_m=config.white_m, min_m=config.min_m, max_m=config.max_m)


def _receiver_accuracy_m(sensors: SensorsConfig) -> float:
    """Return what the drone's receiver states: as well as the drone knows its place, if it has corrections."""
    absolute_m = sensors.frame_offset_m if sensors.frame_offset_m > _CORRECTED_OFFSET_MAX_M else 0.0
    return max(RECEIVER_ACCURACY_MIN_M, sensors.own_state.position_std_m, absolute_m)


def mean_wind_enu_m_s(scenario: Scenario, seed: Seed) -> Vector3:
    """Return the mean wind of `scenario` with `seed`."""
    from_rad, mean_m_s = _wind_from_rad(scenario, seed), scenario.wind.mean_m_s
    return (-mean_m_s * math.cos(from_rad), -mean_m_s * math.sin(from_rad), 0.0)


def _wind_from_rad(scenario: Scenario, seed: Seed) -> float:
    if scenario.wind.from_rad is not None:
        return scenario.wind.from_rad
    return float(named_rng(seed, "wind").uniform(-math.pi, math.pi))


def _gust_from_rad(scenario: Scenario, seed: Seed) -> float:
    if scenario.wind.gust_from_rad is not None:
        return scenario.wind.gust_from_rad
    return float(named_rng(seed, "gust").uniform(-math.pi, math.pi))
