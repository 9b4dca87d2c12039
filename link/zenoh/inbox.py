"""What waits between the thread that receives it and the loop that takes it: samples, and who is alive."""

import select
import socket
import threading
from collections import deque
from typing import NamedTuple

_SAMPLE_BYTES = 1024  # more than a fix, a velocity, an IMU or a status take
_BYTES_MIN = 1 << 18  # for a few that are larger, such as plans


class Sample(NamedTuple):
    """A payload, the key that it came by and when it was received, on the session's receive clock."""

    key: str
    payload: bytes
    received_ns: int


class WakeUp:
    """Lets any thread wake a loop that sleeps in `wait`, or in `select` on `fileno()` beside its other sockets."""

    def __init__(self) -> None:
        self._reader, self._writer = socket.socketpair()
        self._reader.setblocking(False)
        self._writer.setblocking(False)
        self._lock = threading.Lock()
        self._is_set = False
        self._is_closed = False

    def fileno(self) -> int:
        """Return the descriptor that is readable from `set` until `clear`."""
        return self._reader.fileno()

    def set(self) -> None:
        """Wake the loop, or keep it from falling asleep."""
        with self._lock:
            if not (self._is_set or self._is_closed):
                self._writer.send(b"\0")
                self._is_set = True

    def clear(self) -> None:
        """Let the loop sleep again; to be called before it looks for what has come."""
        with self._lock:
            if self._is_set:
                self._reader.recv(1)
                self._is_set = False

    def wait(self, timeout_s: float) -> bool:
        """Sleep until woken or for `timeout_s`, clear, and return whether it was woken."""
        woken = bool(select.select([self._reader], [], [], max(timeout_s, 0.0))[0])
        self.clear()
        return woken

    def close(self) -> None:
        """Release the descriptors; `set` has no effect from then on."""
        with self._lock:
            self._is_closed, self._is_set = True, False
            self._reader.close()
            self._writer.close()


class Inbox:
    """A queue of samples, bounded in number and bytes, that drops the oldest when it is full and counts the dropped.

    Args:
        capacity: samples.
        wake_up: is set by each.
        bytes_max: of all together; a sample that is larger than that is dropped itself.
    """

    def __init__(self, *, capacity: int, wake_up: WakeUp, bytes_max: int | None = None) -> None:
        self._samples: deque[Sample] = deque()
        self._capacity = capacity
        self._bytes_max = max(_BYTES_MIN, capacity * _SAMPLE_BYTES) if bytes_max is None else bytes_max
        self._bytes = 0
        self._wake_up = wake_up
        self._lock = threading.Lock()
        self._dropped = 0

    @property
    def dropped(self) -> int:
        """How many samples were dropped because nobody took them in time, or since they are too large."""
        return self._dropped

    def has_room(self, size: int) -> bool:
        """Return whether a sample of `size` bytes would be kept, and count it as dropped where it would not."""
        if size <= self._bytes_max:
            return True
        with self._lock:
            self._dropped += 1
        return False

    def put(self, sample: Sample) -> None:
        """Append a sample; for the receiving thread."""
        if not self.has_room(len(sample.payload)):
            return
        with self._lock:
            self._samples.append(sample)
            self._bytes += len(sample.payload)
            while len(self._samples) > self._capacity or self._bytes > self._bytes_max:
                self._bytes -= len(self._samples.popleft().payload)
                self._dropped += 1
        self._wake_up.set()

    def take(self) -> list[Sample]:
        """Return all samples that wait, oldest first, without blocking."""
        with self._lock:
            samples = list(self._samples)
            self._samples.clear()
            self._bytes = 0
        return samples


_TOKENS_MAX = 100
"""On a key with wildcards; no network has so many drones at one vehicle, and each token costs time in every step."""


class Alive:
    """Whether anybody declares a liveliness token on a key; tokens beyond a hundred are not taken note of."""

    def __init__(self, wake_up: WakeUp) -> None:
        self._wake_up = wake_up
        self._keys: set[str] = set()

    @property
    def alive(self) -> bool:
        """Whether a token is there now."""
        return bool(self._keys)

    @property
    def keys(self) -> frozenset[str]:
        """The keys of all tokens that are there now."""
        return frozenset(self._keys)

    def update(self, key: str, *, is_alive: bool) -> None:
        """Take the news of a token; for the receiving thread."""
        if not is_alive:
            self._keys.discard(key)
        elif len(self._keys) < _TOKENS_MAX:
            self._keys.add(key)
        self._wake_up.set()
