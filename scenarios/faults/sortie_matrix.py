"""What goes wrong beside the vehicle and on the way home, and how that should end with each firmware."""

from collections.abc import Mapping

from companion.situation.phases import Phase
from scenarios.config import FIRMWARES
from scenarios.faults.matrix import Case, End, Expected, Fault, expect

SORTIE_PHASES = (Phase.FOLLOW, Phase.RETURN)
SORTIE_FAULTS = (
    Fault.PILOT,
    Fault.SILENT,
    Fault.LOST,
    Fault.VEHICLE_KILLED,
    Fault.COMPANION,
    Fault.BATTERY,
    Fault.BRAKE,
    Fault.COARSE,
    Fault.RIVAL,
    Fault.SECOND_DRONE,
)

_IS_OUT = expect(Phase.PILOT, End.HOVERS)
_HOLDS = expect(Phase.HOLD, End.HOVERS)
_LANDS = expect(Phase.SECURED, End.LANDED)
_LOOKS_FOR_VEHICLE = expect(Phase.RALLY, End.HOVERS)

_ALIKE: Mapping[Fault, Expected] = {
    Fault.PILOT: _IS_OUT,
    Fault.LOST: _IS_OUT,
    Fault.RIVAL: _IS_OUT,
    Fault.COMPANION: expect(Phase.IDLE, End.HOVERS),
    Fault.VEHICLE_KILLED: _LOOKS_FOR_VEHICLE,
    Fault.BATTERY: _LANDS,
}
"""Beside the vehicle as on the way home."""

_APART: Mapping[Fault, tuple[Expected, Expected]] = {
    Fault.SILENT: (expect(Phase.FOLLOW, End.HOVERS), _LANDS),
    Fault.BRAKE: (expect(Phase.FOLLOW, End.HOVERS), _LANDS),
    # Nothing here sees the pad, which fixes of metres do not place: beside the vehicle the drone stays farther out.
    Fault.COARSE: (expect(Phase.FOLLOW, End.HOVERS), _HOLDS),
    Fault.SECOND_DRONE: (expect(Phase.FOLLOW, End.HOVERS), expect(Phase.RETURN, End.HOVERS)),
}
"""Beside the vehicle, and on the way home."""


def _expected(fault: Fault, phase: Phase) -> Expected:
    return _ALIKE[fault] if fault in _ALIKE else _APART[fault][SORTIE_PHASES.index(phase)]


EXPECTED_IN_SORTIE: Mapping[Case, Expected] = {
    Case(fault=fault, phase=phase, firmware=firmware): _expected(fault, phase)
    for firmware in FIRMWARES
    for fault in SORTIE_FAULTS
    for phase in SORTIE_PHASES
}
"""How each case should end."""
