"""Ports and routes that are not there for a while: each attempt that fails is counted, and another one follows."""

import os
import pty
import termios
import time
import tty
from collections.abc import Callable, Iterator

import pytest

from link.errors import UserError
from link.transports.opening import open_transport

DEADLINE_S = 10.0


def until(condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end_s


@pytest.fixture
def port() -> Iterator[str]:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    yield os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


def fails_to_flush(*_: object) -> None:
    raise termios.error(5, "Input/output error")


def test_serial_port_that_goes_while_it_is_opened_again_is_counted(port: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with open_transport(f"{port},57600") as transport:
        monkeypatch.setattr("link.transports.serial_transport.held_bytes", fails_to_flush)
        transport.send(b"lost")
        assert transport.fileno() == -1
        lost = transport.statistics.errors
        monkeypatch.undo()
        monkeypatch.setattr(termios, "tcflush", fails_to_flush)
        until(lambda: transport.receive(0.05) == b"" and transport.statistics.errors > lost)
        monkeypatch.undo()
        until(lambda: transport.receive(0.05) == b"" and transport.fileno() >= 0)


def test_serial_port_that_goes_while_it_is_opened_is_one_clear_line(port: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(termios, "tcflush", fails_to_flush)
    with pytest.raises(UserError, match=r"cannot be opened as a serial port .*Input/output error"):
        open_transport(f"{port},57600")


def test_server_to_which_there_is_no_way_is_tried_again_and_never_taken_for_connected() -> None:
    with open_transport("tcp:255.255.255.255:5760") as client:  # a broadcast address, which TCP refuses at once
        descriptors = set()

        def is_tried_again() -> bool:
            descriptors.add(client.fileno())
            return client.receive(0.05) == b"" and client.statistics.errors > 2

        until(is_tried_again)
        assert descriptors == {-1}
