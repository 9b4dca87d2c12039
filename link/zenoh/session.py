"""The Zenoh session: with the files beside it the only place that knows the Zenoh library.

Zenoh calls back on threads of its own; here these only put samples into inboxes, so that everything else runs in
the program's own loop. Samples are sent with congestion control BLOCK and default priority: with REAL_TIME and DROP
samples were seen to get lost on a busy machine.
"""

import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

import zenoh

from link.payloads.checks import PayloadError
from link.payloads.json_messages import JSON_ENCODING
from link.zenoh.inbox import Alive, Inbox, Sample, WakeUp
from link.zenoh.library_config import is_matched, open_library_session
from link.zenoh.options import DEFAULT_ENDPOINT, ZenohOptions
from link.zenoh.replies import Replies

__all__ = ["DEFAULT_ENDPOINT", "Alive", "Inbox", "Sample", "WakeUp", "ZenohOptions", "ZenohSession", "open_session"]

INBOX_CAPACITY = 1024
"""Ten seconds of a 100 Hz stream."""

SENSOR_BYTES_MAX = 8192
"""Of one fix, velocity, IMU or sighting; a ROS odometry takes 0.7 kB and its names. What is larger no sensor sends."""

_ALL = zenoh.QueryTarget.ALL
_EACH = zenoh.ConsolidationMode.NONE  # else the library hands on one answer for each key: the last one's, or a liar's


def taken(payload: zenoh.ZBytes, bytes_max: int | None) -> bytes:
    """Return the bytes of a payload, none of one that is larger than it may be."""
    return b"" if bytes_max is not None and len(payload) > bytes_max else payload.to_bytes()


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
        return is_matched(self._publisher(key, encoding))

    def subscribe(
        self,
        key: str,
        *,
        capacity: int = INBOX_CAPACITY,
        bytes_max: int | None = None,
        sample_bytes_max: int | None = None,
    ) -> Inbox:
        """Return the inbox of all that is published on `key`, which may hold wildcards.

        Args:
            key: of the samples.
            capacity: of the inbox, in samples.
            bytes_max: capacity of the inbox, in bytes; None for its default.
            sample_bytes_max: of one sample; a larger one comes as an empty one, which its reader counts as bad.
        """
        inbox = Inbox(capacity=capacity, wake_up=self.wake_up, bytes_max=bytes_max)
        self._fill(inbox, key, sample_bytes_max)
        return inbox

    def _fill(self, inbox: Inbox, key: str, sample_bytes_max: int | None) -> None:
        def receive(sample: zenoh.Sample) -> None:
            if inbox.has_room(len(sample.payload)):
                payload = taken(sample.payload, sample_bytes_max)
                inbox.put(Sample(str(sample.key_expr), payload, self._receive_clock_ns()))

        self._held.append(self._session.declare_subscriber(key, receive))

    def declare_alive(self, key: str) -> Callable[[], None]:
        """Show, by a token on `key`, that this program lives; the token goes when the session closes or dies.

        What is returned takes the token back.
        """
        token = self._session.liveliness().declare_token(key)
        self._held.append(token)

        def take_back() -> None:
            if token in self._held:
                self._held.remove(token)
                token.undeclare()  # type: ignore[no-untyped-call]  # its stub has no return type

        return take_back

    def watch_alive(self, key: str) -> Alive:
        """Return whether there is a token on `key`, from now on; a token that is already there is seen, too."""
        alive = Alive(self.wake_up)

        def receive(sample: zenoh.Sample) -> None:
            alive.update(str(sample.key_expr), is_alive=sample.kind == zenoh.SampleKind.PUT)

        self._held.append(self._session.liveliness().declare_subscriber(key, receive, history=True))
        return alive

    def serve(self, key: str, handler: Callable[[bytes], bytes], encoding: str = JSON_ENCODING) -> None:
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

        `reply(answer)` may be called then or later, once, from any thread, and never waits or raises. Where as many
        answers as `Replies` holds are on their way it has no effect. A query whose `reply` is forgotten has no answer.
        """

        def receive(query: zenoh.Query) -> None:
            payload = b"" if query.payload is None else query.payload.to_bytes()

            def reply(answer: bytes) -> None:
                encoding = zenoh.Encoding(JSON_ENCODING)
                self._replies.put(query, lambda: query.reply(key, answer, encoding=encoding))

            take(payload, reply)

        self._held.append(self._session.declare_queryable(key, receive))

    def query(self, key: str, payload: bytes, timeout_s: float) -> list[bytes]:
        """Ask all who serve `key` and return their answers, waiting for at most `timeout_s`; errors are left out."""
        replies = self._session.get(key, payload=payload, timeout=timeout_s, target=_ALL, consolidation=_EACH)
        return [reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None]

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Ask like `query`, but at once return the inbox into which the answers come."""
        inbox = Inbox(capacity=INBOX_CAPACITY, wake_up=self.wake_up)

        def receive(reply: zenoh.Reply) -> None:
            sample = reply.ok
            if sample is not None and inbox.has_room(len(sample.payload)):
                inbox.put(Sample(str(sample.key_expr), sample.payload.to_bytes(), self._receive_clock_ns()))

        self._session.get(key, receive, payload=payload, timeout=timeout_s, target=_ALL, consolidation=_EACH)
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
