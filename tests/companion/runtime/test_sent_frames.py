"""What a turn sends, and that one which took too long sends nothing."""

import pytest

from companion.runtime.sent_frames import SentFrames
from link.mavlink.tlog import TlogFrames
from link.transports.transport import Transport
from tests.companion.peer import Setup

FRAMES = [b"one", b"two"]


class Wire(Transport):
    """A transport that keeps what is sent."""

    def __init__(self) -> None:
        super().__init__()
        self.sent = list[bytes]()

    def receive(self, timeout_s: float) -> bytes:  # noqa: ARG002 (nothing ever comes)
        return b""

    def send(self, data: bytes) -> None:
        self.sent.append(data)

    def fileno(self) -> int:
        return -1

    def close(self) -> None:
        self.sent.clear()


class Log:
    """A recorder that keeps what is put."""

    dropped = 0
    why_dropped = ""

    def __init__(self) -> None:
        self.put_in = list[object]()

    def put(self, record: object) -> None:
        self.put_in.append(record)

    def close(self) -> None:
        self.put_in.clear()


@pytest.mark.parametrize(("took_s", "is_sent"), [(0.0, True), (0.4, True), (0.6, False), (10.0, False)])
def test_turn_that_was_stopped_sends_nothing_of_what_was_right_then(
    took_s: float, monkeypatch: pytest.MonkeyPatch, *, is_sent: bool
) -> None:
    wire, log = Wire(), Log()
    monkeypatch.setattr("companion.runtime.sent_frames.time.perf_counter", lambda: 100.0 + took_s)
    SentFrames(wire, Setup().node.autopilot.session, log).send(FRAMES, 1, 100.0)
    assert wire.sent == (FRAMES if is_sent else [])
    assert len(log.put_in) == is_sent


def test_log_has_what_came_even_where_nothing_is_sent() -> None:
    log = Log()
    SentFrames(Wire(), Setup().node.autopilot.session, log).record(FRAMES, 1)
    (entry,) = log.put_in
    assert isinstance(entry, TlogFrames)
    assert entry.frames == FRAMES
