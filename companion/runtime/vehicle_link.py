"""What the vehicle sends, as measurements for the next step; what cannot be used is counted by its reason."""

from dataclasses import dataclass

from companion.autopilots.state import AutopilotState
from companion.config.companion import SilentVehicleConfig
from companion.core.data import Measurement
from companion.core.reasons import Cause, Reason, sentence
from companion.landing.state.step_data import VehicleInputs
from companion.runtime.sample_intake import SampleIntake
from companion.runtime.step_clock import StepClock
from companion.vehicle.inputs import measurements_of
from companion.vehicle.unit_watch import UnitWatch
from link.messages import CommandReply, PadGeometry
from link.payloads.checks import PayloadError
from link.payloads.json_messages import is_possible
from link.program.text import printable
from link.zenoh.keys import Keys

_RECENT_NS = 5_000_000_000
_AGAIN_NS = 10_000_000_000
_WORDS_MAX = 90  # of the reason of one refusal, which quotes what a peer sent


@dataclass(slots=True)
class _Kind:
    """One kind of refusal: how many, the words of the last one, when that came and when it was logged."""

    count: int
    words: str
    newest_ns: int
    told_count: int = 0
    told_ns: int | None = None

    def sentence(self, what: str) -> str:
        return f"{what}: {self.count} refused, {self.words}"


class Refusals:
    """Counts refused data. Times are of a clock that is never set.

    Attributes:
        total: of all of them.
    """

    def __init__(self) -> None:
        self.total = 0
        self._kinds: dict[tuple[str, str], _Kind] = {}

    def count(self, what: str, why: str, words: str, now_ns: int) -> None:
        """Count one.

        Args:
            what: came, such as `fix`.
            why: it is refused, the same for all refusals of its kind.
            words: for people, with this one's numbers.
            now_ns: monotonic.
        """
        self.total += 1
        kind = self._kinds.setdefault((what, why), _Kind(0, "", now_ns))
        kind.count, kind.words, kind.newest_ns = kind.count + 1, printable(words)[:_WORDS_MAX], now_ns

    def recent(self, now_ns: int) -> str:
        """Return what has been refused most in the last seconds, empty if nothing has."""
        found = [
            (kind.count, -len(what), kind.sentence(what))
            for (what, _), kind in self._kinds.items()
            if _is_recent(kind, now_ns)
        ]
        return max(found)[-1] if found else ""

    def has_recent(self, what: str, why: str, now_ns: int) -> bool:
        """Return whether one of a kind has been refused in the last seconds."""
        kind = self._kinds.get((what, why))
        return kind is not None and _is_recent(kind, now_ns)

    def news(self, now_ns: int) -> list[str]:
        """Return what is to be logged now: each kind at its first refusal, and again while its count rises."""
        lines: list[str] = []
        for (what, _), kind in self._kinds.items():
            is_due = kind.told_ns is None or now_ns - kind.told_ns >= _AGAIN_NS
            if is_due and kind.count > kind.told_count:
                kind.told_ns, kind.told_count = now_ns, kind.count
                lines.append(kind.sentence(what))
        return lines


def _is_recent(kind: _Kind, now_ns: int) -> bool:
    return now_ns - kind.newest_ns <= _RECENT_NS


_UNINVITED = "comes for a vehicle of which the configuration says that it tells nothing (silent_vehicle)"
_UNPLACED = "of a time at which the drone's place or attitude is not known; is the detector's clock right?"
_SIGHTING_UNPLACED = ("pad_pose", "unplaced")
_FUTURE_MAX_NS = 500_000_000  # a stamp farther ahead comes from a clock that is wrong


class VehicleLink:
    """Takes samples from Zenoh until the next step takes their measurements, the pad's description, and the token.

    Args:
        keys: of the Zenoh contract.
        clock: of the steps.
        silent: what is known of a vehicle that tells nothing, None for one that does.

    Attributes:
        refusals: what was refused, and why.
        pad: as the vehicle describes it, None before.
        is_pad_doubted: it describes another one now, until that one, or the one before again, is received.
        alive: the state of its liveliness token, None if it never had one.
    """

    def __init__(self, keys: Keys, clock: StepClock, silent: SilentVehicleConfig | None) -> None:
        self.pad: PadGeometry | None = None if silent is None else silent.pad
        self.is_pad_doubted = False
        self.alive: bool | None = None
        self.tells_nothing = silent is not None
        self.refusals = Refusals()
        self._keys = keys
        self._clock = clock
        self._unit = UnitWatch()
        self._doubted: frozenset[str] = frozenset()  # of what the unit tells
        self._has_doubted = False  # something more of it since the last step
        self._placed_ns: int | None = None  # when the newest sighting came whose time was one of the drone's
        self._received: list[tuple[str, list[Measurement]]] = []  # on which key, since the last step
        self._intake = SampleIntake()

    @property
    def knows_pad(self) -> bool:
        """Whether the vehicle has described its pad."""
        return self.pad is not None

    def receive(self, key: str, payload: bytes, state: AutopilotState) -> None:
        """Take a sample; what cannot be decoded or is absurd is counted and dropped.

        So is what somebody says of a vehicle that tells nothing.

        Args:
            key: that it was put on.
            payload: CDR.
            state: of the autopilot.
        """
        if self.tells_nothing and key != self._keys.pad_pose:
            self.refuse(key.rsplit("/", 1)[-1], "uninvited", _UNINVITED)
            return
        refusal = self._intake.refusal(key, payload, self._clock.monotonic_ns)
        if refusal is not None:
            self.refuse(key.rsplit("/", 1)[-1], *refusal)
            return
        try:
            measurements = measurements_of(key, payload, self._keys, state, self._unit)
        except PayloadError as error:
            self.refuse(key.rsplit("/", 1)[-1], "unreadable", str(error))
            return
        if key == self._keys.pad_pose and measurements:
            self._placed_ns = self._clock.monotonic_ns
        elif key == self._keys.pad_pose and state.history:
            self.refuse(*_SIGHTING_UNPLACED, _UNPLACED)
        if key == self._keys.imu:
            self._doubt_unit()
        self._received.append((key, measurements))

    def _doubt_unit(self) -> None:
        """Refuse what the inertial unit tells and is not believed."""
        doubts = self._unit.doubts()
        for what, why in doubts.items():
            self.refuse(what, "doubted", why)
        self._has_doubted |= not self._doubted.issuperset(doubts)
        self._doubted = frozenset(doubts)

    def receive_pad(self, pad: PadGeometry) -> bool:
        """Take the description of the pad; return whether it is one that can be."""
        if self.tells_nothing:
            self.refuse("pad", "uninvited", _UNINVITED)
            return False
        if not is_possible(pad):
            self.refuse("pad", "impossible", "no vehicle has such a pad")
            return False
        self.pad, self.is_pad_doubted = pad, False
        return True

    def receive_liveliness(self, *, alive: bool) -> None:
        """Take the state of the token; one that never was is not lost."""
        if alive or self.alive is not None:
            self.alive = alive

    def refuse(self, what: str, why: str, words: str) -> None:
        """Count what came and cannot be used; see `Refusals.count`."""
        self.refusals.count(what, why, words, self._clock.monotonic_ns)

    def refused_lately(self) -> str:
        """Return what was refused most in the last seconds, and why; empty if nothing was."""
        return self.refusals.recent(self._clock.monotonic_ns)

    def refuse_start(self) -> CommandReply:
        """Return the answer to a start for a vehicle that was never heard, with what was refused of it."""
        refused = self.refused_lately()
        why = Cause(Reason.VEHICLE_UNHEARD, (f" ({refused})" if refused else "",))
        return CommandReply(accepted=False, reason=sentence(why))

    def take(self, *, is_utc_known: bool) -> VehicleInputs:
        """Return what has come; the measurements, and by which a fix was ahead of its stamp, once.

        What comes from the future is counted and dropped, by the time of the step that takes it: what waited while the
        computer was held up is newer than the step before.

        Args:
            is_utc_known: before, a stamp ahead of the companion's own clock says nothing about who is wrong.
        """
        received, self._received = self._received, []
        has_doubted, self._has_doubted = self._has_doubted, False
        taken: list[Measurement] = []
        fix_ahead_s: float | None = None
        for key, measurements in received:
            ahead_ns = max((one.t_ns for one in measurements), default=0) - self._clock.t_ns
            if ahead_ns <= _FUTURE_MAX_NS:
                taken += measurements
            elif is_utc_known:
                self.refuse(key.rsplit("/", 1)[-1], "ahead", f"come {ahead_ns * 1e-9:.1f} s before their stamps")
                fix_ahead_s = ahead_ns * 1e-9 if key == self._keys.fix else fix_ahead_s
        return VehicleInputs(
            measurements=tuple(taken),
            fix_ahead_s=fix_ahead_s,
            has_doubted_unit=has_doubted,
            is_alive=self.alive,
            pad=self.pad,
            is_pad_doubted=self.is_pad_doubted,
            has_unplaced_sightings=self._are_sightings_unplaced(),
        )

    def _are_sightings_unplaced(self) -> bool:
        """Return whether sightings came lately and none could be placed: a link that was out has some of them lost."""
        now_ns = self._clock.monotonic_ns
        if self._placed_ns is not None and now_ns - self._placed_ns <= _RECENT_NS:
            return False
        return self.refusals.has_recent(*_SIGHTING_UNPLACED, now_ns)
