"""What a run leaves for the score: truth and the companion's status, and when there is nothing more to wait for."""

from dataclasses import dataclass, field

from companion.core.reasons import Reason
from companion.situation.phases import FLYING_PHASES, Phase
from link.messages import BodyTruth, LandingStatus, RotorTruth
from link.units import NS_PER_S
from scenarios.scoring.accuracy import EstimateError, Nis

_AFTER_MOTORS_OFF_NS = 2_500_000_000  # the score looks at the drone 2 s after
_AFTER_GIVING_UP_NS = 10_000_000_000  # for a drone that aborts to brake, and to be seen airborne and stable
_TO_BREAK_OFF_S = 30.0  # for a drone that is called off to climb away and stand
_GIVEN_UP = frozenset({Phase.HOLD.value, Phase.PILOT.value})
_FLYING = frozenset(phase.value for phase in FLYING_PHASES)
TIME_LIMIT = "time limit"


@dataclass(slots=True)
class Recording:
    """Samples in the order of their times.

    Attributes:
        drone: its truth.
        vehicle: its truth.
        rotors: of the drone.
        statuses: of the companion, as published.
        estimate_errors: of the companion's estimate of the vehicle, known in lockstep only.
        nis: of the companion's measurements of the vehicle, known in lockstep only.
    """

    drone: list[BodyTruth] = field(default_factory=list)
    vehicle: list[BodyTruth] = field(default_factory=list)
    rotors: list[RotorTruth] = field(default_factory=list)
    statuses: list[LandingStatus] = field(default_factory=list)
    estimate_errors: list[EstimateError] = field(default_factory=list)
    nis: Nis | None = None

    def add(self, sample: BodyTruth | RotorTruth | LandingStatus, *, is_drone: bool = True) -> None:
        """Append a sample; one that is not newer than the last of its kind is a repetition and is left out."""
        match sample:
            case BodyTruth():
                truths = self.drone if is_drone else self.vehicle
                if not truths or sample.t_ns > truths[-1].t_ns:
                    truths.append(sample)
            case RotorTruth():
                if not self.rotors or sample.t_ns > self.rotors[-1].t_ns:
                    self.rotors.append(sample)
            case LandingStatus():
                self.statuses.append(sample)

    @property
    def elapsed_s(self) -> float:
        """Simulated time since the drone's first sample."""
        return (self.drone[-1].t_ns - self.drone[0].t_ns) / NS_PER_S if self.drone else 0.0

    @property
    def status(self) -> LandingStatus | None:
        """The newest one."""
        return self.statuses[-1] if self.statuses else None

    def since(self, t_ns: int) -> "Recording":
        """Return what is recorded from `t_ns` on; without the errors of the estimate, which bear no time."""
        return Recording(
            drone=[one for one in self.drone if one.t_ns >= t_ns],
            vehicle=[one for one in self.vehicle if one.t_ns >= t_ns],
            rotors=[one for one in self.rotors if one.t_ns >= t_ns],
            statuses=[one for one in self.statuses if one.stamp_ns >= t_ns],
        )

    def status_at_end(self, ended: str) -> LandingStatus | None:
        """Return the status that says why a run ended: at its time limit, what was waited for before it was called off.

        Args:
            ended: as `EndWatch.reason` has it.
        """
        if ended != TIME_LIMIT:
            return self.status
        called_off = Reason.OPERATOR_ABORTS.name
        return next((one for one in reversed(self.statuses) if one.reason_code != called_off), self.status)

    def phase_times_s(self) -> dict[str, float]:
        """Return when each phase was first seen, in seconds since the drone's first sample."""
        times: dict[str, float] = {}
        for status in self.statuses:
            # Before the clocks are mapped a status bears the companion's own time.
            if status.stamp_ns >= self.drone[0].t_ns:
                times.setdefault(status.phase, (status.stamp_ns - self.drone[0].t_ns) / NS_PER_S)
        return times


class EndWatch:
    """Tells when a run is over, and before that when it has taken so long that the landing is to be called off.

    Args:
        time_limit_s: simulated time after which the landing is called off.
    """

    def __init__(self, time_limit_s: float) -> None:
        self._time_limit_s = time_limit_s
        self._has_flown = False
        self._over_ns: int | None = None
        self._over_phase = ""
        self._is_late = False

    def must_break_off(self, recording: Recording) -> bool:
        """Return once, at the time limit, whether an operator would now call the landing off."""
        if self._is_late or recording.elapsed_s < self._time_limit_s:
            return False
        self._is_late = True
        return True

    def reason(self, recording: Recording) -> str | None:
        """Return why the run is over, None while it goes on."""
        status = recording.status
        if status is not None and recording.drone:
            self._watch(status.phase, recording.drone[-1].t_ns)
            wait_ns = _AFTER_GIVING_UP_NS if self._over_phase in _GIVEN_UP else _AFTER_MOTORS_OFF_NS
            if self._over_ns is not None and recording.drone[-1].t_ns - self._over_ns >= wait_ns:
                return TIME_LIMIT if self._is_late else self._over_phase
        return TIME_LIMIT if recording.elapsed_s >= self._time_limit_s + _TO_BREAK_OFF_S else None

    def _watch(self, phase: str, t_ns: int) -> None:
        self._has_flown = self._has_flown or phase in _FLYING
        is_over = self._has_flown and (phase not in _FLYING or phase in _GIVEN_UP)
        if not is_over:
            self._over_ns = None
        elif self._over_ns is None or phase != self._over_phase:
            self._over_ns = t_ns
        self._over_phase = phase
