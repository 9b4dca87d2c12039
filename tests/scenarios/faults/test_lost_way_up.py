"""The way up to the autopilot is lost for a moment beside a driving vehicle; the drone is heard on, and hovers."""

import math

import pytest

from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.sortie_flight import SortieFaultFlight

pytestmark = pytest.mark.slow

BACK_S = 9.0  # 20 m behind a vehicle at 10 m/s
OFF_M = 0.6


def _away_m(flight: SortieFaultFlight) -> float:
    drone, vehicle = flight.recording.drone[-1], flight.recording.vehicle[-1]
    return math.dist(drone.position_enu_m[:2], vehicle.position_enu_m[:2])


@pytest.mark.parametrize("lost_s", [1.0, 2.0])
def test_drone_that_has_heard_no_setpoints_flies_back_to_its_station(lost_s: float) -> None:
    flight = SortieFaultFlight(load_scenario("straight_10+firmware=px4"), 150_450)
    flight.fly_to(Phase.FOLLOW)
    kept_m, since = _away_m(flight), len(flight.recording.statuses)
    flight.cut_way_up(lost_s)
    flight.fly(lost_s + BACK_S)
    assert {status.phase for status in flight.recording.statuses[since:]} == {Phase.FOLLOW.value}
    assert _away_m(flight) == pytest.approx(kept_m, abs=OFF_M)
