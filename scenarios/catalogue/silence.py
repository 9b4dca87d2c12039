"""What whoever flies a scenario knows of a vehicle that tells nothing, and tells the companion."""

from companion.config.companion import CompanionConfig, SilentVehicleConfig
from link.errors import UserError
from scenarios.config import Scenario


def look_out_for_silent_vehicle(scenario: Scenario) -> Scenario:
    """Return `scenario` with a companion that knows the pad of a silent vehicle and waits high enough to see it come.

    What the file says of the companion's `silent_vehicle` and of the heights at which it waits stays.

    Raises:
        UserError: nothing on the drone sees the pad.
    """
    if not scenario.is_silent:
        return scenario
    if not scenario.has_camera and scenario.sensors.pattern is None:
        raise UserError(
            f"{scenario.name}: nobody sees a vehicle that tells nothing: add +camera=day or +sensors=nominal"
        )
    body, companion = scenario.vehicle, scenario.system.companion
    if companion.silent_vehicle is None:
        known = SilentVehicleConfig(pad_size_m=body.pad_size_m, pad_height_m=body.roof_height_m)
        companion = companion.model_copy(update={"silent_vehicle": known})
    places = {}
    if "waiting_point_enu_m" not in scenario.model_fields_set and not companion.takeoff.model_fields_set:
        waiting_m = body.roof_height_m + companion.chase.unseen_height_max_m
        companion = _waiting_at(companion, waiting_m)
        east_m, north_m, _ = scenario.waiting_point_enu_m
        places = {"waiting_point_enu_m": (east_m, north_m, waiting_m)}
    system = scenario.system.model_copy(update={"companion": companion})
    return scenario.model_copy(update={"system": system, **places})


def _waiting_at(companion: CompanionConfig, height_m: float) -> CompanionConfig:
    takeoff = companion.takeoff.model_copy(update={"waiting_height_m": height_m})
    return companion.model_copy(update={"takeoff": takeoff})
