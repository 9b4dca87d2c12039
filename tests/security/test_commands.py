"""An operator's command while somebody else floods the companion with commands."""

import signal
import time

import pytest

from link.messages import Command
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.attack.flood import ANSWER_MAX_S, FLOOD_HZ, Flood, ask
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import Programs, until

pytestmark = [pytest.mark.wire, pytest.mark.alone]

KEYS = Keys()
END_MAX_S = 5.0


def test_abort_is_answered_and_the_program_ends_beside_200_commands_a_second() -> None:
    endpoint = free_tcp_endpoint()
    with Programs() as programs, open_session(ZenohOptions(listen=(endpoint,))) as operator:
        device = f"udpin:127.0.0.1:{free_udp_port()}"
        companion = programs.start("companion", "--mavlink", device, "--timeout", "0", "-e", endpoint)
        companion.out.wait_for("ready")
        until(lambda: ask(operator, KEYS, Command.HOLD)[0] is not None, "the companion answers")
        with open_session(ZenohOptions(connect=(endpoint,))) as client, Flood(client, KEYS, Command.START) as flood:
            until(lambda: flood.asked > 2 * FLOOD_HZ, "the flood runs")
            waits_s = []
            for _ in range(5):
                reply, wait_s = ask(operator, KEYS, Command.ABORT)
                assert reply is not None
                waits_s.append(wait_s)
            assert sorted(waits_s)[2] < ANSWER_MAX_S, waits_s
            assert flood.answered > 50
            companion.send(signal.SIGINT)
            began_s = time.monotonic()
            companion.wait()
            assert time.monotonic() - began_s < END_MAX_S
