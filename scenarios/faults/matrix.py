"""What goes wrong in which phase of a landing, and how that should end with each firmware."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from companion.situation.phases import Phase
from scenarios.config import FIRMWARES, FirmwareName
from scenarios.scoring.score import Tier

PHASES = (
    Phase.TAKEOFF,
    Phase.WAITING,
    Phase.CHASE,
    Phase.ALIGN,
    Phase.DESCEND,
    Phase.TOUCHDOWN,
    Phase.ABORT,
    Phase.HOLD,
)


class Fault(Enum):
    """What goes wrong."""

    PILOT = "pilot changes mode"
    RESTART = "autopilot restarts"
    SILENT = "link silent for 2 s"
    LOST = "link silent for good"
    ORIGIN = "origin moved"
    ESTIMATE = "estimator reset"
    PARAMETER = "speed limit lowered"
    VEHICLE = "vehicle's data stop"
    VEHICLE_KILLED = "vehicle's program killed"
    VEHICLE_STOPPED_SHORTLY = "vehicle's program stopped for 0.5 s"
    VEHICLE_STOPPED = "vehicle's program stopped for 2 s"
    VEHICLE_STOPPED_LONG = "vehicle's program stopped for 10 s"
    ROUTER = "Zenoh router gone for 3 s"
    CLOCK_AHEAD = "vehicle's clock set an hour ahead"
    CLOCK_BACK = "vehicle's clock set an hour back"
    STAMPS = "vehicle's stamps 60 ms early, drifting"
    SLIDE = "vehicle's fixes slide by 0.2 m/s"
    SPOILT = "1 % of frames corrupt, 1 % cut"
    SECOND_COMPANION = "second companion for the drone"
    SECOND_DRONE = "another drone was first on the vehicle"
    COMPANION = "companion killed and restarted"
    COMPANION_STOPPED_SHORTLY = "companion stopped for 0.5 s"
    COMPANION_STOPPED = "companion stopped for 2 s"
    COMPANION_STOPPED_LONG = "companion stopped for 10 s"
    BATTERY = "battery low"
    BRAKE = "vehicle brakes hard"
    COARSE = "vehicle's fixes become coarse"
    RIVAL = "another companion was first for the drone"
    WORLD_STOPPED = "autopilot and vehicle stopped for 2 s"
    DISK_FULL = "disk full"


IN_SORTIES_ONLY = frozenset({Fault.BATTERY, Fault.BRAKE, Fault.COARSE, Fault.RIVAL})
"""In the phases of a landing they have tests of their own."""

OVER_WIRE_ONLY = frozenset({Fault.WORLD_STOPPED, Fault.DISK_FULL})
"""They take processes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A fault in a phase, with a firmware."""

    fault: Fault
    phase: Phase
    firmware: FirmwareName = "px4"


class End(Enum):
    """Where the drone truly is in the end."""

    HOVERS = "hovers"  # clear of everything, upright and steady, and has touched nothing
    LANDED = "landed"  # on the pad, at least as gently as S1 asks, and still armed at worst
    FALLEN = "fallen"  # its motors stand still: in the air they were stopped by the fault itself


@dataclass(frozen=True, slots=True, kw_only=True)
class Expected:
    """How a flight may end: the companion's phase, and the drone on ground truth."""

    phase: Phase
    ends: frozenset[End]

    def allows(self, tier: Tier, *, motors_off: bool) -> bool:
        """Return whether a flight of `tier` that ended with the motors on or off is one of the ends."""
        return any(_is_end(end, tier, motors_off=motors_off) for end in self.ends)


def _is_end(end: End, tier: Tier, *, motors_off: bool) -> bool:
    match end:
        case End.HOVERS:
            return tier is Tier.ABORT and not motors_off
        case End.LANDED:
            return tier in {Tier.S1, Tier.S2, Tier.S3}
        case End.FALLEN:
            return motors_off


def expect(phase: Phase, *ends: End) -> Expected:
    """Return that a flight may end in `phase`, and the drone so."""
    return Expected(phase=phase, ends=frozenset(ends))


_LANDS = expect(Phase.SECURED, End.LANDED)
_HOLDS = expect(Phase.HOLD, End.HOVERS)
_WAITS = expect(Phase.WAITING, End.HOVERS)
_IS_OUT = expect(Phase.PILOT, End.HOVERS)
_IS_OUT_ON_PAD = expect(Phase.PILOT, End.LANDED)
_IS_IDLE = expect(Phase.IDLE, End.HOVERS)
_IS_IDLE_ON_PAD = expect(Phase.IDLE, End.LANDED)
_FALLS = expect(Phase.PILOT, End.FALLEN)

_BEFORE = (Phase.TAKEOFF, Phase.WAITING)
_APPROACH = (Phase.CHASE, Phase.ALIGN, Phase.DESCEND)
_BROKEN_OFF = (Phase.ABORT, Phase.HOLD)  # by an operator, so that nothing is tried again
_IN_THE_AIR = (*_BEFORE, *_APPROACH, *_BROKEN_OFF)
_ON_THE_PAD = (Phase.TOUCHDOWN,)

_Rows = dict[Case, Expected]


def _rows(firmware: FirmwareName, fault: Fault, *parts: tuple[tuple[Phase, ...], Expected]) -> _Rows:
    return {
        Case(fault=fault, phase=phase, firmware=firmware): expected for phases, expected in parts for phase in phases
    }


_GOES_ON: tuple[tuple[tuple[Phase, ...], Expected], ...] = (
    ((*_BEFORE, *_APPROACH, *_ON_THE_PAD), _LANDS),
    (_BROKEN_OFF, _HOLDS),
)


def _matrix(firmware: FirmwareName) -> _Rows:
    """Return all rows of a firmware.

    A silence of 2 s ends nothing with either: PX4 is set to wait for 3 s, and ArduCopter, which stops after 1 s, waits
    in the mode that follows setpoints. Stamps that jump by 60 ms are a clock that was set: where nothing sees the pad,
    0.3 m at 5 m/s. ArduCopter takes a new speed limit as it enters the mode, so a descent that has begun goes on.
    """
    breaks_off = ((_BEFORE, _WAITS), (_APPROACH, _HOLDS), (_ON_THE_PAD, _LANDS), (_BROKEN_OFF, _HOLDS))
    slides = (((*_BEFORE, *_APPROACH, *_BROKEN_OFF), _HOLDS), (_ON_THE_PAD, _LANDS))
    lets_go = ((_IN_THE_AIR, _IS_OUT), (_ON_THE_PAD, _IS_OUT_ON_PAD))
    return {
        **_rows(firmware, Fault.PILOT, *lets_go),
        **_rows(firmware, Fault.RESTART, (_IN_THE_AIR, _FALLS), (_ON_THE_PAD, _LANDS)),
        **_rows(firmware, Fault.SILENT, *_GOES_ON),
        **_rows(firmware, Fault.COMPANION_STOPPED, *_GOES_ON),
        **_rows(firmware, Fault.LOST, *lets_go),
        **_rows(firmware, Fault.ORIGIN, *_GOES_ON),
        **_rows(firmware, Fault.ESTIMATE, *_GOES_ON),
        **_rows(firmware, Fault.PARAMETER, *breaks_off),
        **(_rows(firmware, Fault.PARAMETER, ((Phase.DESCEND,), _LANDS)) if firmware == "ardupilot" else {}),
        **_rows(firmware, Fault.COMPANION_STOPPED_SHORTLY, *_GOES_ON),
        **_rows(firmware, Fault.COMPANION_STOPPED_LONG, *lets_go),
        **_rows(firmware, Fault.VEHICLE, *breaks_off),
        **_rows(firmware, Fault.VEHICLE_KILLED, *breaks_off),
        **_rows(firmware, Fault.VEHICLE_STOPPED_SHORTLY, *_GOES_ON),
        **_rows(firmware, Fault.VEHICLE_STOPPED, *_GOES_ON),
        **_rows(firmware, Fault.VEHICLE_STOPPED_LONG, (_BEFORE, _LANDS), *breaks_off[1:]),
        **_rows(firmware, Fault.ROUTER, *_GOES_ON),
        **_rows(firmware, Fault.CLOCK_AHEAD, *breaks_off),
        **_rows(firmware, Fault.CLOCK_BACK, *breaks_off),
        **_rows(firmware, Fault.STAMPS, *breaks_off),
        **_rows(firmware, Fault.SLIDE, *slides),
        **_rows(firmware, Fault.SPOILT, *_GOES_ON),
        **_rows(firmware, Fault.SECOND_COMPANION, *_GOES_ON),
        **_rows(firmware, Fault.SECOND_DRONE, *breaks_off),
        **_rows(firmware, Fault.COMPANION, (_IN_THE_AIR, _IS_IDLE), (_ON_THE_PAD, _IS_IDLE_ON_PAD)),
    }


EXPECTED: Mapping[Case, Expected] = {
    case: expected for firmware in FIRMWARES for case, expected in _matrix(firmware).items()
}
"""How each case should end."""

EXPECTED_OVER_WIRE: Mapping[Case, Expected] = {
    case: expected
    for firmware in FIRMWARES
    for fault in sorted(OVER_WIRE_ONLY, key=lambda one: one.name)
    for case, expected in _rows(firmware, fault, *_GOES_ON).items()
}
"""How each case of `OVER_WIRE_ONLY` should end; an autopilot that stood still finds the setpoints of that time."""
