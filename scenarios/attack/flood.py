"""More commands than anybody answers, and one among them that counts."""

import threading
import time

from link.messages import Command, CommandReply, Order
from link.payloads import json_messages
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession

FLOOD_HZ = 200.0
ANSWER_MAX_S = 0.5
"""Within which an abort is answered all the same."""
_QUERY_S = 20.0
_FLOOD_QUERY_S = 3.0


def order_of_many_names() -> bytes:
    """Return an order of 0.9 MB, as much as Zenoh takes, whose names are all unknown but one."""
    return b'{"command": "hold", %s}' % b", ".join(b'"%d": 0' % name for name in range(80_000))


class Flood:
    """A command asked for by one client, many times a second, until the end of a `with` block."""

    def __init__(self, zenoh: ZenohSession, keys: Keys, command: Command) -> None:
        self._zenoh = zenoh
        self._keys = keys
        self._payload = json_messages.encode(Order(command=command))
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._answers: list[Inbox] = []

    def __enter__(self) -> "Flood":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join()

    @property
    def asked(self) -> int:
        """How many by now."""
        return len(self._answers)

    @property
    def answered(self) -> int:
        """How many of the first hundred have an answer."""
        return sum(bool(inbox.take()) for inbox in self._answers[:100])

    def _run(self) -> None:
        while not self._ends.wait(1.0 / FLOOD_HZ):
            self._answers.append(self._zenoh.ask(self._keys.landing_command, self._payload, _FLOOD_QUERY_S))


def ask(zenoh: ZenohSession, keys: Keys, command: Command) -> tuple[CommandReply | None, float]:
    """Return the answer to a command, None where there is none, and after how many seconds it came."""
    began_s = time.monotonic()
    answers = zenoh.query(keys.landing_command, json_messages.encode(Order(command=command)), _QUERY_S)
    return json_messages.decode(CommandReply, answers[0]) if answers else None, time.monotonic() - began_s
