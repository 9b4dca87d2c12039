"""Setpoints alone are lost low above the pad; the autopilot answers all else and is heard."""

import pytest

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_changed_scenario
from scenarios.config import FirmwareName
from scenarios.faults.flight import FaultFlight
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier

pytestmark = pytest.mark.slow

FEET_M = 0.4  # above the pad: from there ArduCopter goes on, and stops above it
SEEN_FROM_M = 2.0  # a range finder sees nothing nearer


@pytest.mark.parametrize("lost_s", [1.0, 4.0])
def test_drone_that_hovers_without_setpoints_is_not_taken_for_one_on_the_pad(lost_s: float) -> None:
    flight = _flown("ardupilot", lost_s)
    reasons = {status.reason_code for status in flight.recording.statuses}
    assert Reason.SETPOINTS_UNHEARD.name in reasons
    assert score_run(flight.scenario, 1, flight.recording).tier is Tier.S3


def _flown(firmware: FirmwareName, lost_s: float) -> FaultFlight:
    changes = [f"firmware={firmware}", f"sensors.range_finder.min_m={SEEN_FROM_M}"]
    flight = FaultFlight(load_changed_scenario("straight_5", changes), 1)
    flight.fly_to(Phase.DESCEND)
    while not flight.is_below(FEET_M):
        flight.step()
    flight.lose_setpoints(lost_s)
    flight.run()
    return flight
