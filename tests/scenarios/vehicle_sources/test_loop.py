"""The loop of a real vehicle over devices that say nothing."""

import signal
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Self, cast

import pytest

from link.messages import PadGeometry
from link.program.service import Service
from link.recording.log import Log
from link.transports.tcp_transport import TcpClientTransport
from link.transports.transport import Transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.vehicle_sources.channel import FileTransport
from scenarios.vehicle_sources.loop import ReceiverLoop
from scenarios.vehicle_sources.nmea import NmeaReceiver
from tests.scenarios.vehicle_sources.sentences import drive, sentence

OPENED_MAX = 20
PAD = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0))


class SilentServer(TcpClientTransport):
    """A connection that brings nothing."""

    def __init__(self) -> None:
        Transport.__init__(self)
        self.is_open = True

    def receive(self, timeout_s: float) -> bytes:  # noqa: ARG002 (nothing is waited for)
        return b""

    def send(self, data: bytes) -> None:
        pass

    def fileno(self) -> int:
        return 0 if self.is_open else -1

    def close(self) -> None:
        self.is_open = False


class Network:
    """Opens silent connections until there were enough of them, and knows which are still held."""

    def __init__(self) -> None:
        self.opened: list[weakref.ref[SilentServer]] = []
        self.held_max = 0

    def open(self) -> SilentServer:
        connection = SilentServer()
        self.opened.append(weakref.ref(connection))
        self.held_max = max(self.held_max, sum(one() is not None for one in self.opened))
        if len(self.opened) == OPENED_MAX:
            signal.raise_signal(signal.SIGTERM)
        return connection


class NoZenoh:
    """A session that nobody listens to, with a clock that only waiting moves on."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.told_s: list[float] = []
        """When each fix was published."""

    @property
    def wake_up(self) -> Self:
        return self

    def wait(self, timeout_s: float) -> None:
        self.now_s += timeout_s
        assert self.now_s < 60.0

    def publish(self, key: str, *_: object) -> None:
        if key == Keys().fix:
            self.told_s.append(self.now_s)

    def serve(self, *_: object) -> None:
        pass

    def declare_alive(self, _: str) -> None:
        pass


@contextmanager
def signals_restored() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def test_connection_that_was_opened_again_is_held_no_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    now_ns = 0

    def monotonic_ns() -> int:
        nonlocal now_ns
        now_ns += 10**9
        return now_ns

    clock = SimpleNamespace(monotonic_ns=monotonic_ns, monotonic=time.monotonic)
    monkeypatch.setattr("scenarios.vehicle_sources.loop.time", clock)
    network = Network()
    loop = ReceiverLoop(
        NmeaReceiver(),
        network.open,
        "a server",
        keys=Keys(),
        zenoh=cast(ZenohSession, NoZenoh()),
        pad=PAD,
        service=Service(),
        log=Log("ground-vehicle"),
    )
    with signals_restored():
        loop.run()
    assert len(network.opened) == OPENED_MAX
    assert network.held_max == 2
    assert all(one() is None for one in network.opened)


@pytest.mark.parametrize("date", ["010106", "110646"], ids=["before", "after"])
def test_recording_whose_receiver_began_with_another_date_goes_on_where_it_was_set(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, date: str
) -> None:
    zenoh, path = NoZenoh(), tmp_path / "drive.nmea"
    begun = (
        "GNGGA,115959.80,4717.11399,N,00833.91590,E,4,12,0.8,499.6,M,48.0,M,1.0,0000",
        f"GNRMC,115959.80,A,4717.11399,N,00833.91590,E,9.719,77.52,{date},,,R",
    )
    path.write_bytes(b"".join(map(sentence, begun)) + drive(6))
    clock = SimpleNamespace(monotonic_ns=lambda: round(zenoh.now_s * 1e9), monotonic=lambda: zenoh.now_s)
    monkeypatch.setattr("scenarios.vehicle_sources.loop.time", clock)
    loop = ReceiverLoop(
        NmeaReceiver(),
        lambda: FileTransport(path),
        "a recording",
        keys=Keys(),
        zenoh=cast(ZenohSession, zenoh),
        pad=PAD,
        service=Service(),
        log=Log("ground-vehicle"),
    )
    with signals_restored():
        loop.run()
    assert zenoh.told_s[-5:] == pytest.approx([zenoh.told_s[-6] + 0.2 * count for count in range(1, 6)])
    assert zenoh.told_s[-1] < 2.0
