"""An autopilot that is silent for a while: who waits in the mode that follows setpoints is landed with afterwards."""

import pytest

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.flight import FaultFlight

SILENT_S = 2.0
"""Longer than ArduPilot's advised GUID_TIMEOUT of 1 s, and than PX4's COM_OF_LOSS_T of 1 s."""
LANDS_WITHIN_S = 60.0


def _flight(firmware: str) -> FaultFlight:
    flight = FaultFlight(load_scenario(f"straight_5+firmware={firmware}"), 1)
    flight.fly_to(Phase.CHASE)
    return flight


def test_arducopter_that_was_silent_for_longer_than_its_time_out_is_landed_with_afterwards() -> None:
    flight = _flight("ardupilot")
    flight.cut_link(SILENT_S)
    ends_s = flight.recording.elapsed_s + LANDS_WITHIN_S
    while flight.phase is not Phase.SECURED and flight.recording.elapsed_s < ends_s:
        flight.step()
        assert flight.phase is not Phase.PILOT
    assert flight.phase is Phase.SECURED


@pytest.mark.parametrize(("firmware", "silent_s"), [("ardupilot", 4.0), ("px4", 4.0)])
def test_flight_is_given_over_once_the_link_is_lost(firmware: str, silent_s: float) -> None:
    flight = _flight(firmware)
    flight.cut_link(silent_s)
    flight.fly(silent_s + 1.0)
    assert flight.phase is Phase.PILOT
    cause = flight.companion.memory.progress.cause
    assert cause is not None
    assert cause.reason is Reason.AUTOPILOT_LOST
