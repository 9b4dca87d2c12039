"""The recorder: what it writes, and what a disk that fails, stalls or is full costs."""

import errno
import threading
import time

import pytest

from link.recording.recorder import BackgroundRecorder, DirectRecorder, Recorder


class _Sink:
    """Keeps records; some cannot be written, and it can be held up."""

    def __init__(self) -> None:
        self.written: list[object] = []
        self.closed = False
        self.goes_on = threading.Event()
        self.goes_on.set()
        self.entered = threading.Event()

    def write(self, record: object) -> None:
        self.entered.set()
        self.goes_on.wait()
        if record == "full":
            raise OSError(errno.ENOSPC, "No space left on device")
        if record == "bad":
            raise ValueError("nan")
        self.written.append(record)

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize("kind", [BackgroundRecorder, DirectRecorder])
def test_recorder_writes_in_order_and_counts_what_cannot_be_written(kind: type[BackgroundRecorder]) -> None:
    sink = _Sink()
    recorder: Recorder = kind(sink)
    for record in (1, "full", 2, "bad", 3):
        recorder.put(record)
    recorder.close()
    assert sink.written == [1, 2, 3]
    assert recorder.dropped == 2
    assert sink.closed


def test_recorder_drops_what_does_not_fit_and_never_waits() -> None:
    sink = _Sink()
    sink.goes_on.clear()
    recorder = BackgroundRecorder(sink, capacity=10)
    recorder.put(0)
    assert sink.entered.wait(5.0)
    began_s = time.thread_time()
    for record in range(1, 101):
        recorder.put(record)  # would never return if it waited, since nothing goes on before the loop's end
    assert time.thread_time() - began_s < 5.0
    assert recorder.dropped == 90
    sink.goes_on.set()
    recorder.close()
    assert sink.written == list(range(11))
