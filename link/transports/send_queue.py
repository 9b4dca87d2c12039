"""What is on its way out on a stream, by age: a setpoint or command that arrives late is worse than none.

Sent before the sender gave up, received afterwards, it moves a drone that nobody steers any more. So a frame that
nobody takes is dropped while it is still whole; one that is begun goes on with its rest, since whoever reads would take
the next frame for it; and a stream on which anything is under way for too long is given up with all that is on it.
"""

from collections import deque
from collections.abc import Callable

WAITING_MAX_S = 0.2  # ten setpoints, and less than the half second after which autopilots call their stream lost
UNDER_WAY_MAX_S = 1.0  # PX4's COM_OF_LOSS_T: setpoints older than that could begin an OFFBOARD that it has left
_WAITING_BYTES_MAX = 65536  # of a burst, such as a log that is downloaded


class SendQueue:
    """The frames of one stream, from when they are given to when the system has passed them on."""

    def __init__(self) -> None:
        self._waiting: deque[tuple[float, bytes]] = deque()  # when given, whole frames
        self._waiting_bytes = 0
        self._begun: tuple[float, bytes] | None = None  # when given, what is left of the frame
        self._written: deque[tuple[float, int]] = deque()  # when given, where in the stream it ends
        self._written_bytes = 0
        self._refused_s: float | None = None  # since when nothing has been taken

    def __len__(self) -> int:
        """How many frames have not been written in whole."""
        return len(self._waiting) + (self._begun is not None)

    def put(self, data: bytes, now_s: float) -> bool:
        """Takes whole frames, given at a monotonic time; returns whether there was room for them."""
        has_room = self._waiting_bytes + len(data) <= _WAITING_BYTES_MAX
        if has_room:
            self._waiting.append((now_s, data))
            self._waiting_bytes += len(data)
        return has_room

    def write(self, write: Callable[[bytes], int], now_s: float) -> int:
        """Writes what is taken.

        Args:
            write: takes the beginning of some bytes and returns how many; BlockingIOError is none.
            now_s: monotonic time.

        Returns:
            How many frames had waited for too long and were dropped.

        Raises:
            OSError: from `write`.
        """
        dropped = self._drop_old(now_s)
        while (item := self._begun or (self._waiting[0] if self._waiting else None)) is not None:
            given_s, data = item
            taken = _write_some(write, data)
            if not taken:
                self._refused_s = now_s if self._refused_s is None else self._refused_s
                break
            self._refused_s = None
            if self._begun is None:
                self._waiting.popleft()
                self._waiting_bytes -= len(data)
            self._begun = (given_s, data[taken:]) if taken < len(data) else None
            self._written_bytes += taken
            self._written.append((given_s, self._written_bytes))
        return dropped

    def is_overdue(self, held_bytes: int, now_s: float) -> bool:
        """Whether something is under way for so long that the stream is to be given up.

        Args:
            held_bytes: how much of what was written the system still holds, 0 where it does not tell.
            now_s: monotonic time.
        """
        passed_on_bytes = self._written_bytes - held_bytes
        while self._written and self._written[0][1] <= passed_on_bytes:
            self._written.popleft()
        since_s = (
            self._written[0][0] if self._written else now_s,
            now_s if self._begun is None else self._begun[0],
            now_s if self._refused_s is None else self._refused_s,
        )
        return now_s - min(since_s) > UNDER_WAY_MAX_S

    def _drop_old(self, now_s: float) -> int:
        """Drops whole frames that have waited for too long; returns how many."""
        dropped = 0
        while self._waiting and now_s - self._waiting[0][0] > WAITING_MAX_S:
            self._waiting_bytes -= len(self._waiting.popleft()[1])
            dropped += 1
        return dropped


def _write_some(write: Callable[[bytes], int], data: bytes) -> int:
    try:
        return write(data)
    except BlockingIOError:
        return 0
