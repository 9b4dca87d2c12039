"""Faults in the phases of a landing end as they should, on ground truth: part of what `scenarios faults` flies."""

import pytest

from companion.situation.phases import Phase
from link.messages import Command
from scenarios.config import FIRMWARES
from scenarios.faults.flight import FaultFlight
from scenarios.faults.matrix import EXPECTED, EXPECTED_OVER_WIRE, IN_SORTIES_ONLY, OVER_WIRE_ONLY, PHASES, Case, Fault
from scenarios.faults.trial import SEED, Ended, fly_case, scenario_of
from scenarios.scoring.score import Tier

# The full matrix takes half an hour: some, in the phase in which they once went or would go most wrong. A lowered speed
# limit and a vehicle that falls silent are among the golden flights; ArduCopter's link is cut in `test_companion_dies`.
SOME = (
    Case(fault=Fault.LOST, phase=Phase.CHASE),
    Case(fault=Fault.PILOT, phase=Phase.DESCEND),
    Case(fault=Fault.RESTART, phase=Phase.ALIGN),
    Case(fault=Fault.ORIGIN, phase=Phase.ALIGN),
    Case(fault=Fault.ESTIMATE, phase=Phase.CHASE),
    Case(fault=Fault.COMPANION_STOPPED_LONG, phase=Phase.DESCEND),
    Case(fault=Fault.VEHICLE_STOPPED, phase=Phase.CHASE, firmware="ardupilot"),
    Case(fault=Fault.SLIDE, phase=Phase.DESCEND, firmware="ardupilot"),
    Case(fault=Fault.SPOILT, phase=Phase.CHASE),
)


def test_every_fault_has_an_expected_end_in_every_phase_with_each_firmware() -> None:
    in_lockstep = set(Fault) - IN_SORTIES_ONLY - OVER_WIRE_ONLY
    for rows, faults in ((EXPECTED, in_lockstep), (EXPECTED_OVER_WIRE, OVER_WIRE_ONLY)):
        assert set(rows) == {
            Case(fault=fault, phase=phase, firmware=firmware)
            for fault in faults
            for phase in PHASES
            for firmware in FIRMWARES
        }
        assert all(expected.ends for expected in rows.values())


@pytest.mark.parametrize("tier", list(Tier))
@pytest.mark.parametrize("motors_off", [False, True])
def test_only_a_hover_in_the_clear_is_right_in_the_air_when_the_companion_is_lost(tier: Tier, motors_off: bool) -> None:
    ended = Ended(
        case=Case(fault=Fault.COMPANION, phase=Phase.DESCEND),
        phase=Phase.IDLE,
        reason="",
        tier=tier,
        judged="",
        motors_off=motors_off,
        tilt_max_rad=0.3,
        setpoints=0,
        taken_back=False,
    )
    assert ended.is_right is (tier is Tier.ABORT and not motors_off)


@pytest.mark.slow
@pytest.mark.parametrize("case", SOME, ids=lambda case: f"{case.firmware}-{case.fault.name}-{case.phase.name}")
def test_fault_ends_as_expected(case: Case) -> None:
    ended = fly_case(case)
    assert ended.is_right, ended


@pytest.mark.slow
def test_setpoints_do_not_resume_when_the_link_comes_back_after_the_time_out() -> None:
    flight = FaultFlight(scenario_of("px4"), SEED)
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
