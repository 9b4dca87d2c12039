"""Recording beside a loop: records go into a bounded queue and a thread of its own writes them.

A slow or full disk costs records, which are counted, and never time of the loop's.
"""

import struct
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Protocol

_CAPACITY = 20_000  # half a minute of everything that a companion records
# Of what waits, as peers may send what is large: an SD card of 10 MB/s writes as much in the seconds that an end waits
# for it. As many records as may wait take less than half of it when they are of a kilobyte, which none of ours takes.
_BYTES_MAX = 50_000_000
_LOOK_S = 0.02  # between two looks for records: waking a thread at each would cost the loop more than all else here
_PAUSE_S = 20e-6  # after each record, so that the loop never waits for the interpreter longer than for one
_CLOSE_WAIT_S = 5.0
# The disk's fault, or of a message that holds what must not, or cannot, be written.
_UNWRITABLE = (OSError, ValueError, ArithmeticError, struct.error)


class RecordsLost(OSError):  # noqa: N818 (it is what has happened to them)
    """A write that failed and took earlier records with it.

    Attributes:
        count: of records, the one that was to be written among them.
    """

    def __init__(self, count: int, cause: OSError) -> None:
        super().__init__(cause.errno, cause.strerror)
        self.count = count


class Sink(Protocol):
    """Where records end up; used from one thread."""

    def write(self, record: Any) -> None:
        """Write one record.

        Raises:
            OSError: it is not written.
            ValueError: it cannot be written.
            ArithmeticError: one of its numbers is too large for its field.
            struct.error: one of its numbers does not fit its field.
        """

    def close(self) -> None:
        """Complete what was written.

        Raises:
            OSError: it is not complete.
        """


class Recorder(Protocol):
    """What a loop records into."""

    @property
    def dropped(self) -> int:
        """How many records were not written."""

    @property
    def why_dropped(self) -> str:
        """Why the first of them was not; empty while there is none."""

    def put(self, record: Any) -> None:
        """Take one record; never raises and never waits for a disk."""

    def close(self) -> None:
        """Write what is left, as far as it can be written soon."""


def _no_size(_: Any) -> int:
    return 0


class BackgroundRecorder:
    """Writes into a sink from a thread of its own.

    Args:
        sink: used by that thread only.
        capacity: records that wait at most; further ones are dropped.
        size_of: gives the bytes that a record holds; beyond 50 MB in all that waits, further ones are dropped, too.
        keeps_newest: drop the oldest that waits in place of a further one.
    """

    def __init__(
        self,
        sink: Sink,
        *,
        capacity: int = _CAPACITY,
        size_of: Callable[[Any], int] = _no_size,
        keeps_newest: bool = False,
    ) -> None:
        self._sink = sink
        self._capacity = capacity
        self._size_of = size_of
        self._keeps_newest = keeps_newest
        self._waiting: deque[tuple[int, Any]] = deque()  # sizes and records
        self._waiting_bytes = 0
        self._lock = threading.Lock()  # of these two; held for no longer than a record needs to come or go
        self._closing = threading.Event()
        self._dropped_full = 0
        self._dropped_failed = 0
        self._why_dropped = ""
        self._unforeseen_told = False
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    @property
    def dropped(self) -> int:
        """How many records were not written."""
        return self._dropped_full + self._dropped_failed

    @property
    def why_dropped(self) -> str:
        """Why the first of them was not; empty while there is none."""
        return self._why_dropped

    @property
    def waiting(self) -> int:
        """How many records are yet to be written."""
        return len(self._waiting)

    def put(self, record: Any) -> None:
        """Take one record."""
        size = self._size_of(record)
        with self._lock:
            while self._keeps_newest and self._waiting and size <= _BYTES_MAX and not self._has_room(size):
                self._dropped_full += 1
                self._take()
            if self._has_room(size):
                self._waiting.append((size, record))
                self._waiting_bytes += size
            else:
                self._dropped_full += 1
                self._why_dropped = self._why_dropped or "they come faster than they are taken"

    def _has_room(self, size: int) -> bool:
        return len(self._waiting) < self._capacity and self._waiting_bytes + size <= _BYTES_MAX

    def _take(self) -> Any:
        """Take the oldest that waits; with the lock."""
        size, record = self._waiting.popleft()
        self._waiting_bytes -= size
        return record

    def close(self) -> None:
        """Write what is left; a disk that takes longer than five seconds is not waited for."""
        self._closing.set()
        self._thread.join(_CLOSE_WAIT_S)

    def _run(self) -> None:
        is_last = False
        while not is_last:
            is_last = self._closing.wait(_LOOK_S)
            self._write_waiting()
        self._let(self._sink.close)

    def _write_waiting(self) -> None:
        while True:
            with self._lock:
                if not self._waiting:
                    return
                record = self._take()
            self._let(self._sink.write, record)
            time.sleep(_PAUSE_S)

    def _let(self, act: Callable[..., None], *record: Any) -> None:
        """Let the sink act, and count what it fails with: an error that ended this thread would lose all after it."""
        try:
            act(*record)
        except _UNWRITABLE as error:
            self._dropped_failed += _count_lost(error)
            self._why_dropped = self._why_dropped or _told(error)
        except Exception as error:  # noqa: BLE001 (of a library below the sink, which may raise anything)
            self._dropped_failed += 1
            self._why_dropped = self._why_dropped or f"unforeseen {type(error).__name__}"
            self._tell_unforeseen(type(error).__name__)

    def _tell_unforeseen(self, kind: str) -> None:
        if not self._unforeseen_told and sys.stderr is not None:
            self._unforeseen_told = True
            with suppress(OSError, ValueError):  # nobody reads it, or it is closed
                sys.stderr.write(f"a record cannot be written: unforeseen {kind}\n")


class DirectRecorder:
    """Writes into a sink at once: for runs on a simulated clock, whose recordings are the same for the same seed."""

    def __init__(self, sink: Sink) -> None:
        self._sink = sink
        self._dropped = 0
        self._why_dropped = ""

    @property
    def dropped(self) -> int:
        """How many records were not written."""
        return self._dropped

    @property
    def why_dropped(self) -> str:
        """Why the first of them was not; empty while there is none."""
        return self._why_dropped

    def put(self, record: Any) -> None:
        """Write one record."""
        self._let(self._sink.write, record)

    def close(self) -> None:
        """Complete the recording."""
        self._let(self._sink.close)

    def _let(self, act: Callable[..., None], *record: Any) -> None:
        try:
            act(*record)
        except _UNWRITABLE as error:
            self._dropped += _count_lost(error)
            self._why_dropped = self._why_dropped or _told(error)


def _count_lost(error: Exception) -> int:
    return error.count if isinstance(error, RecordsLost) else 1


def _told(error: Exception) -> str:
    """Return why a record was not written, as the system says it."""
    return (isinstance(error, OSError) and error.strerror) or str(error)
