"""A viewer that takes nothing more must not hold up the loop that flies."""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from typing import cast

import pytest

from companion.config.companion import CompanionConfig
from companion.runtime import loop
from companion.runtime.build import build_node
from companion.runtime.options import Links, LoopOptions
from companion.runtime.outbox import outbox
from link.transports.transport import PeerBytes, Transport, TransportStatistics
from link.zenoh.inbox import Alive, Inbox, WakeUp
from link.zenoh.keys import Keys, Publication
from link.zenoh.session import ZenohSession

TURNS = 200
DEADLINE_S = 10.0
LOST_S = 0.5  # without a setpoint, after which PX4's shortest time-out calls the stream lost


class StalledSession:
    """One whose first publication is taken only when a test ends."""

    def __init__(self) -> None:
        self.taken: list[str] = []
        self.unpublished = 0
        self.is_waiting, self.goes_on = threading.Event(), threading.Event()
        self.wake_up = WakeUp()

    def publish(self, key: str, payload: bytes, encoding: str) -> None:
        del payload, encoding
        self.is_waiting.set()
        self.goes_on.wait(DEADLINE_S)
        self.taken.append(key)

    def is_heard(self, key: str, encoding: str) -> bool:
        del key, encoding
        return False

    def subscribe(self, key: str, *, sample_bytes_max: int) -> Inbox:
        del key, sample_bytes_max
        return Inbox(capacity=8, wake_up=self.wake_up)

    def watch_alive(self, key: str) -> Alive:
        del key
        return Alive(self.wake_up)

    def declare_alive(self, key: str) -> Callable[[], None]:
        del key
        return lambda: None

    def serve_later(self, key: str, take: Callable[[bytes, Callable[[bytes], None]], None]) -> None:
        del key, take


class TurnsOnly:
    """A link on which nobody speaks; it ends the program after some turns of its loop once somebody has waited."""

    is_datagram = True
    statistics = TransportStatistics(errors=0, dropped=0, strangers=0)

    def __init__(self, session: StalledSession) -> None:
        self._session = session
        self._left = TURNS
        self._turned_s: float | None = None
        self.longest_s = 0.0

    def receive_by_peer(self, timeout_s: float) -> list[PeerBytes]:
        now_s = time.monotonic()
        self.longest_s = max(self.longest_s, now_s - (self._turned_s or now_s))
        self._turned_s = now_s
        self._session.goes_on.wait(timeout_s)
        self._left -= self._session.is_waiting.is_set()
        if self._left <= 0:
            self._session.goes_on.set()
            signal.raise_signal(signal.SIGINT)
        return []

    def seek_peer(self) -> None:
        pass

    def send(self, data: bytes) -> None:
        del data


@pytest.fixture
def session() -> Iterator[StalledSession]:
    stalled = StalledSession()
    yield stalled
    stalled.goes_on.set()
    stalled.wake_up.close()


@pytest.fixture
def _signals_as_before(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(loop, "spare_present_objects", lambda: None)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("_signals_as_before")
def test_loop_turns_on_while_nobody_takes_what_is_published(session: StalledSession) -> None:
    transport = TurnsOnly(session)
    links = Links(keys=Keys(), transport=cast(Transport, transport), zenoh=cast(ZenohSession, session))
    options = LoopOptions(
        device="udpin:127.0.0.1:14540", timeout_s=0.0, start=False, dry_run=False, use_sim_time=False, tlog=None
    )
    loop.run(build_node(CompanionConfig(), Keys()), links, options)
    assert session.taken
    assert transport.longest_s < LOST_S


def test_publications_go_out_in_order_and_of_too_many_that_wait_the_newest_do(session: StalledSession) -> None:
    publications = outbox(session)
    publications.put(Publication(key="0", payload=b"", encoding=""))
    assert session.is_waiting.wait(DEADLINE_S)
    for number in range(1, 1000):
        publications.put(Publication(key=str(number), payload=b"", encoding=""))
    session.goes_on.set()
    publications.close()
    first, *later = map(int, session.taken)
    assert first == 0
    assert later == list(range(1000 - len(later), 1000))
    assert len(session.taken) + publications.dropped == 1000
    assert len(session.taken) < 100
