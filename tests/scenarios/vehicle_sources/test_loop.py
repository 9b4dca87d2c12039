"""The loop of a real vehicle over devices that say nothing."""

import signal
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import cast

import pytest

from link.messages import PadGeometry
from link.program.service import Service
from link.recording.log import Log
from link.transports.tcp_transport import TcpClientTransport
from link.transports.transport import Transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.vehicle_sources.loop import ReceiverLoop
from scenarios.vehicle_sources.nmea import NmeaReceiver

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
    """A session that nobody listens to."""

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
