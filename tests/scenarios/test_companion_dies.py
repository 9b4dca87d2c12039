"""A companion that dies leaves its autopilot with a setpoint, which must not lead into the road while that holds."""

import pytest

from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.flight import FaultFlight

pytestmark = pytest.mark.slow

ROOF_M = load_scenario("straight_5").vehicle.roof_height_m


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN])
def test_arducopter_with_its_default_time_out_stays_in_the_air_when_the_companion_dies_on_the_way(
    phase: Phase,
) -> None:
    scenario = load_scenario("straight_5").model_copy(update={"firmware": "ardupilot"})
    flight = FaultFlight(scenario, 1)
    flight.fly_to(phase)
    assert not flight.companion.autopilot.state.parameters.get("GUID_TIMEOUT", 3.0) < 3.0
    flight.cut_link()
    lowest_m = flight.height_m
    for _ in range(60):
        flight.fly(0.1)
        lowest_m = min(lowest_m, flight.height_m)
    assert lowest_m > ROOF_M
