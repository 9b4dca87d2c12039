"""An operator's command while somebody else floods the companion with commands."""

import signal
import threading
import time

import pytest

from link.messages import Command, CommandReply, Order
from link.payloads import json_messages
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import Programs, until

pytestmark = [pytest.mark.wire, pytest.mark.alone]

KEYS = Keys()
FLOOD_HZ = 200.0
ANSWER_MAX_S = 0.5
END_MAX_S = 5.0


class Flood:
    """Starts asked for by one client, many times a second, until the end of a `with` block."""

    def __init__(self, zenoh: ZenohSession) -> None:
        self._zenoh = zenoh
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
    def answered(self) -> int:
        """How many of the first hundred have an answer."""
        return sum(bool(inbox.take()) for inbox in self._answers[:100])

    def _run(self) -> None:
        start = json_messages.encode(Order(command=Command.START))
        while not self._ends.wait(1.0 / FLOOD_HZ):
            self._answers.append(self._zenoh.ask(KEYS.landing_command, start, 3.0))

    @property
    def asked(self) -> int:
        return len(self._answers)


def asked(zenoh: ZenohSession, command: Command) -> tuple[CommandReply | None, float]:
    """Return the answer to a command, and after how many seconds it came."""
    began_s = time.monotonic()
    answers = zenoh.query(KEYS.landing_command, json_messages.encode(Order(command=command)), 20.0)
    return json_messages.decode(CommandReply, answers[0]) if answers else None, time.monotonic() - began_s


def test_abort_is_answered_and_the_program_ends_beside_200_commands_a_second() -> None:
    endpoint = free_tcp_endpoint()
    with Programs() as programs, open_session(ZenohOptions(listen=(endpoint,))) as operator:
        device = f"udpin:127.0.0.1:{free_udp_port()}"
        companion = programs.start("companion", "--mavlink", device, "--timeout", "0", "-e", endpoint)
        companion.out.wait_for("ready")
        until(lambda: asked(operator, Command.HOLD)[0] is not None, "the companion answers")
        with open_session(ZenohOptions(connect=(endpoint,))) as client, Flood(client) as flood:
            until(lambda: flood.asked > 2 * FLOOD_HZ, "the flood runs")
            waits_s = []
            for _ in range(5):
                reply, wait_s = asked(operator, Command.ABORT)
                assert reply is not None
                waits_s.append(wait_s)
            assert sorted(waits_s)[2] < ANSWER_MAX_S, waits_s
            assert flood.answered > 50
            companion.send(signal.SIGINT)
            began_s = time.monotonic()
            companion.wait()
            assert time.monotonic() - began_s < END_MAX_S
