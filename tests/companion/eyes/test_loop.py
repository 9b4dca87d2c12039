"""The loop of the detector around cameras that fail and begin slowly, on a clock that the camera moves."""

import os
import signal
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from companion.eyes import loop
from companion.eyes.loop import EyesLoop
from companion.eyes.node import EyesNode
from companion.eyes.sources.frames import Captured
from link.errors import UserError
from link.records import replace
from link.zenoh.inbox import Inbox, WakeUp
from link.zenoh.keys import Keys, Publication
from tests.companion.eyes.frames import system

S = 1_000_000_000
PERIOD_NS = S // 30


class SlowCamera:
    """Gives its first picture some time after it was opened, which takes a while itself; it stops at given times."""

    name = "slow"
    is_live = True
    refused_why: str | None = None

    def __init__(
        self,
        *,
        open_ns: int,
        first_ns: int,
        end_ns: int,
        stops_ns: tuple[int, ...] = (),
        absent_until_ns: int = 0,
        period_ns: int = PERIOD_NS,
    ) -> None:
        self._period_ns = period_ns
        self._open_ns, self._first_ns, self._end_ns, self._stops_ns = open_ns, first_ns, end_ns, stops_ns
        self._absent_until_ns = absent_until_ns
        self._random = np.random.default_rng(4)
        self.now_ns = S
        self.restarts_ns: list[int] = []
        self.came_ns: list[int] = []
        self._opened_ns, self._next_ns = S, S + first_ns

    def take(self, timeout_s: float) -> Captured | None:
        until_ns = self.now_ns + round(timeout_s * S)
        if any(self._opened_ns < stop_ns <= until_ns for stop_ns in self._stops_ns) or self._next_ns > until_ns:
            self.now_ns = until_ns
            return None
        self.now_ns, self._next_ns = max(self.now_ns, self._next_ns), max(self.now_ns, self._next_ns) + self._period_ns
        self.came_ns.append(self.now_ns)
        return Captured(t_ns=self.now_ns, shades=self._random.integers(0, 256, (720, 1280)).astype(np.uint8))

    def restart(self) -> None:
        self.restarts_ns.append(self.now_ns)
        if self.now_ns < self._absent_until_ns:
            raise UserError("there is no camera")
        self.now_ns += self._open_ns
        self._opened_ns, self._next_ns = self.now_ns, self.now_ns + self._first_ns

    def has_ended(self) -> bool:
        if self.now_ns >= self._end_ns:
            os.kill(os.getpid(), signal.SIGINT)  # as a user ends it
        return False

    def close(self) -> None: ...


class Quiet:
    """A session that nobody hears, and a log."""

    def __init__(self) -> None:
        self.wake_up = WakeUp()
        self.lines: list[str] = []

    def declare_alive(self, _: str) -> None: ...

    def subscribe(self, _: str) -> Inbox:
        return Inbox(capacity=1, wake_up=self.wake_up)

    def ask(self, *_: object) -> Inbox:
        return Inbox(capacity=1, wake_up=self.wake_up)

    def is_heard(self, *_: object) -> bool:
        return False

    def info(self, line: str, **_: object) -> None:
        self.lines.append(line)

    warning = info


class FreezingCamera(SlowCamera):
    """Gives its last picture again and again, with new stamps, once it has frozen."""

    frozen_ns = 3 * S
    last: Captured | None = None

    def take(self, timeout_s: float) -> Captured | None:
        captured = super().take(timeout_s)
        if captured is not None and self.last is not None and captured.t_ns >= self.frozen_ns:
            return replace(captured, shades=self.last.shades.copy())
        self.last = captured or self.last
        return captured


def run(camera: SlowCamera, monkeypatch: pytest.MonkeyPatch) -> tuple[list[int], list[str]]:
    """Return the stamps of the pictures that were looked at, and the lines that were logged."""
    looked_ns: list[int] = []

    def look(_: EyesNode, captured: Captured, **__: object) -> list[Publication]:
        looked_ns.append(captured.t_ns)
        return []

    monkeypatch.setattr(loop, "time", SimpleNamespace(monotonic_ns=lambda: camera.now_ns))
    monkeypatch.setattr(EyesNode, "look", look)
    quiet: Any = Quiet()
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    try:
        EyesLoop(EyesNode(system(), Keys()), camera, Keys(), zenoh=quiet, log=quiet).run()
    finally:
        quiet.wake_up.close()
        for number, handler in zip((signal.SIGINT, signal.SIGTERM), before, strict=True):
            signal.signal(number, handler)
    return looked_ns, quiet.lines


@pytest.mark.parametrize(("open_ns", "first_ns"), [(S // 5, 6 * S // 5), (13 * S // 10, 2 * S)])
def test_camera_whose_first_picture_takes_a_second_or_two_is_not_started_again(
    open_ns: int, first_ns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    camera = SlowCamera(open_ns=open_ns, first_ns=first_ns, end_ns=8 * S)
    run(camera, monkeypatch)
    assert camera.restarts_ns == []
    assert len(camera.came_ns) > 100


def test_slow_camera_that_stops_is_started_again_at_once_and_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = SlowCamera(open_ns=13 * S // 10, first_ns=2 * S, end_ns=12 * S, stops_ns=(5 * S,))
    run(camera, monkeypatch)
    (restarted_ns,) = camera.restarts_ns
    assert 0 < restarted_ns - 5 * S < S // 2 + PERIOD_NS
    assert camera.came_ns[-1] > 12 * S - 2 * PERIOD_NS


def test_camera_that_is_not_there_is_tried_each_second(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = SlowCamera(open_ns=0, first_ns=2 * S, end_ns=14 * S, stops_ns=(4 * S,), absent_until_ns=8 * S)
    run(camera, monkeypatch)
    assert 4 <= len(camera.restarts_ns) <= 6
    assert camera.came_ns[-1] > 14 * S - 2 * PERIOD_NS


def test_picture_that_comes_again_with_a_new_stamp_is_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = FreezingCamera(open_ns=0, first_ns=PERIOD_NS, end_ns=5 * S)
    looked_ns, _ = run(camera, monkeypatch)
    assert len(camera.came_ns) > len(looked_ns) + 20
    assert looked_ns == [came_ns for came_ns in camera.came_ns if came_ns < camera.frozen_ns]


@pytest.mark.parametrize("period_ns", [S, S // 2])
def test_camera_of_a_picture_or_two_a_second_is_told_to_be_slow_and_not_started_again(
    period_ns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    camera = SlowCamera(open_ns=0, first_ns=S, end_ns=12 * S, period_ns=period_ns)
    _, lines = run(camera, monkeypatch)
    assert camera.restarts_ns == []
    assert lines.count("slow pictures") == 1
    assert lines[0] == "ready"
    assert "camera failed" not in lines[lines.index("slow pictures") :]


def test_camera_of_two_pictures_a_second_that_stops_is_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = SlowCamera(open_ns=0, first_ns=S, end_ns=12 * S, period_ns=S // 2, stops_ns=(6 * S,))
    run(camera, monkeypatch)
    (restarted_ns,) = camera.restarts_ns
    assert 0 < restarted_ns - 6 * S < 2 * S
