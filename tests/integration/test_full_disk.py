"""A companion whose disk takes nothing more: it says so, goes on, obeys and ends as ever."""

import resource
import signal
from pathlib import Path

import pytest

from link.messages import Command, Order
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions
from scenarios.commands.operator import send_order
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import Programs

pytestmark = pytest.mark.wire


def test_recording_that_cannot_be_written_is_told_while_it_is_so_and_ends_nothing(tmp_path: Path) -> None:
    device, endpoint = f"127.0.0.1:{free_udp_port()}", free_tcp_endpoint()
    with Programs(tmp_path) as programs:
        programs.start("sim-autopilot", "--mavlink", f"udpout:{device}", "-l", endpoint).err.wait_for("ready")
        told = ("--record", "flight", "--tlog", "flight.tlog", "--timing", "timing.json")
        companion = programs.start("companion", "--mavlink", f"udpin:{device}", "-e", endpoint, "--timeout", "0", *told)
        companion.out.wait_for("autopilot found")
        resource.prlimit(companion.pid, resource.RLIMIT_FSIZE, (0, 0))
        companion.out.wait_for("records are lost: the disk is full or too slow")
        reply = send_order(Order(command=Command.ABORT), Keys(), ZenohOptions(connect=(endpoint,)))
        assert "nothing to abort" in reply.reason
        companion.send(signal.SIGINT)
        assert companion.wait() == 0
        assert any("records are lost, the disk of flight is full or too slow" in line for line in companion.told)
        assert not any("Traceback" in line for line in companion.err.all)
