"""Where operators' commands come in from Zenoh's threads, and their replies go out."""

import queue
from collections import deque
from concurrent.futures import Future

from companion.node import CompanionNode
from link import json_payloads
from link.messages import Command, CommandReply
from link.payload_checks import PayloadError

_REPLY_WAIT_S = 2.0


class CommandDesk:
    """Takes operators' commands from Zenoh's threads to the loop, and the replies back."""

    def __init__(self) -> None:
        self._waiting: queue.SimpleQueue[tuple[Command, Future[CommandReply]]] = queue.SimpleQueue()
        self._asked: deque[Future[CommandReply]] = deque()

    def handle(self, payload: bytes) -> bytes:
        """Answer a query; called from a thread of Zenoh's."""
        try:
            command = json_payloads.decode(Command, payload)
        except PayloadError as error:
            return json_payloads.encode(CommandReply(accepted=False, reason=str(error)))
        reply: Future[CommandReply] = Future()
        self._waiting.put((command, reply))
        try:
            return json_payloads.encode(reply.result(timeout=_REPLY_WAIT_S))
        except TimeoutError:
            reply.cancel()  # what was answered by a refusal must not be done later
            return json_payloads.encode(CommandReply(accepted=False, reason="the companion made no step in time"))

    def pass_on(self, node: CompanionNode) -> None:
        """Give the oldest command to the node, one at a time."""
        while not self._asked:
            try:
                command, reply = self._waiting.get_nowait()
            except queue.Empty:
                return
            if reply.set_running_or_notify_cancel():
                node.request(command)
                self._asked.append(reply)

    def answer(self, replies: list[CommandReply]) -> None:
        """Give the replies to whom they belong, in order."""
        for reply in replies:
            if self._asked:
                self._asked.popleft().set_result(reply)
