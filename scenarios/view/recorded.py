"""A recording as the view shows it: its states, 20 a second, and where among them the playback is."""

import heapq
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from companion.recording.folder import STEM as COMPANION
from companion.recording.records import InputKind
from link.errors import UserError
from link.messages import PadGeometry
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import fields_of
from link.program.toml_config import parse_toml, validate
from link.recording.file_names import EYES_STEM
from link.recording.mcap_reader import Recorded, read_head, read_messages, recording_files
from link.records import replace
from link.units import NS_PER_S
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.recordings.truth_file import STEM as TRUTH
from scenarios.view.history import History
from scenarios.view.state import StateReader, ViewState

_PERIOD_NS = 50_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Road:
    """Which scenario and seed the vehicle's road is of."""

    scenario: Scenario
    seed: int


class RecordedSource:
    """A recording that plays.

    Args:
        path: a folder with a companion's recording, and the truth and the detector's where there are such; or one file.

    Attributes:
        history: of the whole recording.
        road: None where the recording does not tell.
        position_s: of the playback, since the beginning.
        playing: whether it moves on.
        rate: recorded seconds a second.

    Raises:
        UserError: there is no recording, or nothing in it that could be shown.
    """

    def __init__(self, path: Path) -> None:
        companion, truth, eyes = _files(path)
        keys = read_head(companion[0]).keys if companion else Keys()
        self.road = _road(truth)
        self.history = History()
        self._states: list[ViewState] = []  # one for each row
        for state in _states(_merge(companion, truth, eyes), keys, self._pad()):
            self._add(state)
        if not self._states:
            raise UserError(f"{path}: the recording holds no motion of a drone")
        self.position_s = 0.0
        self.playing = False
        self.rate = 1.0
        self._last_s: float | None = None

    def _add(self, state: ViewState) -> None:
        before = self.history.start_ns, len(self.history.times_s)
        self.history.add(state)
        if self.history.start_ns != before[0]:
            self._states.clear()
        if (self.history.start_ns, len(self.history.times_s)) != before:
            self._states.append(state)

    @property
    def duration_s(self) -> float:
        """Of the whole recording."""
        return self.history.times_s[-1]

    @property
    def shown(self) -> int:
        """How many rows of the history are in the past."""
        return max(bisect_right(self.history.times_s, self.position_s), 1)

    def advance(self, now_s: float) -> ViewState:
        """Move on by the wall time since the last call, and return the state there."""
        if self._last_s is not None and self.playing:
            self.position_s = min(self.position_s + self.rate * (now_s - self._last_s), self.duration_s)
            self.playing = self.position_s < self.duration_s
        self._last_s = now_s
        return self._states[self.shown - 1]

    def _pad(self) -> PadGeometry | None:
        return None if self.road is None else self.road.scenario.vehicle.pad


def _files(path: Path) -> tuple[list[Path], list[Path], list[Path]]:
    """Return the files of the companion's recording, of the truth, and of the detector's."""
    if path.is_file():
        return ([], [path], []) if path.name.startswith(TRUTH) else ([path], [], [])
    if not path.is_dir():
        raise UserError(f"{path}: there is no such folder or file; give a run's folder or an MCAP file")
    truth, eyes = (sorted(path.glob(f"{stem}_*.mcap")) for stem in (TRUTH, EYES_STEM))
    return recording_files(path, COMPANION), truth, eyes


def _road(truth: list[Path]) -> Road | None:
    if not truth:
        return None
    head = read_head(truth[0])
    if "scenario.toml" not in head.attachments or "seed" not in head.metadata:
        return None
    table = parse_toml(head.attachment("scenario.toml"), f"scenario.toml of {head.path}")
    return Road(seed=head.number("seed", 0), scenario=validate(Scenario, table, source="scenario.toml"))


def _merge(*recordings: list[Path]) -> Iterator[Recorded]:
    """Return the messages in the order of their times, read as they are asked for: an hour of them is 1 GB."""
    return heapq.merge(*map(read_messages, recordings), key=lambda recorded: recorded.log_ns)


def _states(messages: Iterable[Recorded], keys: Keys, pad: PadGeometry | None) -> Iterator[ViewState]:
    """Return the states in steps of the period; only the newest message of a topic in each is read."""
    reader, state = StateReader(keys), ViewState(pad=pad)
    newest: dict[str, bytes] = {}
    due_ns: int | None = None
    for recorded in messages:
        message = recorded.message
        due_ns = recorded.log_ns + _PERIOD_NS if due_ns is None else due_ns
        if not -NS_PER_S <= recorded.log_ns - due_ns < 0:  # the clock was set back, or it is time
            state = _all_taken(reader, state, newest)
            newest.clear()
            due_ns += _PERIOD_NS * (1 + (recorded.log_ns - due_ns) // _PERIOD_NS)
            yield state
        if message.topic in reader.topics:
            newest[message.topic] = message.payload
        elif message.topic == keys.record("input") and state.pad is None:
            state = replace(state, pad=_read_pad(message.payload, message.type_name))
    yield _all_taken(reader, state, newest)


def _all_taken(reader: StateReader, state: ViewState, newest: dict[str, bytes]) -> ViewState:
    for topic, payload in newest.items():
        try:
            state = reader.taken(state, topic, payload)
        except PayloadError:
            continue
    return state


def _read_pad(payload: bytes, type_name: str) -> PadGeometry | None:
    """Return the vehicle's description of its pad when this input is it."""
    try:
        fields = fields_of(payload, type_name)
        if fields["kind"] != InputKind.PAD:
            return None
        return json_messages.decode(PadGeometry, bytes(fields["data"]))
    except (PayloadError, KeyError, TypeError):
        return None
