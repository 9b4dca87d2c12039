"""What a sortie is flown in: the drone rides on the deck, and the vehicle drives for long enough."""

import math

import pytest

from link.errors import UserError
from scenarios.catalogue.catalogue import load_changed_scenario
from scenarios.simulation.drone import sim_autopilot_config
from scenarios.simulation.vehicle import VehicleMemory, vehicle_at
from scenarios.simulation.vehicle_node import plan_of
from scenarios.sortie.script import stations_of
from scenarios.sortie.task import sortie_scenario


def test_drone_begins_on_the_deck_with_the_decks_velocity() -> None:
    scenario = sortie_scenario("circle_5", 3, "ardupilot")
    start = sim_autopilot_config(scenario, 3, instant=True).start
    vehicle = vehicle_at(VehicleMemory(departs_ns=0), 0, plan_of(scenario, 3))
    assert start.velocity_enu_m_s == vehicle.velocity_enu_m_s
    over_m = start.position_enu_m[2] - vehicle.position_enu_m[2]
    assert over_m == pytest.approx(scenario.vehicle.roof_height_m)
    assert math.dist(start.position_enu_m[:2], vehicle.position_enu_m[:2]) == 0.0


def test_vehicle_drives_through_all_of_the_sortie() -> None:
    scenario = sortie_scenario("straight_10", 1, "px4")
    driven = vehicle_at(VehicleMemory(departs_ns=0), 250_000_000_000, plan_of(scenario, 1))
    assert math.hypot(*driven.velocity_enu_m_s[:2]) == pytest.approx(10.0)


@pytest.mark.parametrize(("cell", "heights_m"), [("straight_10", [4.0, 1.0, 1.0]), ("ship_ss5", [4.0, 4.0, 4.0])])
def test_stations_are_clear_of_the_vehicle(cell: str, heights_m: list[float]) -> None:
    assert [one.offset_m[2] for one in stations_of(sortie_scenario(cell, 1, "px4"))] == heights_m


def test_stations_of_a_low_vehicle_are_clear_of_the_road() -> None:
    scenario = load_changed_scenario("straight_10", ["vehicle.roof_height_m=0.4"])
    assert [one.offset_m[2] for one in stations_of(scenario)] == [4.0, pytest.approx(1.6), pytest.approx(1.6)]


def test_a_vehicle_that_stands_is_refused() -> None:
    with pytest.raises(UserError, match="its vehicle stands"):
        sortie_scenario("static", 1, "px4")
