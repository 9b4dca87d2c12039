"""Faults beside the vehicle and on the way home end as they should, on ground truth: part of `scenarios faults`."""

import pytest

from companion.situation.phases import Phase
from scenarios.config import FIRMWARES
from scenarios.faults.matrix import IN_SORTIES_ONLY, Case, Fault
from scenarios.faults.sortie_matrix import EXPECTED_IN_SORTIE, SORTIE_FAULTS, SORTIE_PHASES
from scenarios.faults.trial import fly_case


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
