"""From the configuration to what the autopilot's step takes, and the links of a firmware's own simulator."""

from collections.abc import Mapping
from math import radians
from types import MappingProxyType

from link.errors import UserError
from link.frames.geodesy import Datum
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.core.noise import named_seed
from sim_autopilot.core.parameters import default_values
from sim_autopilot.core.range_finder import RangeFinderModel
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.ground_station.ardupilot import ARDUPILOT_STATION
from sim_autopilot.ground_station.px4.station import PX4_STATION
from sim_autopilot.interfaces import NO_SERVICES, AutopilotConfig, Firmware, Services
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.own_state import OwnStateModel
from sim_autopilot.runtime.config import (
    RECEIVER_ACCURACY_MIN_M,
    LinkConfig,
    SimAutopilotConfig,
)
from sim_autopilot.runtime.physics import airframe_of

_FIRMWARES: Mapping[str, tuple[Firmware, Services]] = MappingProxyType(
    {"px4": (PX4, PX4_STATION), "ardupilot": (ARDUPILOT, ARDUPILOT_STATION)}
)
"""Each firmware with the services beside its flight."""


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
        range_finder=RangeFinderModel(seed=named_seed(config.seed, "range finder"), **config.range_finder.model_dump()),
    )


def _own_state(config: SimAutopilotConfig) -> OwnStateModel:
    own = config.own_state
    accuracy_m = own.receiver_accuracy_m or max(RECEIVER_ACCURACY_MIN_M, own.position_std_m)
    settings = own.model_dump() | {"receiver_accuracy_m": accuracy_m}
    return OwnStateModel(seed=named_seed(config.seed, "own state"), **settings)


def with_default_links(config: SimAutopilotConfig) -> SimAutopilotConfig:
    """Return `config` with the links of the firmware's own simulator where it names none."""
    if config.links:
        return config
    firmware, _ = _FIRMWARES[config.firmware]
    defaults = firmware.links.defaults(config.instance)
    links = tuple(LinkConfig(device=one.device, streams="ground" if one.is_ground else "onboard") for one in defaults)
    return config.model_copy(update={"links": links})
