"""Who may talk to the page, which can fly the drone."""

import socket
import tempfile
from collections.abc import Iterator
from pathlib import Path
from urllib.request import urlopen

import psutil  # type: ignore[import-untyped]  # it has no annotations
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin

from scenarios.view.page import open_server

WAIT_S = 20.0


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    server = open_server(0)
    yield server.get_port()
    server.stop()


def admits(port: int, origin: str | None) -> bool:
    try:
        with connect(f"ws://127.0.0.1:{port}", origin=None if origin is None else Origin(origin), open_timeout=WAIT_S):
            return True
    except InvalidStatus:
        return False


@pytest.mark.parametrize("origin", [None, "http://127.0.0.1:8080", "http://localhost:9000", "http://[::1]:8080"])
def test_page_by_any_name_of_loopback_is_admitted(port: int, origin: str | None) -> None:
    assert admits(port, origin)


@pytest.mark.parametrize(
    "origin", ["http://elsewhere", "http://127.0.0.1.elsewhere:8080", "https://elsewhere/127.0.0.1", "null"]
)
def test_page_of_another_site_is_refused(port: int, origin: str) -> None:
    assert not admits(port, origin)


def listening() -> set[tuple[str, int]]:
    return {tuple(one.laddr) for one in psutil.Process().net_connections(kind="tcp") if one.status == "LISTEN"}


def test_server_listens_on_one_port_of_loopback_and_on_no_other() -> None:
    before = listening()
    server = open_server(0)
    assert listening() - before == {("127.0.0.1", server.get_port())}
    server.stop()


def test_page_has_our_title_and_icon_and_leaves_room_on_a_phone(port: int) -> None:
    with urlopen(f"http://127.0.0.1:{port}/", timeout=WAIT_S) as answer:
        page = answer.read().decode()
    assert "<title>Decklander</title>" in page
    assert 'rel="icon"' in page
    assert "max-height: 40%" in page


def test_page_leaves_no_file_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    server = open_server(0)
    try:
        with urlopen(f"http://127.0.0.1:{server.get_port()}/", timeout=WAIT_S) as answer:
            assert answer.status == 200
        assert list(tmp_path.iterdir()) == []
    finally:
        server.stop()


def test_who_speaks_another_protocol_is_no_line_on_the_terminal(caplog: pytest.LogCaptureFixture) -> None:
    server = open_server(0)  # one that has not answered anybody yet
    try:
        with socket.create_connection(("127.0.0.1", server.get_port()), timeout=WAIT_S) as stranger:
            stranger.sendall(b"no request\r\n\r\n")
            while stranger.recv(1024):
                pass
        assert caplog.records == []
    finally:
        server.stop()
