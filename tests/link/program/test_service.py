"""What a program tells the service manager, received by a real unix socket."""

import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from link.program.service import Service

MS = 1_000_000


@pytest.fixture
def manager(tmp_path: Path) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind(str(tmp_path / "notify"))
        listening.settimeout(5.0)
        yield listening


def environment(manager: socket.socket, **more: str) -> dict[str, str]:
    return {"NOTIFY_SOCKET": manager.getsockname(), **more}


def test_ready_status_and_stopping_arrive_once_each(manager: socket.socket) -> None:
    service = Service(environment(manager))
    for _ in range(2):
        service.ready()
        service.status("two\nlines")
    service.stopping()
    assert [manager.recv(100) for _ in range(3)] == [b"READY=1", b"STATUS=two lines", b"STOPPING=1"]
    service.close()


def test_watchdog_is_fed_at_twice_the_rate_asked_for(manager: socket.socket) -> None:
    service = Service(environment(manager, WATCHDOG_USEC="200000", WATCHDOG_PID=str(os.getpid())))
    for t_ms in range(0, 1000, 10):
        service.alive(t_ms * MS)
    service.stopping()
    received = [manager.recv(100)]
    while received[-1] != b"STOPPING=1":
        received.append(manager.recv(100))
    assert received[:-1] == [b"WATCHDOG=1"] * 10
    service.close()


def test_another_process_s_watchdog_is_not_fed(manager: socket.socket) -> None:
    service = Service(environment(manager, WATCHDOG_USEC="200000", WATCHDOG_PID="1"))
    service.alive(0)
    service.ready()
    assert manager.recv(100) == b"READY=1"
    service.close()


@pytest.mark.parametrize("environ", [{}, {"NOTIFY_SOCKET": "/nowhere/at/all"}, {"NOTIFY_SOCKET": "relative"}])
@pytest.mark.parametrize("watchdog_us", ["1000", "²"])
def test_without_a_manager_nothing_happens(environ: dict[str, str], watchdog_us: str) -> None:
    service = Service(environ | {"WATCHDOG_USEC": watchdog_us})
    service.ready()
    service.alive(0)
    service.close()


def test_abstract_sockets_are_found() -> None:
    name = f"decklander-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind("\0" + name)
        listening.settimeout(5.0)
        service = Service({"NOTIFY_SOCKET": "@" + name})
        service.ready()
        assert listening.recv(100) == b"READY=1"
        service.close()
