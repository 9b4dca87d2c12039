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


class _Unforeseen(Exception):  # noqa: N818 (whatever a library calls it)
    """An error that no sink says it raises."""


class _SinkOfALibrary(_Sink):
    """Some records and its end make a library below it raise what nobody has foreseen."""

    def write(self, record: object) -> None:
        if record == "bad":
            raise _Unforeseen
        super().write(record)

    def close(self) -> None:
        raise _Unforeseen


def test_error_that_nobody_has_foreseen_costs_its_record_alone_and_is_named_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    sink = _SinkOfALibrary()
    recorder = BackgroundRecorder(sink)
    for record in (1, "bad", 2, "bad", 3):
        recorder.put(record)
    recorder.close()
    assert sink.written == [1, 2, 3]
    assert recorder.dropped == 3
    assert capsys.readouterr().err.count("_Unforeseen") == 1


@pytest.mark.parametrize("kind", [BackgroundRecorder, DirectRecorder])
def test_recorder_writes_in_order_and_counts_what_cannot_be_written(kind: type[BackgroundRecorder]) -> None:
    sink = _Sink()
    recorder: Recorder = kind(sink)
    for record in (1, "full", 2, "bad", 3):
        recorder.put(record)
    recorder.close()
    assert sink.written == [1, 2, 3]
    assert (recorder.dropped, recorder.why_dropped) == (2, "No space left on device")
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


@pytest.mark.parametrize("keeps_newest", [False, True])
def test_what_waits_is_bounded_in_bytes_and_there_is_room_again_once_it_was_written(keeps_newest: bool) -> None:
    sink = _Sink()
    sink.goes_on.clear()
    recorder = BackgroundRecorder(sink, size_of=len, keeps_newest=keeps_newest)
    recorder.put("first")
    assert sink.entered.wait(5.0)
    large = [character * 1_000_000 for character in "abc"]
    for record in (large[0], *[large[1]] * 58, large[2]):
        recorder.put(record)
    assert (recorder.waiting, recorder.dropped) == (50, 10)
    sink.goes_on.set()
    deadline_s = time.monotonic() + 10.0
    while recorder.waiting:
        assert time.monotonic() < deadline_s
    recorder.put(large[2])
    recorder.close()
    oldest, newest = (large[1], large[2]) if keeps_newest else (large[0], large[1])
    assert sink.written == ["first", oldest, *[large[1]] * 48, newest, large[2]]
    assert recorder.dropped == 10
