"""Injected failures: a battery that is empty, motors that stand still.

Source: MAV_CMD_INJECT_FAILURE; which units answer: as PX4 was seen to do it.
"""

from dataclasses import dataclass

from link.mavlink.dialect import mavlink
from link.records import replace
from sim_autopilot.plant.plant import PlantMemory

_OK = int(mavlink.FAILURE_TYPE_OK)
_OFF = int(mavlink.FAILURE_TYPE_OFF)
_WRONG = int(mavlink.FAILURE_TYPE_WRONG)
_BATTERY = int(mavlink.FAILURE_UNIT_SYSTEM_BATTERY)
_MOTOR = int(mavlink.FAILURE_UNIT_SYSTEM_MOTOR)
_MOTORS = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Failures:
    """What has failed; motors by index from 0."""

    battery: bool = False
    motors: frozenset[int] = frozenset()


NO_FAILURES = Failures()


def inject(failures: Failures, unit: int, kind: int, instance: int) -> Failures | None:
    """Return the failures after an injection, None for one that is not simulated; instance 0 is all of a unit.

    What a motor tells wrongly of itself changes nothing here: nobody reads it.
    """
    if (unit, kind) == (_MOTOR, _WRONG) and 0 <= instance <= _MOTORS:
        return failures
    if kind not in {_OK, _OFF} or not 0 <= instance <= _MOTORS:
        return None
    if unit == _BATTERY:
        return replace(failures, battery=kind == _OFF)
    if unit != _MOTOR:
        return None
    chosen = frozenset(range(_MOTORS)) if instance == 0 else frozenset({instance - 1})
    return replace(failures, motors=failures.motors | chosen if kind == _OFF else failures.motors - chosen)


def is_refused(unit: int, kind: int) -> bool:
    """Return whether an injection that is not simulated is answered, as unsupported: motors always are."""
    return unit == _MOTOR or (unit == _BATTERY and kind in {_OK, _OFF})


def stop_failed(plant: PlantMemory, failures: Failures) -> PlantMemory:
    """Return the drone with its failed motors at rest."""
    if not failures.motors:
        return plant
    speeds = plant.state.rotor_speed_rad_s.copy()
    speeds[list(failures.motors)] = 0.0
    return replace(plant, state=replace(plant.state, rotor_speed_rad_s=speeds))
