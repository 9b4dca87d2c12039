"""ArduCopter silent for a while: waiting in the mode that follows setpoints, it is landed with afterwards.

PX4's link that is lost is among the faults of `test_matrix`.
"""

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.flight import FaultFlight

SILENT_S = 2.0
"""Longer than ArduPilot's advised GUID_TIMEOUT of 1 s."""
LOST_S = 4.0
LANDS_WITHIN_S = 60.0


def _chase() -> FaultFlight:
    flight = FaultFlight(load_scenario("straight_5+firmware=ardupilot"), 1)
    flight.fly_to(Phase.CHASE)
    return flight


def test_arducopter_that_was_silent_for_longer_than_its_time_out_is_landed_with_afterwards() -> None:
    flight = _chase()
    flight.cut_link(SILENT_S)
    ends_s = flight.recording.elapsed_s + LANDS_WITHIN_S
    while flight.phase is not Phase.SECURED and flight.recording.elapsed_s < ends_s:
        flight.step()
        assert flight.phase is not Phase.PILOT
    assert flight.phase is Phase.SECURED


def test_flight_with_arducopter_is_given_over_once_the_link_is_lost() -> None:
    flight = _chase()
    flight.cut_link(LOST_S)
    flight.fly(LOST_S + 1.0)
    assert flight.phase is Phase.PILOT
    cause = flight.companion.memory.progress.cause
    assert cause is not None
    assert cause.reason is Reason.AUTOPILOT_LOST
