"""A companion that dies leaves its autopilot with a setpoint, which must lead neither into the road nor away."""

import math

import pytest

from companion.landing.carried_on import FARTHEST_M
from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.flight import FaultFlight

pytestmark = pytest.mark.slow

ROOF_M = load_scenario("straight_5").vehicle.roof_height_m
DEFAULTS = {"GUID_TIMEOUT": 3.0, "WPNAV_ACCEL_Z": 100.0, "PSC_JERK_Z": 5.0}
TRAILS_M = 1.0  # by which the drone is ahead of its setpoint at most, as tracking goes in a chase


@pytest.mark.parametrize(
    ("phase", "into_it_s"), [(Phase.CHASE, 0.5), (Phase.ALIGN, 0.0), (Phase.DESCEND, 1.0), (Phase.ABORT, 0.3)]
)
def test_arducopter_with_its_default_time_out_stays_near_and_in_the_air_when_the_companion_dies(
    phase: Phase, into_it_s: float
) -> None:
    scenario = load_scenario("straight_5").model_copy(update={"firmware": "ardupilot"})
    scenario.system.parameters["ardupilot"].update(DEFAULTS)
    flight = FaultFlight(scenario, 1)
    flight.fly_to(phase)
    flight.fly(into_it_s)
    assert flight.companion.autopilot.state.parameters["GUID_TIMEOUT"] == 3.0
    flight.cut_link()
    left = flight.recording.drone[-1].position_enu_m
    places = []
    for _ in range(80):
        flight.fly(0.1)
        places.append(flight.recording.drone[-1].position_enu_m)
    assert min(height_m for _, _, height_m in places) > ROOF_M
    assert max(math.dist(place[:2], left[:2]) for place in places) < FARTHEST_M + TRAILS_M
    assert max(height_m for _, _, height_m in places) < left[2] + FARTHEST_M
