"""Where operators' commands come in from Zenoh's threads, and their replies go out.

A command that is answered by a refusal is never done afterwards: it is kept here, and can be taken back, until the step
that does it is made at once. From then on that step's own answer is waited for.
"""

import queue
from collections import deque
from concurrent.futures import Future

from companion.runtime.node import CompanionNode
from link.messages import Command, CommandReply
from link.payloads import json_messages
from link.payloads.checks import PayloadError

_REPLY_WAIT_S = 2.0  # for the step to begin
_STEP_WAIT_S = 0.5  # for it to end; together less than an operator's query waits


class CommandDesk:
    """Takes operators' commands from Zenoh's threads to the loop, and the replies back."""

    def __init__(self) -> None:
        self._waiting: queue.SimpleQueue[tuple[Command, Future[CommandReply]]] = queue.SimpleQueue()
        self._asked: deque[Future[CommandReply]] = deque()

    def handle(self, payload: bytes) -> bytes:
        """Answer a query; called from a thread of Zenoh's."""
        try:
            command = json_messages.decode(Command, payload)
        except PayloadError as error:
            return json_messages.encode(CommandReply(accepted=False, reason=str(error)))
        reply: Future[CommandReply] = Future()
        self._waiting.put((command, reply))
        return json_messages.encode(await_reply(reply))

    def pass_on(self, node: CompanionNode, local_ns: int) -> Command | None:
        """Give the oldest command to the node, one at a time, if it makes a step now; return it."""
        while not self._asked and node.is_due(local_ns):
            try:
                command, reply = self._waiting.get_nowait()
            except queue.Empty:
                return None
            if reply.set_running_or_notify_cancel():
                node.request(command)
                self._asked.append(reply)
                return command
        return None

    def answer(self, replies: list[CommandReply]) -> None:
        """Give the replies to whom they belong, in order."""
        for reply in replies:
            if self._asked:
                self._asked.popleft().set_result(reply)


def await_reply(reply: Future[CommandReply]) -> CommandReply:
    """Return the answer to a command, or that it was taken back, or that neither came in time."""
    try:
        return reply.result(timeout=_REPLY_WAIT_S)
    except TimeoutError:
        if reply.cancel():
            return CommandReply(accepted=False, reason="the companion made no step in time")
    try:
        return reply.result(timeout=_STEP_WAIT_S)
    except TimeoutError:
        return CommandReply(
            accepted=False, reason="the companion's step takes too long: it may still do it, see its status"
        )
