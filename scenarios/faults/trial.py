"""One case of the fault matrix, flown until it is over, in lockstep or over the wire.

Judged on ground truth and by what goes over the link, never by what the companion believes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import acos, hypot
from pathlib import Path
from tempfile import TemporaryDirectory

from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import FirmwareName, Scenario
from scenarios.faults.flight import FaultFlight
from scenarios.faults.injection import inject, inject_in_sortie
from scenarios.faults.matrix import EXPECTED, EXPECTED_OVER_WIRE, Case, Fault
from scenarios.faults.sortie_flight import SortieFaultFlight
from scenarios.faults.sortie_matrix import EXPECTED_IN_SORTIE, SORTIE_PHASES
from scenarios.faults.wire_flight import WireFlight
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier

SCENARIO = "straight_5"
_BRAKES = "brake_7"
SEED = 1
_AIRBORNE_M = 2.0  # of the drone above the road: a take-off that is under way, high enough to hover there
_DELAY_S: Mapping[Phase, float] = {Phase.TAKEOFF: 0.0, Phase.TOUCHDOWN: 0.0}  # the latter: before the motors stop
_SHORT_S = 0.3
_LIMIT_S = 40.0  # an approach that is broken off once, and the next one
_DECIDED_S = 4.0  # a phase that is kept for so long is the one it ends in; the autopilot's time-out is 3 s at most
_AT_REST_S = 1.5
_AT_REST_M_S = 0.3
_TO_REST_S = 15.0
_MOTORS_OFF_RAD_S = 50.0
_TAKEN_S = 0.2  # for the companion to hear that it is out
_OUT = frozenset({Phase.PILOT, Phase.IDLE})
_LASTING = _OUT | {Phase.SECURED, Phase.HOLD, Phase.FOLLOW, Phase.RALLY}
_ALL_EXPECTED = {**EXPECTED, **EXPECTED_IN_SORTIE, **EXPECTED_OVER_WIRE}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """How a flight did end.

    Attributes:
        case: what went wrong.
        phase: of the companion, in the end.
        reason: of it, as it was told.
        tier: on ground truth.
        judged: why.
        motors_off: in the end, on ground truth.
        tilt_max_rad: largest tilt of the drone since the fault.
        setpoints: that were sent although the companion was out, or by one that should have stayed out.
        taken_back: the autopilot followed setpoints again although the companion was out.
    """

    case: Case
    phase: Phase
    reason: str
    tier: Tier
    judged: str
    motors_off: bool
    tilt_max_rad: float
    setpoints: int
    taken_back: bool

    @property
    def is_right(self) -> bool:
        """Whether it is what is expected, and nobody was fought with."""
        expected = _ALL_EXPECTED[self.case]
        ended_right = self.phase is expected.phase and expected.allows(self.tier, motors_off=self.motors_off)
        return ended_right and not (self.setpoints or self.taken_back)


def scenario_of(firmware: FirmwareName, name: str = SCENARIO) -> Scenario:
    """Return what is flown with `firmware`."""
    return load_scenario(name).model_copy(update={"firmware": firmware})


def fly_case(case: Case) -> Ended:
    """Fly until the case is over, in lockstep."""
    if case.phase in SORTIE_PHASES:
        return _fly_sortie(case)
    flight = FaultFlight(scenario_of(case.firmware), SEED)
    flight.fly_to(case.phase)
    return _fly_on(flight, case, lambda: inject(case.fault, flight))


def _fly_sortie(case: Case) -> Ended:
    name = _BRAKES if case.fault is Fault.BRAKE else SCENARIO
    flight = SortieFaultFlight(scenario_of(case.firmware, name), SEED)
    flight.fly_to(case.phase)
    return _fly_on(flight, case, lambda: inject_in_sortie(case.fault, flight))


def fly_case_over_wire(case: Case) -> Ended:
    """Fly until the case is over, with real programs; its fault is one of `WIRE_FAULTS`."""
    with TemporaryDirectory() as folder, WireFlight(scenario_of(case.firmware), SEED, Path(folder)) as flight:
        flight.fly_to(case.phase)
        return _fly_on(flight, case, lambda: flight.inject(case.fault))


def _fly_on(flight: FaultFlight | WireFlight, case: Case, fail: Callable[[], float]) -> Ended:
    """Let the case's fault happen in a flight that has just come to its phase, and fly until it is over."""
    while case.phase is Phase.TAKEOFF and flight.height_m < _AIRBORNE_M:
        flight.step()
    flight.fly(_DELAY_S.get(case.phase, _SHORT_S))
    began = len(flight.recording.drone)
    setpoints, taken_back = _fly_until_decided(flight, fail())
    _fly_to_rest(flight)
    score = score_run(flight.scenario, SEED, flight.recording)
    return Ended(
        case=case,
        phase=flight.phase,
        reason=flight.recording.statuses[-1].reason,
        tier=score.tier,
        judged=score.reason,
        motors_off=_are_motors_off(flight),
        tilt_max_rad=max(acos(_upright(one.orientation_wxyz)) for one in flight.recording.drone[began:]),
        setpoints=setpoints + flight.uninvited,
        taken_back=taken_back,
    )


def lost(case: Case, why: str) -> Ended:
    """Return what stands for a case whose process ended."""
    return Ended(
        case=case,
        phase=Phase.IDLE,
        reason=why,
        tier=Tier.UNSAFE,
        judged=why,
        motors_off=False,
        tilt_max_rad=0.0,
        setpoints=0,
        taken_back=True,
    )


def _fly_until_decided(flight: FaultFlight | WireFlight, lasts_s: float) -> tuple[int, bool]:
    """Go on until a lasting phase has been kept since a fault that lasts for `lasts_s`.

    Return the setpoints that were sent, and whether they were flown, when the companion was out.
    """
    phase, since_s, sent = flight.phase, flight.recording.elapsed_s + lasts_s, flight.setpoints
    end_s, has_left, left_meanwhile, taken_back = since_s + _LIMIT_S, False, False, False
    while (now_s := flight.recording.elapsed_s) < end_s:
        flight.step()
        if flight.companion_is_stopped:
            left_meanwhile = not flight.follows_setpoints
            continue
        if flight.phase is not phase:
            phase, since_s, has_left = flight.phase, max(now_s, since_s), left_meanwhile
        if phase in _OUT and (left_meanwhile or now_s - since_s >= _TAKEN_S):
            has_left = has_left or not flight.follows_setpoints
            taken_back = taken_back or (has_left and flight.follows_setpoints)
        elif not left_meanwhile:
            sent = flight.setpoints
        if phase in _LASTING and now_s - since_s > _DECIDED_S:
            break
    return flight.setpoints - sent if phase in _OUT else 0, taken_back


def _fly_to_rest(flight: FaultFlight | WireFlight) -> None:
    """Go on until the drone hovers or its motors stand still, for what the autopilot does by itself takes its time."""
    now_s = flight.recording.elapsed_s
    end_s, moved_s = now_s + _TO_REST_S, now_s
    while flight.recording.elapsed_s < end_s and flight.recording.elapsed_s - moved_s < _AT_REST_S:
        flight.step()
        if hypot(*flight.recording.drone[-1].velocity_flu_m_s) > _AT_REST_M_S and not _are_motors_off(flight):
            moved_s = flight.recording.elapsed_s


def _are_motors_off(flight: FaultFlight | WireFlight) -> bool:
    return max(flight.recording.rotors[-1].speed_rad_s) < _MOTORS_OFF_RAD_S


def _upright(q: tuple[float, float, float, float]) -> float:
    """Return the cosine of the tilt of an orientation."""
    _, x, y, _ = q
    return max(-1.0, min(1.0, 1.0 - 2.0 * (x * x + y * y)))
