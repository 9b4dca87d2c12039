"""The Zenoh session: the only place that knows the Zenoh library.

Zenoh calls back on threads of its own; here these only put samples into inboxes, so that everything else runs in
the program's own loop. Samples are sent with congestion control BLOCK and default priority: with REAL_TIME and DROP
samples were seen to get lost on a busy machine.
"""

import json
import re
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Self

import zenoh

from link.errors import UserError
from link.payloads.checks import PayloadError
from link.zenoh.exposure import check_exposure
from link.zenoh.inbox import Inbox, Sample, WakeUp
from link.zenoh.options import DEFAULT_ENDPOINT, ZenohOptions

__all__ = ["DEFAULT_ENDPOINT", "Alive", "Inbox", "Sample", "WakeUp", "ZenohOptions", "ZenohSession", "open_session"]

INBOX_CAPACITY = 1024
"""Ten seconds of a 100 Hz stream."""

_REPLIES_MAX = 256
"""Answers to queries that wait to be sent; more are asked for by nobody who means it."""

_SOURCE_PLACE = re.compile(r"\s+at /\S+\.rs:\d+\.?")
_CLIENT_CONNECT_TIMEOUT_MS = 5000
_BLOCK_MAX_KEY = "transport/link/tx/queue/congestion_control/block/wait_before_close"
_BLOCK_MAX_US = 200_000
"""A peer that takes nothing for this long while its queue is full is disconnected: a hung dashboard must not
stall the loop that flies. Less than the half second after which autopilots call a setpoint stream lost."""

_MESSAGE_MAX_KEY = "transport/link/rx/max_message_size"


class Replies:
    """Sends answers to queries from a thread of its own: one who does not read them holds nobody else up.

    Attributes:
        lost: answers to who has gone, or that came after the end.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="replies")
        self._places = threading.BoundedSemaphore(_REPLIES_MAX)
        self.lost = 0

    def put(self, query: zenoh.Query, send: Callable[[], None]) -> None:
        """Answer `query` by `send` later, or never where too many wait already."""
        if not self._places.acquire(blocking=False):
            return
        try:
            self._pool.submit(self._send, query, send)
        except RuntimeError:  # it is closed
            self.lost += 1

    def close(self) -> None:
        """Send none of those that wait."""
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _send(self, query: zenoh.Query, send: Callable[[], None]) -> None:
        try:
            send()
        except zenoh.ZError:
            self.lost += 1
        finally:
            query.drop()  # type: ignore[no-untyped-call]  # its stub has no return type
            self._places.release()


class Alive:
    """Whether anybody declares a liveliness token on a key."""

    def __init__(self, wake_up: WakeUp) -> None:
        self._wake_up = wake_up
        self._keys: set[str] = set()

    @property
    def alive(self) -> bool:
        """Whether a token is there now."""
        return bool(self._keys)

    def update(self, key: str, *, is_alive: bool) -> None:
        """Take the news of a token; for the receiving thread."""
        (self._keys.add if is_alive else self._keys.discard)(key)
        self._wake_up.set()


class ZenohSession:
    """An open session; use as a context manager. `wake_up` is set whenever something has arrived."""

    def __init__(self, session: zenoh.Session, *, receive_clock_ns: Callable[[], int]) -> None:
        self._session = session
        self._receive_clock_ns = receive_clock_ns
        self._publishers: dict[tuple[str, str], zenoh.Publisher] = {}
        self._held: list[object] = []  # what Zenoh would undeclare when nobody holds it
        self._lock = threading.Lock()
        self._replies = Replies()
        self.unpublished = 0
        self.wake_up = WakeUp()

    def __enter__(self) -> Self:
        """Return the session itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the session."""
        self.close()

    def publish(self, key: str, payload: bytes, encoding: str) -> None:
        """Send `payload` to whoever subscribes to `key`; `encoding` as of `link.payloads.cdr.encoding_of`.

        What cannot be sent is counted as `unpublished`: who publishes has other things to do.
        """
        try:
            self._send(key, payload, encoding)
        except (zenoh.ZError, PayloadError):
            self.unpublished += 1

    def _send(self, key: str, payload: bytes, encoding: str) -> None:
        self._publisher(key, encoding).put(payload)

    def is_heard(self, key: str, encoding: str) -> bool:
        """Return whether anybody subscribes to `key` now; `encoding` as it is published there."""
        status: object = self._publisher(key, encoding).matching_status  # its stub calls it a plain truth value
        return bool(getattr(status, "matching", status))

    def subscribe(self, key: str, *, capacity: int = INBOX_CAPACITY, bytes_max: int | None = None) -> Inbox:
        """Return the inbox of all that is published on `key`, which may hold wildcards."""
        inbox = Inbox(capacity=capacity, wake_up=self.wake_up, bytes_max=bytes_max)

        def receive(sample: zenoh.Sample) -> None:
            if inbox.has_room(len(sample.payload)):
                inbox.put(Sample(str(sample.key_expr), sample.payload.to_bytes(), self._receive_clock_ns()))

        self._held.append(self._session.declare_subscriber(key, receive))
        return inbox

    def declare_alive(self, key: str) -> None:
        """Show, by a token on `key`, that this program lives; the token goes when the session closes or dies."""
        self._held.append(self._session.liveliness().declare_token(key))

    def watch_alive(self, key: str) -> Alive:
        """Return whether there is a token on `key`, from now on; a token that is already there is seen, too."""
        alive = Alive(self.wake_up)

        def receive(sample: zenoh.Sample) -> None:
            alive.update(str(sample.key_expr), is_alive=sample.kind == zenoh.SampleKind.PUT)

        self._held.append(self._session.liveliness().declare_subscriber(key, receive, history=True))
        return alive

    def serve(self, key: str, handler: Callable[[bytes], bytes], encoding: str = "application/json") -> None:
        """Answer queries on `key` by `handler(payload)`, called on a thread of Zenoh's.

        A ValueError of the handler is answered as an error, with its text.
        """

        def answer(query: zenoh.Query) -> None:
            payload = b"" if query.payload is None else query.payload.to_bytes()
            try:
                reply = handler(payload)
            except ValueError as error:
                query.reply_err(str(error).encode(), encoding=zenoh.Encoding.TEXT_PLAIN)
            else:
                query.reply(key, reply, encoding=zenoh.Encoding(encoding))

        self._held.append(self._session.declare_queryable(key, answer))

    def serve_later(self, key: str, take: Callable[[bytes, Callable[[bytes], None]], None]) -> None:
        """Answer queries on `key` with JSON, by `take(payload, reply)`, which returns at once.

        `reply(answer)` may be called then or later, once, from any thread, and never waits or raises. Where more than
        `_REPLIES_MAX` answers are on their way it has no effect. A query whose `reply` is forgotten has no answer.
        """

        def receive(query: zenoh.Query) -> None:
            payload = b"" if query.payload is None else query.payload.to_bytes()

            def reply(answer: bytes) -> None:
                encoding = zenoh.Encoding("application/json")
                self._replies.put(query, lambda: query.reply(key, answer, encoding=encoding))

            take(payload, reply)

        self._held.append(self._session.declare_queryable(key, receive))

    def query(self, key: str, payload: bytes, timeout_s: float) -> list[bytes]:
        """Ask whoever serves `key` and return the answers, waiting for at most `timeout_s`; errors are left out."""
        replies = self._session.get(key, payload=payload, timeout=timeout_s, target=zenoh.QueryTarget.ALL)
        return [reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None]

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Ask like `query`, but at once return the inbox into which the answers come."""
        inbox = Inbox(capacity=INBOX_CAPACITY, wake_up=self.wake_up)

        def receive(reply: zenoh.Reply) -> None:
            sample = reply.ok
            if sample is not None and inbox.has_room(len(sample.payload)):
                inbox.put(Sample(str(sample.key_expr), sample.payload.to_bytes(), self._receive_clock_ns()))

        self._session.get(key, receive, payload=payload, timeout=timeout_s, target=zenoh.QueryTarget.ALL)
        return inbox

    def _publisher(self, key: str, encoding: str) -> zenoh.Publisher:
        publisher = self._publishers.get((key, encoding))
        if publisher is None:
            publisher = self._session.declare_publisher(
                key, encoding=zenoh.Encoding(encoding), congestion_control=zenoh.CongestionControl.BLOCK
            )
            self._publishers[key, encoding] = publisher
        return publisher

    def close(self) -> None:
        """Leave the network; a second call does nothing."""
        with self._lock:
            if not self._session.is_closed():
                self._replies.close()
                self._session.close()  # type: ignore[no-untyped-call]  # its stub has no return type
                self._held.clear()
                self._publishers.clear()
                self.wake_up.close()


def open_session(options: ZenohOptions, *, receive_clock_ns: Callable[[], int] = time.monotonic_ns) -> ZenohSession:
    """Return an open session.

    A peer or router returns at once and goes on connecting in the background, for ever. A client waits up to 5 s for
    its first router.

    Args:
        options: how to meet others.
        receive_clock_ns: stamps received samples.

    Raises:
        UserError: If the configuration file is missing or wrong, a port is in use or a client finds no router.
    """
    return ZenohSession(open_library_session(options), receive_clock_ns=receive_clock_ns)


def open_library_session(options: ZenohOptions) -> zenoh.Session:
    """Return the library's own session, for other layouts; see `open_session`."""
    config = _config(options)
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise UserError(_open_failure(options, config, str(error))) from error


def _config(options: ZenohOptions) -> zenoh.Config:
    config = zenoh.Config() if options.config_file is None else _config_from_file(options)
    if options.mode is not None:
        _insert(config, "mode", options.mode)
    if options.connect:
        _insert(config, "connect/endpoints", list(options.connect))
    if options.multicast_scouting is not None:
        _insert(config, "scouting/multicast/enabled", options.multicast_scouting)
    _fill(config, "mode", "peer")
    _fill(config, "scouting/multicast/enabled", False)
    _fill_connection(config)
    if options.listen:
        _insert(config, "listen/endpoints", list(options.listen))
    elif _get(config, "listen/endpoints") == _get(zenoh.Config(), "listen/endpoints"):
        # Zenoh's own default is plain TCP on all interfaces, beside whatever a file says of TLS.
        own = [] if options.config_file or _get(config, "mode") == "client" else ["tcp/127.0.0.1:0"]
        _insert(config, "listen/endpoints", own)
    if not options.insecure:
        _check_exposure(config)
    if _get(config, "mode") != "router" and _get(config, _MESSAGE_MAX_KEY) == _get(zenoh.Config(), _MESSAGE_MAX_KEY):
        _insert(config, _MESSAGE_MAX_KEY, options.message_max_bytes)
    if _get(config, _BLOCK_MAX_KEY) == _get(zenoh.Config(), _BLOCK_MAX_KEY):
        _insert(config, _BLOCK_MAX_KEY, _BLOCK_MAX_US)
    return config


def _check_exposure(config: zenoh.Config) -> None:
    protocols = _get(config, "transport/link/protocols")
    check_exposure(
        connect=_endpoints(config, "connect/endpoints"),
        listen=_endpoints(config, "listen/endpoints"),
        protocols=protocols if isinstance(protocols, list) else None,
        is_mutual=_get(config, "transport/link/tls/enable_mtls") is True,
        scouts=_get(config, "scouting/multicast/enabled") is True,
    )


def _endpoints(config: zenoh.Config, key: str) -> list[str]:
    """Return endpoints of all modes: those of the session's own, or a table with a list for each mode."""
    found = _get(config, key)
    lists = found.values() if isinstance(found, dict) else (found,)
    return [str(endpoint) for one in lists for endpoint in (one if isinstance(one, list) else ())]


def _fill_connection(config: zenoh.Config) -> None:
    """Make peers and routers connect for ever in the background, and clients, whose opening waits, give up."""
    is_client = _get(config, "mode") == "client"
    if is_client and not _get(config, "connect/endpoints") and not _get(config, "scouting/multicast/enabled"):
        raise UserError(f"--mode client needs a router to connect to: add --connect {DEFAULT_ENDPOINT}")
    _fill(config, "connect/timeout_ms", _CLIENT_CONNECT_TIMEOUT_MS if is_client else -1)
    _fill(config, "connect/exit_on_failure", is_client)


def _config_from_file(options: ZenohOptions) -> zenoh.Config:
    path = options.config_file
    if path is None or not path.is_file():
        raise UserError(f"--zenoh-config {path}: there is no such file")
    try:
        return zenoh.Config.from_json5(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, zenoh.ZError) as error:
        raise UserError(f"--zenoh-config {path}: {_plain(str(error))}") from error


def _get(config: zenoh.Config, key: str) -> object:
    return json.loads(config.get_json(key))


def _insert(config: zenoh.Config, key: str, value: object) -> None:
    config.insert_json5(key, json.dumps(value))


def _fill(config: zenoh.Config, key: str, value: object) -> None:
    """Set what the configuration file leaves open."""
    if _get(config, key) is None:
        _insert(config, key, value)


def _open_failure(options: ZenohOptions, config: zenoh.Config, text: str) -> str:
    endpoints = ", ".join(options.listen) or f"the endpoints of {options.config_file}"
    if "Address already in use" in text:
        return f"--listen {endpoints}: the port is in use, stop the other program or choose another port"
    if _get(config, "mode") == "client":
        return (
            f"--connect {', '.join(_endpoints(config, 'connect/endpoints'))}: no router answers there ({_plain(text)})"
        )
    return f"cannot open the Zenoh session (--listen {endpoints}): {_plain(text)}"


def _plain(text: str) -> str:
    """Return a message of the library on one line, without the places in its source code."""
    return " ".join(_SOURCE_PLACE.sub("", text).split())
