"""From the configuration to the physics: the airframe and the air."""

from math import pi

import numpy as np

from link.records import replace
from sim_autopilot.air.air import Air
from sim_autopilot.air.airflow import Obstacle
from sim_autopilot.air.wind import Gust, Turbulence, WindModel
from sim_autopilot.core.noise import NoiseSeed, named_seed
from sim_autopilot.physics.airframe import (
    ARDUCOPTER_AIRFRAME,
    BENCHMARK_AIRFRAME,
    PX4_AIRFRAME,
    REPORT_AIRFRAME,
    Airframe,
)
from sim_autopilot.runtime.config import DroneConfig, SimAutopilotConfig, SuperstructureConfig, WindConfig

_AIRFRAMES = {
    "report": REPORT_AIRFRAME,
    "benchmark": BENCHMARK_AIRFRAME,
    "arducopter": ARDUCOPTER_AIRFRAME,
    "px4": PX4_AIRFRAME,
}


def airframe_of(drone: DroneConfig) -> Airframe:
    """Return the airframe of a drone: the named one with what differs from it."""
    named = _AIRFRAMES[drone.airframe]
    names = ("mass_kg", "thrust_to_weight", "drag_n_s_m", "motor_time_constant_s")
    own = {name: value for name in names if (value := getattr(drone, name)) is not None}
    if drone.mass_kg is not None:
        x, y, z = (drone.mass_kg / named.mass_kg * one for one in named.inertia_kg_m2)
        return replace(named, inertia_kg_m2=(x, y, z), **own)
    return replace(named, **own)


def wind_model(config: SimAutopilotConfig, seed: NoiseSeed | None = None) -> WindModel:
    """Return the air, which blows towards where it does not come from.

    Args:
        config: of the mean wind, the turbulence and the gust.
        seed: of the turbulence, or the generator that draws it; None for the configuration's.
    """
    wind = config.wind
    from_rad = wind.from_rad
    if from_rad is None:
        from_rad = float(np.random.default_rng(named_seed(config.seed, "wind")).uniform(-pi, pi))
    std_m_s = wind.turbulence_std_m_s
    turbulence = Turbulence[wind.turbulence.upper()] if std_m_s is None else std_m_s
    seed = named_seed(config.seed, "turbulence") if seed is None else seed
    return WindModel(seed, wind.mean_m_s, from_rad + pi, turbulence, gust=_gust(wind))


def air_model(
    config: SimAutopilotConfig, wind_seed: NoiseSeed | None = None, wake_seed: NoiseSeed | None = None
) -> Air:
    """Return the wind with what a vehicle makes of it.

    Args:
        config: of the wind and the vehicle.
        wind_seed: of the wind's turbulence, or the generator that draws it; None for the configuration's.
        wake_seed: of the turbulence behind the vehicle, likewise.
    """
    wake_seed = named_seed(config.seed, "wake") if wake_seed is None else wake_seed
    structure = config.vehicle.superstructure
    return Air(
        wind_model(config, wind_seed),
        wake_seed,
        None if structure is None else superstructure_of(structure, config.vehicle.roof_height_m),
    )


def superstructure_of(structure: SuperstructureConfig, deck_height_m: float) -> Obstacle:
    """Return what stands on a deck, as it stands in the wind."""
    return Obstacle(
        length_m=structure.length_m,
        width_m=structure.width_m,
        height_m=structure.height_m,
        ahead_m=structure.rear_m + 0.5 * structure.length_m,
        foot_m=deck_height_m,
    )


def _gust(wind: WindConfig) -> Gust | None:
    if wind.gust_m_s == 0.0:
        return None
    return Gust(
        peak_m_s=wind.gust_m_s,
        direction_rad=wind.gust_from_rad + pi,
        start_s=wind.gust_start_s,
        duration_s=wind.gust_duration_s,
    )
