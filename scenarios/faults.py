"""What goes wrong in which phase of a landing, and how that should end: the faults, what is expected, and a flight.

Each flight is judged on ground truth and by what goes over the link, never by what the companion believes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

from companion.phases import Phase
from link.mavlink.dialect import Message, mavlink
from scenarios.catalogue import load_scenario
from scenarios.fault_flight import FaultFlight
from scenarios.outcome import scored
from scenarios.score import Tier

SCENARIO = "straight_5"
SEED = 1
_POSITION_MODE = 3.0  # PX4's main mode
_ORIGIN_MOVED_ENU_M = (30.0, -20.0, 4.0)
_ESTIMATE_RESET_ENU_M = (3.0, -2.0, 1.0)
_SPEED_LIMIT_M_S = 4.0  # less than the vehicle's
_SILENT_S = 2.0
_DELAY_S: Mapping[Phase, float] = {Phase.TAKEOFF: 4.0, Phase.TOUCHDOWN: 0.0}  # off the ground; before motors stop
_SHORT_S = 0.3
_DECIDED_S = 4.0  # a phase that is kept for so long is the one it ends in; the autopilot's time-out is 3 s
_LIMIT_S = 25.0
_TAKEN_S = 0.2  # for the companion to hear that it is out
_OUT = frozenset({Phase.PILOT, Phase.IDLE})
_LASTING = _OUT | {Phase.SECURED, Phase.HOLD}

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
    COMPANION = "companion killed and restarted"


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A fault in a phase."""

    fault: Fault
    phase: Phase


@dataclass(frozen=True, slots=True, kw_only=True)
class Expected:
    """How a flight may end: the companion's phase, and what it is worth; no tiers where others decide on that."""

    phases: frozenset[Phase]
    tiers: frozenset[Tier] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """How a flight did end.

    Attributes:
        case: what went wrong.
        phase: of the companion, in the end.
        reason: of it, as it was told.
        tier: on ground truth.
        judged: why.
        setpoints: that were sent although the companion was out.
        taken_back: the autopilot followed setpoints again although the companion was out.
    """

    case: Case
    phase: Phase
    reason: str
    tier: Tier
    judged: str
    setpoints: int
    taken_back: bool

    @property
    def is_right(self) -> bool:
        """Whether it is what is expected, and nobody was fought with."""
        expected = EXPECTED[self.case]
        scored_right = not expected.tiers or self.tier in expected.tiers
        return self.phase in expected.phases and scored_right and not (self.setpoints or self.taken_back)


def fly_case(case: Case) -> Ended:
    """Fly until it is decided how the case ends."""
    flight = FaultFlight(load_scenario(SCENARIO), SEED)
    flight.fly_to(case.phase)
    return fly_on(flight, case)


def fly_on(flight: FaultFlight, case: Case) -> Ended:
    """Let the case's fault happen in a flight that has just come to its phase, and fly until it is decided."""
    flight.fly(_DELAY_S.get(case.phase, _SHORT_S))
    _INJECT[case.fault](flight)
    setpoints, taken_back = _fly_until_decided(flight)
    score = scored(flight.scenario, SEED, flight.recording)
    return Ended(
        case=case,
        phase=flight.phase,
        reason=flight.recording.statuses[-1].reason,
        tier=score.tier,
        judged=score.reason,
        setpoints=setpoints,
        taken_back=taken_back,
    )


def lost(case: Case, why: str) -> Ended:
    """Return what stands for a case whose process ended."""
    return Ended(case=case, phase=Phase.IDLE, reason=why, tier=Tier.UNSAFE, judged=why, setpoints=0, taken_back=True)


def _fly_until_decided(flight: FaultFlight) -> tuple[int, bool]:
    """Go on until a lasting phase has been kept; return the setpoints sent and whether they were flown when out."""
    end_s = flight.recording.elapsed_s + _LIMIT_S
    phase, since_s, sent, has_left, taken_back = (
        flight.phase,
        flight.recording.elapsed_s,
        flight.setpoints,
        False,
        False,
    )
    while (now_s := flight.recording.elapsed_s) < end_s:
        flight.step()
        if flight.phase is not phase:
            phase, since_s, has_left = flight.phase, now_s, False
        if phase not in _OUT or now_s - since_s < _TAKEN_S:
            sent = flight.setpoints
        else:
            has_left = has_left or not flight.follows_setpoints
            taken_back = taken_back or (has_left and flight.follows_setpoints)
        if phase in _LASTING and now_s - since_s > _DECIDED_S:
            break
    return flight.setpoints - sent, taken_back


def _command(number: int, *parameters: float) -> Message:
    return mavlink.MAVLink_command_long_message(1, 1, number, 0, *(*parameters, *[0.0] * (7 - len(parameters))))


def _change_mode(flight: FaultFlight) -> None:
    flight.tell(_command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, _POSITION_MODE))


def _lower_speed_limit(flight: FaultFlight) -> None:
    kind = mavlink.MAV_PARAM_TYPE_REAL32
    flight.tell(mavlink.MAVLink_param_set_message(1, 1, b"MPC_XY_VEL_MAX", _SPEED_LIMIT_M_S, kind))


def _silence_vehicle(flight: FaultFlight) -> None:
    flight.vehicle_is_silent = True


_INJECT: Mapping[Fault, Callable[[FaultFlight], None]] = {
    Fault.PILOT: _change_mode,
    Fault.RESTART: lambda flight: flight.simulation.autopilot.restart(),
    Fault.SILENT: lambda flight: flight.cut_link(_SILENT_S),
    Fault.LOST: lambda flight: flight.cut_link(),
    Fault.ORIGIN: lambda flight: flight.set_origin(_ORIGIN_MOVED_ENU_M),
    Fault.ESTIMATE: lambda flight: flight.simulation.autopilot.reset_estimator(_ESTIMATE_RESET_ENU_M),
    Fault.PARAMETER: _lower_speed_limit,
    Fault.VEHICLE: _silence_vehicle,
    Fault.COMPANION: lambda flight: flight.restart_companion(),
}

_LANDS = Expected(phases=frozenset({Phase.SECURED}), tiers=frozenset({Tier.S3, Tier.S2, Tier.S1}))
_AIRBORNE = frozenset({Tier.ABORT})
_HOLDS = Expected(phases=frozenset({Phase.HOLD}), tiers=_AIRBORNE)
_WAITS = Expected(phases=frozenset({Phase.WAITING}), tiers=_AIRBORNE)
_IS_OUT = Expected(phases=frozenset({Phase.PILOT}), tiers=_AIRBORNE)
_IS_IDLE = Expected(phases=frozenset({Phase.IDLE}), tiers=_AIRBORNE)
_FALLS = Expected(phases=frozenset({Phase.PILOT}))  # its motors stand still
_LETS_GO = {phase: Expected(phases=frozenset({phase})) for phase in _OUT}  # what follows is the autopilot's alone
_CHASES_ON = Expected(phases=frozenset({Phase.CHASE, Phase.HOLD}), tiers=_AIRBORNE)  # until the chase's time limit

_APPROACH = (Phase.CHASE, Phase.ALIGN, Phase.DESCEND)
_BEFORE = (Phase.TAKEOFF, Phase.WAITING)
_BROKEN_OFF = (Phase.ABORT, Phase.HOLD)  # by an operator, so that nothing is tried again


def _rows(fault: Fault, *parts: tuple[tuple[Phase, ...], Expected]) -> dict[Case, Expected]:
    return {Case(fault=fault, phase=phase): expected for phases, expected in parts for phase in phases}


_HOVERS = (*_BEFORE, Phase.HOLD)
_IN_THE_AIR = (*_BEFORE, *_APPROACH, *_BROKEN_OFF)
_ON_THE_PAD = (Phase.TOUCHDOWN,)
_LANDS_OR_HOLDS = ((*_BEFORE, *_APPROACH, *_ON_THE_PAD), _LANDS), (_BROKEN_OFF, _HOLDS)

_BY_AUTOPILOT = (*_APPROACH, Phase.TOUCHDOWN, Phase.ABORT)  # where it holds on to a setpoint that moved

EXPECTED: Mapping[Case, Expected] = {
    **_rows(Fault.PILOT, (_IN_THE_AIR, _IS_OUT), (_ON_THE_PAD, _LETS_GO[Phase.PILOT])),
    **_rows(Fault.RESTART, (_IN_THE_AIR, _FALLS), (_ON_THE_PAD, _LANDS)),
    **_rows(Fault.SILENT, *_LANDS_OR_HOLDS),
    **_rows(Fault.LOST, (_HOVERS, _IS_OUT), (_BY_AUTOPILOT, _LETS_GO[Phase.PILOT])),
    **_rows(Fault.ORIGIN, *_LANDS_OR_HOLDS),
    **_rows(Fault.ESTIMATE, *_LANDS_OR_HOLDS),
    **_rows(
        Fault.PARAMETER,
        (_BEFORE, _WAITS),
        ((Phase.CHASE, Phase.ALIGN), _CHASES_ON),
        ((Phase.DESCEND,), _HOLDS),
        (_ON_THE_PAD, _LANDS),
        (_BROKEN_OFF, _HOLDS),
    ),
    **_rows(Fault.VEHICLE, (_BEFORE, _WAITS), (_APPROACH, _HOLDS), (_ON_THE_PAD, _LANDS), (_BROKEN_OFF, _HOLDS)),
    **_rows(Fault.COMPANION, (_HOVERS, _IS_IDLE), (_BY_AUTOPILOT, _LETS_GO[Phase.IDLE])),
}
"""How each case should end."""
