"""A world: one scenario drawn from the operational design domain by a seed, and the numbers that it was drawn with."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from scenarios.config import RunConfig, Scenario, SensorsConfig
from scenarios.simulation.noise import Seed
from scenarios.tracks.drive_config import Departure, DriveTrack, LateBrake
from scenarios.worlds.distributions import Value
from scenarios.worlds.draws import Draws
from scenarios.worlds.driver import DRIVE_S, DrivePlan, plan_drive
from scenarios.worlds.flying import draw_drone, draw_firmware, draw_wind, speed_bound_m_s, system_of
from scenarios.worlds.odd import domain, quantities_of
from scenarios.worlds.road import RoadPlan, plan_road
from scenarios.worlds.sensing import draw_link, draw_sensors
from scenarios.worlds.summary import summary_of
from scenarios.worlds.vehicle import draw_vehicle

_WAITING_OVER_ROOF_M = 3.5  # 5 m above the road over the benchmark's roof of 1.5 m
_WAITING_MIN_M = 5.0  # above the road; source report, section "Task"
_APPROACH_MIN_M, _APPROACH_S = 40.0, 3.0  # of road before the waiting point, as the catalogue's tracks
_CRUISE_MIN_M_S = 0.5
_HOVER_RADIUS_M = 2.5  # of the benchmark, and three times what the drone's own place is off by
_OWN_STDS = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """A drawn world.

    Attributes:
        slice: of the domain that it was drawn from.
        seed: that drew it, and that it is flown with.
        scenario: the same as any other one.
        drawn: every drawn number by its name, and those that sum up its road and drive; the same names in all worlds.
    """

    slice: str
    seed: Seed
    scenario: Scenario
    drawn: Mapping[str, float | int | str | bool]


def draw_world(slice: str, seed: Seed, *, chosen: Mapping[str, float] | None = None) -> World:  # noqa: A002 (it is the domain's word)
    """Return the world of `seed` in a slice of the domain.

    Args:
        slice: one of `odd.slices()`.
        seed: of everything random in it.
        chosen: by the name of a drawn quantity, the uniform number in (0, 1) to be used in place of the drawn one.

    Raises:
        UserError: there is no such slice, or something is chosen that is not drawn or is out of (0, 1).
    """
    draws = Draws(quantities_of(slice), seed, chosen or {})
    world = _world(slice, seed, draws)
    draws.check_chosen()
    return world


def quantities(slice: str, seed: Seed) -> tuple[str, ...]:  # noqa: A002 (the domain's word)
    """Return the names of what the world of `seed` draws: of all that may be chosen.

    Raises:
        UserError: there is no such slice.
    """
    draws = Draws(quantities_of(slice), seed, {})
    _world(slice, seed, draws)
    return tuple(draws.uniforms)


def _world(name: str, seed: Seed, draws: Draws) -> World:
    wind, firmware, drone = draw_wind(draws), draw_firmware(draws), draw_drone(draws)
    vehicle, sensors = draw_vehicle(draws), draw_sensors(draws)
    wish_m_s = draws.number("driver.speed_m_s")
    cruise_m_s = max(_CRUISE_MIN_M_S, min(wish_m_s, speed_bound_m_s(drone, wind)))
    run_up_m = _run_up_m(cruise_m_s, draws.number("driver.acceleration_m_s2"))
    length_m = run_up_m + 1.2 * DRIVE_S * cruise_m_s
    road = plan_road(draws, seed, cruise_m_s=cruise_m_s, run_up_m=run_up_m, length_m=length_m)
    drive = plan_drive(draws, seed, road, cruise_m_s=cruise_m_s, run_up_m=run_up_m, length_m=length_m)
    heading_rad = draws.number("road.heading_rad")
    track = DriveTrack(
        kind="drive",
        departure=_departure(draws, sensors),
        begins_m=(-run_up_m * math.cos(heading_rad), -run_up_m * math.sin(heading_rad)),
        heading_rad=heading_rad,
        stretches=tuple(road.stretches),
        shifts=tuple(drive.shifts),
        grades=tuple(road.grades),
        humps=tuple(road.humps),
        waves=tuple(road.waves),
        legs=tuple(drive.legs),
        brake=_late_brake(draws),
        suspension=vehicle.suspension,
    )
    waiting_m = max(_WAITING_MIN_M, vehicle.body.roof_height_m + _WAITING_OVER_ROOF_M)
    scenario = Scenario(
        name=f"{name}-{seed}",
        description=_description(draws, cruise_m_s),
        track=track,
        sensors=sensors,
        wind=wind,
        link=draw_link(draws),
        vehicle=vehicle.body,
        system=system_of(draws, drone, waiting_m),
        firmware=firmware,
        run=RunConfig(waiting_point_enu_m=(0.0, 0.0, waiting_m)),
    )
    return World(slice=name, seed=seed, scenario=scenario, drawn=_drawn(draws, scenario, road, drive, cruise_m_s))


def _description(draws: Draws, cruise_m_s: float) -> str:
    vehicle, road = draws.word("vehicle.class"), draws.word("road.class")
    return f"{vehicle}, {road}, {cruise_m_s:.1f} m/s; version {domain().version} of the domain"


def _run_up_m(cruise_m_s: float, acceleration_m_s2: float) -> float:
    """Return the road before the waiting point: to speed up, and a while at constant speed."""
    return max(_APPROACH_MIN_M, 0.5 * cruise_m_s**2 / acceleration_m_s2 + _APPROACH_S * cruise_m_s)


def _departure(draws: Draws, sensors: SensorsConfig) -> Departure:
    """Return when the vehicle starts: once the drone hovers as near as it knows its own place."""
    radius_m = _HOVER_RADIUS_M + _OWN_STDS * sensors.own_state.position_std_m
    return Departure(hover_radius_m=radius_m, departs_s=draws.number("driver.departs_s"))


def _late_brake(draws: Draws) -> LateBrake | None:
    brake = LateBrake(
        deceleration_m_s2=draws.number("driver.late_brake_m_s2"),
        height_above_roof_m=draws.number("driver.late_brake_height_m"),
    )
    return brake if draws.yes("driver.brakes_late") else None


def _drawn(
    draws: Draws, scenario: Scenario, road: RoadPlan, drive: DrivePlan, cruise_m_s: float
) -> dict[str, Value | int]:
    """Return the drawn numbers that occur once, then what sums up the others."""
    once = {name: value for name, value in draws.values.items() if not name.rpartition(".")[2].isdigit()}
    return once | summary_of(scenario, road, drive, cruise_m_s)
