"""Faults in the phases of a landing end as they should, on ground truth: part of what `scenarios faults` flies."""

import pytest

from companion.phases import Phase
from link.messages import Command
from scenarios.catalogue import load_scenario
from scenarios.fault_flight import FaultFlight
from scenarios.faults import EXPECTED, PHASES, SCENARIO, SEED, Case, Fault, fly_case

SOME = {
    Fault.PILOT: (Phase.WAITING, Phase.CHASE, Phase.ALIGN, Phase.DESCEND, Phase.ABORT, Phase.HOLD),
    Fault.RESTART: (Phase.WAITING, Phase.ALIGN),
    Fault.SILENT: (Phase.TAKEOFF, Phase.WAITING, Phase.CHASE, Phase.ALIGN, Phase.HOLD),
    Fault.LOST: (Phase.WAITING, Phase.HOLD),
    Fault.ORIGIN: (Phase.CHASE, Phase.ALIGN, Phase.ABORT),
    Fault.ESTIMATE: (Phase.WAITING, Phase.ALIGN),
    Fault.PARAMETER: (Phase.HOLD,),
    Fault.VEHICLE: (Phase.CHASE, Phase.ABORT),
    Fault.COMPANION: (Phase.WAITING, Phase.HOLD),
}
"""The full matrix takes minutes."""


def test_every_fault_has_an_expected_end_in_every_phase() -> None:
    assert set(EXPECTED) == {Case(fault=fault, phase=phase) for fault in Fault for phase in PHASES}


@pytest.mark.slow
@pytest.mark.parametrize(("fault", "phase"), [(fault, phase) for fault, phases in SOME.items() for phase in phases])
def test_fault_ends_as_expected(fault: Fault, phase: Phase) -> None:
    ended = fly_case(Case(fault=fault, phase=phase))
    assert ended.is_right, ended


@pytest.mark.slow
def test_setpoints_do_not_resume_when_the_link_comes_back_after_the_time_out() -> None:
    flight = FaultFlight(load_scenario(SCENARIO), SEED)
    flight.fly_to(Phase.WAITING)
    flight.cut_link(4.0)
    flight.fly(3.5)
    sent = flight.setpoints
    flight.fly(2.5)
    flight.companion.request(Command.START)
    flight.fly(1.0)
    assert flight.phase is Phase.PILOT  # in a failsafe a start is refused
    assert flight.setpoints == sent
    assert not flight.follows_setpoints
