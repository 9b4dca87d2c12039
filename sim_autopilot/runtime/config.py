"""The configuration of `sim-autopilot`: one TOML file, validated once, every value with its unit and source."""

from collections.abc import Mapping
from math import pi, radians
from types import MappingProxyType
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from link.errors import UserError
from link.frames.geodesy import Datum
from link.messages import Vector3
from link.program.toml_config import NotNegative, Positive, StrictModel
from link.records import replace
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.core.noise import NoiseSeed, named_seed
from sim_autopilot.core.parameters import default_values
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.ground_station.ardupilot import ARDUPILOT_STATION
from sim_autopilot.ground_station.px4.station import PX4_STATION
from sim_autopilot.interfaces import NO_SERVICES, Firmware, Services
from sim_autopilot.memory import AutopilotConfig
from sim_autopilot.physics.airframe import ARDUCOPTER_AIRFRAME, BENCHMARK_AIRFRAME, REPORT_AIRFRAME, Airframe
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.physics.wind import Gust, Turbulence, WindModel
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.own_state import OwnStateModel

_FIRMWARES: Mapping[str, tuple[Firmware, Services]] = MappingProxyType(
    {"px4": (PX4, PX4_STATION), "ardupilot": (ARDUPILOT, ARDUPILOT_STATION)}
)
"""Each firmware with the services beside its flight."""
_AIRFRAMES = {"report": REPORT_AIRFRAME, "benchmark": BENCHMARK_AIRFRAME, "arducopter": ARDUCOPTER_AIRFRAME}


class DatumConfig(StrictModel):
    """The origin of W on the WGS 84 ellipsoid; by default on the Tempelhofer Feld, a former airfield in Berlin."""

    latitude_deg: Annotated[float, Field(ge=-90.0, le=90.0)] = 52.4733
    longitude_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 13.4017
    altitude_m: Annotated[float, Field(ge=-500.0, le=9000.0)] = 89.0


class StartConfig(StrictModel):
    """Where the drone stands at boot."""

    position_enu_m: Vector3 = (0.0, 0.0, 0.0)  # of the point under its feet
    yaw_rad: Annotated[float, Field(ge=-pi, le=pi)] = 0.0
    velocity_enu_m_s: Vector3 = (0.0, 0.0, 0.0)  # on the deck of a vehicle that drives


class DroneConfig(StrictModel):
    """The drone and its flight controller; what is given beside the airframe's name is in place of its own."""

    airframe: Literal["report", "benchmark", "arducopter"] = "benchmark"
    mass_kg: Annotated[float, Field(ge=0.5, le=6.0)] | None = None  # of the same size; the inertia grows with it
    thrust_to_weight: Annotated[float, Field(ge=1.2, le=10.0)] | None = None
    drag_n_s_m: Annotated[float, Field(ge=0.0, le=5.0)] | None = None
    motor_time_constant_s: Annotated[float, Field(gt=0.0, le=0.5)] | None = None
    controller: Literal["lqr", "lqr_feedforward", "geometric"] = "geometric"
    friction_coefficient: Annotated[float, Field(ge=0.0, le=2.0)] = 0.8  # rubber on painted metal
    ground_effect: bool = True
    solid: bool = True  # False: a flying drone passes through ground and vehicle; the report's simulation has neither
    endurance_s: Positive = 1200.0


class WindConfig(StrictModel):
    """Mean wind, turbulence and a discrete gust (MIL-F-8785C, low altitude)."""

    mean_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0
    from_rad: Annotated[float, Field(ge=-pi, le=pi)] | None = None  # from East counter-clockwise; None: by the seed
    turbulence: Literal["none", "light", "moderate", "severe"] = "none"
    turbulence_std_m_s: Annotated[float, Field(ge=0.0, le=10.0)] | None = None  # vertical; in place of the severity's
    gust_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0  # its peak; 0 is none
    gust_from_rad: Annotated[float, Field(ge=-pi, le=pi)] = 0.0  # from East counter-clockwise
    gust_start_s: NotNegative = 0.0  # since boot
    gust_duration_s: Positive = 3.0


RECEIVER_ACCURACY_MIN_M = 0.01
"""A receiver never states less."""


class OwnStateConfig(StrictModel):
    """How well the autopilot knows its own state; all zero is the truth."""

    position_std_m: NotNegative = 0.0  # on each axis
    velocity_std_m_s: NotNegative = 0.0  # likewise
    # What its receiver states, horizontally; None: as well as the drone knows its place, but for a centimetre.
    receiver_accuracy_m: Positive | None = None
    position_time_s: Positive = 10.0  # of both errors' memory; sim_autopilot/plant/own_state.py says why
    velocity_time_s: Positive = 2.0
    origin_step_enu_m: Vector3 | None = None  # how far the local frame's origin moves in flight
    origin_step_s: NotNegative = 0.0  # since boot, when it does


class VehicleConfig(StrictModel):
    """The vehicle's body, which its truth does not tell; its roof is as high as the pad it tells of."""

    length_m: Positive = 4.2
    width_m: Positive = 1.8
    roof_height_m: NotNegative = 1.5  # until the vehicle tells its pad's height; MBZIRC 2017


class LinkConfig(StrictModel):
    """A MAVLink link."""

    device: str  # udpout:HOST:PORT, udpout:HOST:PORT:OWN_PORT, udpin:HOST:PORT, tcp:, tcpin: or /dev/ttyX,BAUD
    streams: Literal["onboard", "ground"] = "onboard"  # what it sends unasked, where the firmware makes a difference


class SimAutopilotConfig(StrictModel):
    """Everything that can be set about the simulated autopilot."""

    firmware: Literal["px4", "ardupilot"] = "px4"
    core: bool = False  # the flight alone: no files, logs, uploads of plans, calibration, shell and the like
    instance: Annotated[int, Field(ge=0, le=249)] = 0  # system id - 1; shifts the default ports
    instant: bool = False  # ready at once, without the seconds that a boot takes
    seed: Annotated[int, Field(ge=0)] = 1  # of the wind and the own state's errors
    datum: DatumConfig = DatumConfig()
    start: StartConfig = StartConfig()
    drone: DroneConfig = DroneConfig()
    wind: WindConfig = WindConfig()
    own_state: OwnStateConfig = OwnStateConfig()
    vehicle: VehicleConfig = VehicleConfig()
    links: tuple[LinkConfig, ...] = ()  # empty: those of the firmware's own simulator, one link within `scenarios`
    parameters: dict[str, float] = Field(default_factory=dict)  # firmware parameters that differ from their defaults


def autopilot_config(config: SimAutopilotConfig) -> AutopilotConfig:
    """Return what the autopilot's step takes.

    Raises:
        UserError: a firmware parameter does not exist or is out of range.
    """
    firmware, services = _FIRMWARES[config.firmware]
    try:
        default_values(firmware.parameters.table, config.parameters)
    except ValueError as error:
        raise UserError(f"parameters: {error}") from None
    ground_rates_hz = firmware.links.ground_rates_hz
    x, y, z = config.start.position_enu_m
    return AutopilotConfig(
        firmware=firmware,
        services=NO_SERVICES if config.core else services,
        datum=Datum(
            latitude_rad=radians(config.datum.latitude_deg),
            longitude_rad=radians(config.datum.longitude_deg),
            altitude_m=config.datum.altitude_m,
        ),
        plant=PlantConfig(
            airframe=airframe_of(config.drone),
            controller=ControllerKind(config.drone.controller),
            friction_coefficient=config.drone.friction_coefficient,
            ground_effect=config.drone.ground_effect,
            solid=config.drone.solid,
        ),
        system_id=config.instance + 1,
        instant=config.instant,
        position_enu_m=(x, y, z + GEAR_HEIGHT_M),
        yaw_rad=config.start.yaw_rad,
        velocity_enu_m_s=config.start.velocity_enu_m_s,
        parameters=config.parameters,
        endurance_s=config.drone.endurance_s,
        links=tuple(ground_rates_hz if link.streams == "ground" else None for link in config.links) or (None,),
        own_state=_own_state(config),
    )


def _own_state(config: SimAutopilotConfig) -> OwnStateModel:
    own = config.own_state
    accuracy_m = own.receiver_accuracy_m or max(RECEIVER_ACCURACY_MIN_M, own.position_std_m)
    settings = own.model_dump() | {"receiver_accuracy_m": accuracy_m}
    return OwnStateModel(seed=named_seed(config.seed, "own state"), **settings)


def airframe_of(drone: DroneConfig) -> Airframe:
    """Return the airframe of a drone: the named one with what differs from it."""
    named = _AIRFRAMES[drone.airframe]
    names = ("mass_kg", "thrust_to_weight", "drag_n_s_m", "motor_time_constant_s")
    own = {name: value for name in names if (value := getattr(drone, name)) is not None}
    if drone.mass_kg is not None:
        x, y, z = (drone.mass_kg / named.mass_kg * one for one in named.inertia_kg_m2)
        return replace(named, inertia_kg_m2=(x, y, z), **own)
    return replace(named, **own)


def with_default_links(config: SimAutopilotConfig) -> SimAutopilotConfig:
    """Return `config` with the links of the firmware's own simulator where it names none."""
    if config.links:
        return config
    firmware, _ = _FIRMWARES[config.firmware]
    defaults = firmware.links.defaults(config.instance)
    links = tuple(LinkConfig(device=one.device, streams="ground" if one.is_ground else "onboard") for one in defaults)
    return config.model_copy(update={"links": links})


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


def _gust(wind: WindConfig) -> Gust | None:
    if wind.gust_m_s == 0.0:
        return None
    return Gust(
        peak_m_s=wind.gust_m_s,
        direction_rad=wind.gust_from_rad + pi,
        start_s=wind.gust_start_s,
        duration_s=wind.gust_duration_s,
    )
