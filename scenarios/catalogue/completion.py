"""What a scenario's file leaves open: where the drone stands, and what is known of a vehicle that tells nothing.

The drone stands clear of a vehicle that begins in the same place. Frames: W is ENU about the datum; the vehicle's body
is a box about the road's first point.
"""

import math

from companion.config.companion import CompanionConfig, SilentVehicleConfig
from link.errors import UserError
from link.messages import Vector3
from scenarios.config import Scenario
from scenarios.simulation.vehicle import VehicleMemory, VehicleState, vehicle_at
from scenarios.simulation.vehicle_node import plan_of

_DRONE_RADIUS_M = 0.5  # with its rotors
_AHEAD_M = 3.0  # of the vehicle's front, for a drone that the wind shifts while it takes off
_PLACES = frozenset({"drone_start_enu_m", "waiting_point_enu_m"})


def place_drone(scenario: Scenario) -> Scenario:
    """Return `scenario` with a drone on the deck of a vehicle that drives, or on the road clear of one that stands.

    Raises:
        UserError: the file places the drone inside the vehicle, or where it never comes to the waiting point.
    """
    if scenario.run.place == "road":
        return _wait_above_start(keep_clear_of_vehicle(_start_below_waiting_point(scenario)))
    departure = scenario.track.departure.model_copy(update={"wait_for_drone": False, "departs_s": 0.0})
    return scenario.model_copy(update={"track": scenario.track.model_copy(update={"departure": departure})})


def keep_clear_of_vehicle(scenario: Scenario) -> Scenario:
    """Return `scenario` with a drone that does not begin inside the vehicle.

    Where the file names neither the drone's start nor the waiting point, the drone starts ahead of the vehicle's front.
    A drone may begin on the roof.

    Raises:
        UserError: the file places the drone inside the vehicle.
    """
    vehicle = vehicle_at(VehicleMemory(), 0, plan_of(scenario, seed=0))
    if not _is_inside(scenario.run.drone_start_enu_m, vehicle, scenario):
        return scenario
    if scenario.run.model_fields_set & _PLACES:
        east_m, north_m, up_m = scenario.run.drone_start_enu_m
        raise UserError(
            f"{scenario.name}: the drone would begin inside the vehicle, at ({east_m:g}, {north_m:g}, {up_m:g}) m;"
            " change run.drone_start_enu_m and run.waiting_point_enu_m, or where the road begins"
        )
    before_m = 0.5 * scenario.vehicle.length_m + _AHEAD_M
    east_m = vehicle.position_enu_m[0] + before_m * math.cos(vehicle.yaw_rad)
    north_m = vehicle.position_enu_m[1] + before_m * math.sin(vehicle.yaw_rad)
    return scenario.with_run(drone_start_enu_m=(east_m, north_m, vehicle.position_enu_m[2]))


def _start_below_waiting_point(scenario: Scenario) -> Scenario:
    """Return `scenario` with a drone that starts below the waiting point, where the file names this alone."""
    run, companion = scenario.run, scenario.system.companion
    if "waiting_point_enu_m" not in run.model_fields_set:
        return scenario
    east_m, north_m, up_m = run.waiting_point_enu_m
    height_m = up_m - run.drone_start_enu_m[2]
    if "waiting_height_m" not in companion.takeoff.model_fields_set and height_m > 0.0:
        scenario = _with_companion(scenario, _waiting_at(companion, height_m))
    if "drone_start_enu_m" in run.model_fields_set:
        return scenario
    return scenario.with_run(drone_start_enu_m=(east_m, north_m, run.drone_start_enu_m[2]))


def _wait_above_start(scenario: Scenario) -> Scenario:
    """Return `scenario` with a vehicle that waits for the drone where the drone waits: straight above its start.

    Raises:
        UserError: the file says more than one thing of where that is.
    """
    run, departure = scenario.run, scenario.track.departure
    east_m, north_m, up_m = run.drone_start_enu_m
    above_start_enu_m = (east_m, north_m, up_m + scenario.system.companion.takeoff.waiting_height_m)
    if "waiting_point_enu_m" not in run.model_fields_set:
        return scenario.with_run(waiting_point_enu_m=above_start_enu_m)
    apart_m = math.dist(above_start_enu_m, run.waiting_point_enu_m)
    if departure.wait_for_drone and apart_m > departure.hover_radius_m:
        raise UserError(
            f"{scenario.name}: the drone would wait {apart_m:.1f} m from run.waiting_point_enu_m, and the vehicle would"
            " never depart; change that, run.drone_start_enu_m or system.companion.takeoff.waiting_height_m"
        )
    return scenario


def _is_inside(drone_enu_m: Vector3, vehicle: VehicleState, scenario: Scenario) -> bool:
    """Return whether a drone that stands at `drone_enu_m` is in the vehicle's box."""
    east_m, north_m, up_m = (a - b for a, b in zip(drone_enu_m, vehicle.position_enu_m, strict=True))
    along_m = east_m * math.cos(vehicle.yaw_rad) + north_m * math.sin(vehicle.yaw_rad)
    aside_m = north_m * math.cos(vehicle.yaw_rad) - east_m * math.sin(vehicle.yaw_rad)
    body = scenario.vehicle
    over = abs(along_m) < 0.5 * body.length_m + _DRONE_RADIUS_M and abs(aside_m) < 0.5 * body.width_m + _DRONE_RADIUS_M
    return over and up_m < body.roof_height_m


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
    if "waiting_point_enu_m" not in scenario.run.model_fields_set and not companion.takeoff.model_fields_set:
        companion = _waiting_at(companion, body.roof_height_m + companion.chase.unseen_height_max_m)
    return _with_companion(scenario, companion)


def _with_companion(scenario: Scenario, companion: CompanionConfig) -> Scenario:
    system = scenario.system.model_copy(update={"companion": companion})
    return scenario.model_copy(update={"system": system})


def _waiting_at(companion: CompanionConfig, height_m: float) -> CompanionConfig:
    takeoff = companion.takeoff.model_copy(update={"waiting_height_m": height_m})
    return companion.model_copy(update={"takeoff": takeoff})
