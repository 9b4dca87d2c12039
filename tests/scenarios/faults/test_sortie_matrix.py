"""Faults beside the vehicle and on the way home end as they should, on ground truth: part of `scenarios faults`."""

import pytest

from companion.situation.phases import Phase
from link.messages import Command
from scenarios.config import FIRMWARES
from scenarios.faults.matrix import IN_SORTIES_ONLY, Case, Fault
from scenarios.faults.sortie_flight import SortieFaultFlight
from scenarios.faults.sortie_matrix import EXPECTED_IN_SORTIE, SORTIE_FAULTS, SORTIE_PHASES
from scenarios.faults.trial import fly_case, scenario_of

_STOPPING_M = 2.0  # from a climb of 3 m/s, by 3 m/s^2 after half a second


def test_every_fault_of_a_sortie_has_an_expected_end_in_its_phases_with_each_firmware() -> None:
    everything = {
        Case(fault=fault, phase=phase, firmware=firmware)
        for fault in SORTIE_FAULTS
        for phase in SORTIE_PHASES
        for firmware in FIRMWARES
    }
    assert set(EXPECTED_IN_SORTIE) == everything
    assert set(SORTIE_FAULTS) >= IN_SORTIES_ONLY


@pytest.mark.slow  # 5 s idle: one that takes the drone all the way home
def test_drone_at_a_station_whose_battery_runs_low_comes_home() -> None:
    ended = fly_case(Case(fault=Fault.BATTERY, phase=Phase.FOLLOW))
    assert ended.is_right, ended


@pytest.mark.slow  # 4 s idle: a launch, and fixes that are wild for 20 s
@pytest.mark.parametrize("order", [None, Command.HOLD])
def test_drone_whose_vehicle_contradicts_itself_rises_only_by_what_clears_it(order: Command | None) -> None:
    flight = SortieFaultFlight(scenario_of("px4"), seed=1)
    flight.fly_to(Phase.FOLLOW)
    flight.lose_corrections(50.0, 50.0)
    while flight.phase is Phase.FOLLOW:
        flight.step()
    assert flight.phase is Phase.RALLY
    from_m = flight.height_m
    if order is not None:
        flight.companion.request(order)
    flight.fly(15.0)
    assert flight.height_m < from_m + flight.scenario.system.companion.chase.height_m + _STOPPING_M
