"""The door before the view: only who brings the token gets through, and then as if there were no door."""

import http.client
import socket
import threading
from collections.abc import Iterator

import pytest

from link.errors import UserError
from scenarios.view.gate import COOKIE, Gate, Verdict, shown_host, verdict

TOKEN = "the-one_that-counts"  # noqa: S105 (of this test)
WAIT_S = 10.0


def head(target: str, **headers: str) -> bytes:
    lines = [f"GET {target} HTTP/1.1", "Host: car:8080", *(f"{name}: {value}" for name, value in headers.items())]
    return "\r\n".join([*lines, "", ""]).encode()


@pytest.mark.parametrize(
    ("request_head", "expected"),
    [
        (head("/"), Verdict.REFUSED),
        (head("/?token=another"), Verdict.REFUSED),
        (head("/?token="), Verdict.REFUSED),
        (head(f"/?token={TOKEN}"), Verdict.WELCOMED),
        (head(f"/?a=b&token={TOKEN}"), Verdict.WELCOMED),
        (head("/", Cookie=f"{COOKIE}={TOKEN}"), Verdict.ADMITTED),
        (head("/", cookie=f"other=1; {COOKIE}={TOKEN}"), Verdict.ADMITTED),
        (head("/", Cookie=f"{COOKIE}=another"), Verdict.REFUSED),
        (head("/", Cookie=f"other={TOKEN}"), Verdict.REFUSED),
        (head("/", Cookie=f"{COOKIE}={TOKEN}", Origin="http://car:8080"), Verdict.ADMITTED),
        (head("/", Cookie=f"{COOKIE}={TOKEN}", Origin="http://elsewhere"), Verdict.REFUSED),
        (head(f"/?token={TOKEN}").replace(b"GET", b"POST"), Verdict.REFUSED),
        (b"\xff\x00\r\n\r\n", Verdict.REFUSED),
    ],
)
def test_door_knows_the_token_and_the_cookie_and_nothing_else(request_head: bytes, expected: Verdict) -> None:
    assert verdict(request_head, TOKEN) is expected


@pytest.mark.parametrize(
    ("called", "origin", "expected"),
    [
        ("127.0.0.1:8080", None, Verdict.ADMITTED),
        ("localhost:8080", "http://localhost:8080", Verdict.ADMITTED),
        ("[::1]:8080", "http://[::1]:8080", Verdict.ADMITTED),
        ("127.0.0.1:8080", "http://elsewhere", Verdict.REFUSED),
        ("127.0.0.1:8080", "http://localhost:8000", Verdict.REFUSED),
        ("elsewhere:8080", "http://elsewhere:8080", Verdict.REFUSED),  # a name of theirs that leads here
    ],
)
def test_page_of_this_machine_listens_to_no_other_site(called: str, origin: str | None, expected: Verdict) -> None:
    request = head("/", **({} if origin is None else {"Origin": origin})).replace(b"car:8080", called.encode())
    assert verdict(request, None) is expected


@pytest.fixture
def page_port() -> Iterator[int]:
    """A page that answers each line that it gets with the same in capitals."""
    listening = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        while True:
            try:
                connection, _ = listening.accept()
            except OSError:
                return  # closed, at the end of the test
            with connection, connection.makefile("rb") as lines:
                for line in lines:
                    connection.sendall(line.upper())

    thread = threading.Thread(target=serve)
    thread.start()
    yield listening.getsockname()[1]
    listening.shutdown(socket.SHUT_RDWR)
    listening.close()
    thread.join()


def test_stranger_is_refused_and_learns_no_token(page_port: int) -> None:
    with Gate("127.0.0.1", 0, page_port) as gate:
        at, token = gate.address.removeprefix("http://").split("/?token=")
        client = http.client.HTTPConnection(at, timeout=WAIT_S)
        client.request("GET", "/")
        answer = client.getresponse()
        told = answer.read()
    assert answer.status == http.client.FORBIDDEN
    assert token.encode() not in told
    assert answer.headers["Set-Cookie"] is None


def test_token_is_changed_for_a_cookie_that_lets_both_sides_talk(page_port: int) -> None:
    with Gate("127.0.0.1", 0, page_port) as gate:
        at, token = gate.address.removeprefix("http://").split("/?token=")
        client = http.client.HTTPConnection(at, timeout=WAIT_S)
        client.request("GET", f"/?token={token}")
        answer = client.getresponse()
        cookie = answer.headers["Set-Cookie"].split(";")[0]
        assert (answer.status, answer.headers["Location"]) == (http.client.SEE_OTHER, "/")
        host, port = at.split(":")
        with socket.create_connection((host, int(port)), timeout=WAIT_S) as admitted:
            lines = admitted.makefile("rb")
            admitted.sendall(f"GET / HTTP/1.1\r\nCookie: {cookie}\r\n\r\n".encode())
            assert lines.readline() == b"GET / HTTP/1.1\r\n"
            assert lines.readline().startswith(b"COOKIE: ")
            assert lines.readline() == b"\r\n"
            admitted.sendall(b"and more\n")
            assert lines.readline() == b"AND MORE\n"


def test_address_that_is_not_this_machines_is_told() -> None:
    with pytest.raises(UserError, match=r"--host 192\.0\.2\.1 --port 0: cannot listen there \(.+\); choose another"):
        Gate("192.0.2.1", 0, 1)


@pytest.mark.parametrize(
    ("host", "shown"),
    [("192.0.2.7", "192.0.2.7"), ("2001:db8::7", "[2001:db8::7]"), ("0.0.0.0", socket.gethostname())],  # noqa: S104 (nothing listens there)
)
def test_address_names_the_host_as_a_browser_wants_it(host: str, shown: str) -> None:
    assert shown_host(host) == shown
