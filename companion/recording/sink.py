"""The end of a companion's recording: its records, as messages, with the times of a clock that knows UTC."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Protocol

from companion.config.descent import DescentConfig
from companion.recording.messages import LONG_EVERY, input_messages, link_message, step_messages, step_time_message
from companion.recording.records import InputRecord, LinkRecord, Record, StepRecord, StepTimeRecord, size_of
from companion.recording.scenes import scene_messages
from link.payloads.decklander_msgs import RosMessage
from link.zenoh.keys import Keys

_EARLY_MAX = 2_000  # inputs that wait for UTC to become known: about five seconds of them
_EARLY_BYTES_MAX = 20_000_000  # of what others sent among them: ten times what so many of a kilobyte take


class MessageStore(Protocol):
    """Where messages are kept."""

    def add(self, message: RosMessage, log_ns: int) -> None:
        """Add a message that was recorded at `log_ns`.

        Raises:
            OSError: it is not written.
        """

    def close(self) -> None:
        """Complete what was written.

        Raises:
            OSError: it is not complete.
        """


class MessageStores:
    """Several stores as one; what fails in one is told once the others have had it."""

    def __init__(self, stores: Sequence[MessageStore]) -> None:
        self._stores = stores

    def add(self, message: RosMessage, log_ns: int) -> None:
        """Add a message to all of them."""
        self._each([partial(store.add, message, log_ns) for store in self._stores])

    def close(self) -> None:
        """Complete all of them."""
        self._each([store.close for store in self._stores])

    def _each(self, calls: Sequence[Callable[[], None]]) -> None:
        failed: OSError | None = None
        for call in calls:
            try:
                call()
            except OSError as error:
                failed = error
        if failed is not None:
            raise failed


class CompanionSink:
    """Writes records of a `RecordingNode`.

    The first ones wait until the companion's clock is mapped to UTC, so that the whole recording stands in UTC.

    Args:
        store: of the messages.
        keys: of the Zenoh contract.
        descent: for the cone of the scene; None leaves the scene out.
    """

    def __init__(self, store: MessageStore, keys: Keys, descent: DescentConfig | None = None) -> None:
        self._store = store
        self._keys = keys
        self._descent = descent
        self._early: deque[Record] | None = deque()
        self._early_bytes = 0
        self._utc_from_local_ns = 0
        self._last_local_ns = 0
        self._steps = 0

    def write(self, record: Record) -> None:
        """Write one record.

        Raises:
            OSError: it is not written.
        """
        if isinstance(record, StepRecord):
            self._utc_from_local_ns = record.inputs.t_ns - record.local_ns
        if self._early is None:
            self._write(record)
            return
        self._early.append(record)
        self._early_bytes += size_of(record)
        is_full = len(self._early) >= _EARLY_MAX or self._early_bytes >= _EARLY_BYTES_MAX
        if is_full or (isinstance(record, StepRecord) and record.utc_known):
            self._write_early()

    def close(self) -> None:
        """Write what waits and complete the store.

        Raises:
            OSError: it is not complete.
        """
        self._write_early()
        self._store.close()

    def _write_early(self) -> None:
        early, self._early = self._early or deque(), None
        locals_ns = [record.local_ns for record in early if isinstance(record, InputRecord) and record.local_ns]
        self._last_local_ns = min(locals_ns, default=0)  # for what came before the loop first told the time
        for record in early:
            self._write(record)

    def _write(self, record: Record) -> None:
        match record:
            case InputRecord():
                self._last_local_ns = record.local_ns or self._last_local_ns
                self._add(input_messages(record, self._keys), self._last_local_ns + self._utc_from_local_ns)
            case StepRecord():
                is_long = self._steps % LONG_EVERY == 0
                self._steps += 1
                log_ns = record.local_ns + self._utc_from_local_ns
                self._add(step_messages(record, self._keys, long=is_long), log_ns)
                if self._descent is not None:
                    self._add(scene_messages(record, self._descent, self._keys, long=is_long), log_ns)
            case LinkRecord():
                self._add([link_message(record, self._keys)], self._last_local_ns + self._utc_from_local_ns)
            case StepTimeRecord():
                self._add([step_time_message(record, self._keys)], self._last_local_ns + self._utc_from_local_ns)

    def _add(self, messages: Iterable[RosMessage], log_ns: int) -> None:
        for message in messages:
            self._store.add(message, max(log_ns, 0))
