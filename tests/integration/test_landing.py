"""The landing over real UDP and real Zenoh, by the README's four programs."""

import pytest

from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from scenarios.recordings.result import LANDED
from tests.integration.observer import PASSES_SOON, observer
from tests.integration.programs import Programs

pytestmark = pytest.mark.wire


def test_four_programs_land_on_command_with_the_companion_started_last() -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    with Programs() as programs, observer(endpoint) as bystander:
        programs.start("ground-vehicle", "--scenario", PASSES_SOON, "--use-sim-time", "-l", endpoint)
        programs.start("sim-autopilot", "--mavlink", f"udpout:127.0.0.1:{port}", "-e", endpoint)
        bystander.wait_for_time(1.0)
        programs.start("companion", "--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint, "--use-sim-time")
        bystander.wait_for_relative_position()
        operator = programs.start("scenarios", "command", "start", "-e", endpoint)
        assert (operator.wait(), operator.out.all) == (0, ["accepted"])
        assert bystander.wait_for_end().tier in LANDED
