"""A door before the page, since the page can fly the drone: it lets nothing through that another site has sent.

For other machines there is a token besides, while the page itself is on loopback. The page's address with `?token=...`
answers with a cookie, and every further connection must show it, that of the page's WebSocket, too. A browser sends it
from no other site (SameSite), and one that did would be seen by its Origin. Nothing is encrypted: on a network that is
not trusted, a tunnel (ssh) is the way.
"""

import asyncio
import secrets
import socket
import threading
from enum import Enum
from types import TracebackType
from typing import Self
from urllib.parse import parse_qs, urlsplit

from link.errors import UserError

COOKIE = "decklander_view"
LOOPBACK = frozenset({"127.0.0.1", "localhost", "::1"})
_TOKEN_BYTES = 18
_HEAD_MAX_BYTES = 16_384
_HEAD_WAIT_S = 5.0
_CHUNK_BYTES = 65_536
_EVERYWHERE = {"": socket.AF_INET, "0.0.0.0": socket.AF_INET, "::": socket.AF_INET6}  # noqa: S104 (as the user asked)
_REFUSAL = b"This page needs the address with the token that `scenarios view` has printed.\n"


class Verdict(Enum):
    """What becomes of a connection."""

    REFUSED = "refused"
    WELCOMED = "welcomed"  # it brought the token, and gets the cookie
    ADMITTED = "admitted"  # it showed the cookie


def verdict(head: bytes, token: str | None) -> Verdict:
    """Return what becomes of a connection that begins with a request.

    Args:
        head: the request's first line and headers, up to the empty line.
        token: that is asked for; None lets in whoever calls this machine by a name of loopback, which a page of
            another site cannot, even if its own name leads here.
    """
    first, *lines = head.decode("latin-1").split("\r\n")
    words = first.split(" ")
    if len(words) != 3 or words[0] != "GET":
        return Verdict.REFUSED
    headers = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
    if "origin" in headers and urlsplit(headers["origin"]).netloc != headers.get("host"):
        return Verdict.REFUSED
    if token is None:
        called = urlsplit(f"//{headers.get('host', '')}").hostname
        return Verdict.ADMITTED if called in LOOPBACK else Verdict.REFUSED
    pairs = (part.strip().partition("=") for part in headers.get("cookie", "").split(";"))
    if any(name == COOKIE and _is_same(value, token) for name, _, value in pairs):
        return Verdict.ADMITTED
    brought = parse_qs(urlsplit(words[1]).query).get("token", [])
    return Verdict.WELCOMED if any(_is_same(one, token) for one in brought) else Verdict.REFUSED


def _is_same(one: str, other: str) -> bool:
    """Compare in a time that tells nothing about where they differ."""
    return secrets.compare_digest(one.encode(), other.encode())


def shown_host(host: str) -> str:
    """Return a host as an address names it; this machine's name where it listens everywhere."""
    shown = socket.gethostname() if host in _EVERYWHERE else host
    return f"[{shown}]" if ":" in shown else shown


class Gate:
    """The door; open inside a `with` block.

    Args:
        host: where it listens.
        port: 0 for any free one.
        page_port: of the page, on loopback.
        with_token: whether a token is asked for.

    Attributes:
        address: where a browser finds it, token included.

    Raises:
        UserError: there is no such place to listen at.
    """

    def __init__(self, host: str, port: int, page_port: int, *, with_token: bool = True) -> None:
        family = _EVERYWHERE.get(host)
        try:
            found = socket.getaddrinfo(host or None, port, family or 0, socket.SOCK_STREAM, 0, socket.AI_PASSIVE)[0]
            self._listening = socket.create_server(found[4][:2], family=found[0])
        except OSError as error:
            why = error.strerror or str(error)
            raise UserError(f"--host {host} --port {port}: cannot listen there ({why}); choose another") from None
        self._page_port, self._token = page_port, secrets.token_urlsafe(_TOKEN_BYTES) if with_token else None
        self.address = f"http://{shown_host(host)}:{self._listening.getsockname()[1]}"
        if self._token is not None:
            self.address += f"/?token={self._token}"
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="gate", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        server = self._loop.run_until_complete(
            asyncio.start_server(self._serve, sock=self._listening, limit=_HEAD_MAX_BYTES)
        )
        self._loop.run_forever()
        server.close()
        for task in asyncio.all_tasks(self._loop):
            task.cancel()
        self._loop.run_until_complete(asyncio.gather(*asyncio.all_tasks(self._loop), return_exceptions=True))
        self._loop.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), _HEAD_WAIT_S)
            match verdict(head, self._token):
                case Verdict.ADMITTED:
                    await self._pass_on(head, reader, writer)
                case Verdict.WELCOMED:
                    cookie = f"{COOKIE}={self._token}; HttpOnly; SameSite=Strict; Path=/"
                    await _answer(writer, "303 See Other", f"Location: /\r\nSet-Cookie: {cookie}\r\n")
                case Verdict.REFUSED:
                    await _answer(writer, "403 Forbidden", "Content-Type: text/plain\r\n", _REFUSAL)
        except (asyncio.IncompleteReadError, asyncio.LimitOverrunError, TimeoutError, OSError):
            return  # a peer that says nothing, too much, or goes
        finally:
            writer.close()

    async def _pass_on(self, head: bytes, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Let both sides talk until one of them ends."""
        page_reader, page_writer = await asyncio.open_connection("127.0.0.1", self._page_port)
        try:
            page_writer.write(head)
            ways = [asyncio.create_task(_copy(reader, page_writer)), asyncio.create_task(_copy(page_reader, writer))]
            _, open_still = await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
            for way in open_still:
                way.cancel()
            await asyncio.gather(*ways, return_exceptions=True)
        finally:
            page_writer.close()


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while data := await reader.read(_CHUNK_BYTES):
        writer.write(data)
        await writer.drain()


async def _answer(writer: asyncio.StreamWriter, status: str, headers: str, body: bytes = b"") -> None:
    told = f"HTTP/1.1 {status}\r\n{headers}Content-Length: {len(body)}\r\nConnection: close\r\n\r\n"
    writer.write(told.encode("latin-1") + body)
    await writer.drain()
