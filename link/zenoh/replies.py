"""Answers to queries on their way out, by a thread of their own."""

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import zenoh

REPLIES_MAX = 256
"""Answers to queries that wait to be sent; more are asked for by nobody who means it."""


class Replies:
    """Sends answers to queries from a thread of its own: one who does not read them holds nobody else up.

    Attributes:
        lost: answers to who has gone, or that came after the end.
    """

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="replies")
        self._places = threading.BoundedSemaphore(REPLIES_MAX)
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
