"""Where operators' commands come in from Zenoh's threads, and their replies go out.

What ends a landing goes first, and all who wait for the same command get the answer of one step, so that however many
ask, an abort waits for no more than the step under way. A command that no step has taken within two seconds is refused
and never done afterwards; the operator's query waits for longer.
"""

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from companion.runtime.node import CompanionNode
from link.messages import Command, CommandReply, Order
from link.payloads import json_messages
from link.payloads.checks import PayloadError

Reply = Callable[[bytes], None]
_FIRST_TO_LAST = (
    Command.ABORT,
    Command.HOLD,
    Command.RETURN,
    Command.START_ANYWAY,
    Command.START,
    Command.LAUNCH,
    Command.FOLLOW,
)
_WAITING_MAX = 64  # of each command; who comes when so many ask for the same hears nothing, and asks again
_WAIT_MAX_S = 2.0  # less than an operator's query waits
_ORDER_BYTES_MAX = 1024  # a station with all its digits takes a tenth; decoding 1 MB of names would stop the setpoints
_TOO_LARGE = CommandReply(accepted=False, reason=f"an order has {_ORDER_BYTES_MAX} bytes at most")
_LATE = CommandReply(accepted=False, reason="the companion made no step in time")
_REPLACED = CommandReply(accepted=False, reason="another follow came at the same time: ask again")


class _Asked(NamedTuple):
    """An order's sender: when it came, and how to answer."""

    order: Order
    came_s: float
    reply: Reply


class CommandDesk:
    """Takes operators' commands from Zenoh's threads to the loop, and the replies back.

    Args:
        now_s: a monotonic clock.
    """

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._lock = threading.Lock()
        self._waiting: dict[Command, deque[_Asked]] = {command: deque() for command in _FIRST_TO_LAST}
        self._asked: list[_Asked] = []

    def take(self, payload: bytes, reply: Reply) -> None:
        """Take a query, which is answered by `reply`, at once or after a step; called from a thread of Zenoh's."""
        if len(payload) > _ORDER_BYTES_MAX:
            reply(json_messages.encode(_TOO_LARGE))
            return
        try:
            order = json_messages.decode(Order, payload)
        except PayloadError as error:
            reply(json_messages.encode(CommandReply(accepted=False, reason=str(error))))
            return
        with self._lock:
            if len(self._waiting[order.command]) < _WAITING_MAX:
                self._waiting[order.command].append(_Asked(order, self._now_s(), reply))

    def pass_on(self, node: CompanionNode, local_ns: int) -> None:
        """Give the most urgent command to the node, if it makes a step now."""
        if self._asked or not node.is_due(local_ns):
            return
        for command in _FIRST_TO_LAST:
            self._asked = self._take_waiting(command)
            refusal = node.start_refusal() if self._asked and command is Command.START else None
            if refusal is not None:
                self.answer([refusal])
            elif self._asked:
                node.request(command, self._asked[-1].order.station)
                return

    def answer(self, replies: list[CommandReply]) -> None:
        """Give a step's reply to all who have asked for its command."""
        for reply in replies[:1]:
            asked, self._asked = self._asked, []
            _answer(asked, reply)

    def _take_waiting(self, command: Command) -> list[_Asked]:
        """Return who waits for a command; who has waited for too long, or wants another station, is refused."""
        with self._lock:
            waiting = list(self._waiting[command])
            self._waiting[command].clear()
        since_s = self._now_s() - _WAIT_MAX_S
        _answer([one for one in waiting if one.came_s < since_s], _LATE)
        in_time = [one for one in waiting if one.came_s >= since_s]
        _answer([one for one in in_time if one.order != in_time[-1].order], _REPLACED)
        return [one for one in in_time if one.order == in_time[-1].order]


def _answer(asked: list[_Asked], reply: CommandReply) -> None:
    payload = json_messages.encode(reply)
    for one in asked:
        one.reply(payload)
