"""The configuration of `sim-autopilot`: one TOML file, validated once, every value with its unit and source."""

from math import pi, radians
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from link.errors import UserError
from link.geodesy import Datum
from link.messages import Vector3
from link.toml_config import StrictModel
from sim_autopilot.control.kinds import ControllerKind
from sim_autopilot.firmware.px4 import PX4
from sim_autopilot.memory import AutopilotConfig
from sim_autopilot.parameters import default_values
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, REPORT_AIRFRAME
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.physics.wind import Turbulence, WindModel
from sim_autopilot.plant import PlantConfig

Positive = Annotated[float, Field(gt=0.0, le=1e4)]
NotNegative = Annotated[float, Field(ge=0.0, le=1e4)]

_FIRMWARES = {"px4": PX4}
_AIRFRAMES = {"report": REPORT_AIRFRAME, "benchmark": BENCHMARK_AIRFRAME}


class DatumConfig(StrictModel):
    """The origin of W on the WGS 84 ellipsoid; by default on the Tempelhofer Feld, a former airfield in Berlin."""

    latitude_deg: Annotated[float, Field(ge=-90.0, le=90.0)] = 52.4733
    longitude_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 13.4017
    altitude_m: Annotated[float, Field(ge=-500.0, le=9000.0)] = 89.0


class StartConfig(StrictModel):
    """Where the drone stands at boot."""

    position_enu_m: Vector3 = (0.0, 0.0, 0.0)  # of the point under its feet
    yaw_rad: Annotated[float, Field(ge=-pi, le=pi)] = 0.0


class DroneConfig(StrictModel):
    """The drone and its flight controller."""

    airframe: Literal["report", "benchmark"] = "benchmark"
    controller: Literal["lqr", "lqr_feedforward", "geometric"] = "geometric"
    friction_coefficient: Annotated[float, Field(ge=0.0, le=2.0)] = 0.8  # rubber on painted metal
    ground_effect: bool = True
    solid: bool = True  # False: a flying drone passes through ground and vehicle; the report's simulation has neither
    endurance_s: Positive = 1200.0


class WindConfig(StrictModel):
    """Mean wind and turbulence (MIL-F-8785C, low altitude)."""

    mean_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0
    from_rad: Annotated[float, Field(ge=-pi, le=pi)] | None = None  # from East counter-clockwise; None: by the seed
    turbulence: Literal["none", "light", "moderate", "severe"] = "none"


class VehicleConfig(StrictModel):
    """The vehicle's body, which its truth does not tell; its roof is as high as the pad it tells of."""

    length_m: Positive = 4.2
    width_m: Positive = 1.8
    roof_height_m: NotNegative = 1.5  # until the vehicle tells its pad's height; MBZIRC 2017


class SimAutopilotConfig(StrictModel):
    """Everything that can be set about the simulated autopilot."""

    firmware: Literal["px4"] = "px4"
    instance: Annotated[int, Field(ge=0, le=249)] = 0  # system id - 1, and added to the default port
    instant: bool = False  # ready at once, without the seconds that a boot takes
    seed: Annotated[int, Field(ge=0)] = 1  # of the wind
    datum: DatumConfig = DatumConfig()
    start: StartConfig = StartConfig()
    drone: DroneConfig = DroneConfig()
    wind: WindConfig = WindConfig()
    vehicle: VehicleConfig = VehicleConfig()
    parameters: dict[str, float] = Field(default_factory=dict)  # firmware parameters that differ from their defaults


def autopilot_config(config: SimAutopilotConfig) -> AutopilotConfig:
    """Return what the autopilot's step takes.

    Raises:
        UserError: a firmware parameter does not exist or is out of range.
    """
    firmware = _FIRMWARES[config.firmware]
    try:
        default_values(firmware.parameters, config.parameters)
    except ValueError as error:
        raise UserError(f"parameters: {error}") from None
    x, y, z = config.start.position_enu_m
    return AutopilotConfig(
        firmware=firmware,
        datum=Datum(
            latitude_rad=radians(config.datum.latitude_deg),
            longitude_rad=radians(config.datum.longitude_deg),
            altitude_m=config.datum.altitude_m,
        ),
        plant=PlantConfig(
            airframe=_AIRFRAMES[config.drone.airframe],
            controller=ControllerKind(config.drone.controller),
            friction_coefficient=config.drone.friction_coefficient,
            ground_effect=config.drone.ground_effect,
            solid=config.drone.solid,
        ),
        system_id=config.instance + 1,
        instant=config.instant,
        position_enu_m=(x, y, z + GEAR_HEIGHT_M),
        yaw_rad=config.start.yaw_rad,
        parameters=config.parameters,
        endurance_s=config.drone.endurance_s,
    )


def wind_model(config: SimAutopilotConfig) -> WindModel:
    """Return the air, which blows towards where it does not come from."""
    from_rad = config.wind.from_rad
    if from_rad is None:
        from_rad = float(np.random.default_rng(config.seed).uniform(-pi, pi))
    return WindModel(config.seed, config.wind.mean_m_s, from_rad + pi, Turbulence[config.wind.turbulence.upper()])
