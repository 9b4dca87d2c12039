"""What a companion says when its partners do not come, or are not what it can fly."""

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.transports.opening import open_transport
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import Program, Programs, until

pytestmark = pytest.mark.wire


def last_line(companion: Program) -> str:
    """Return the one line on stderr with which it ended, by exit code 2."""
    assert companion.wait() == 2
    assert len(companion.told) == 1, companion.err.all
    line = companion.told[0]
    assert line.startswith("companion: ")
    return line


def test_no_heartbeat_names_the_device_and_that_nothing_came() -> None:
    port = free_udp_port()
    with Programs() as programs:
        said = last_line(programs.start("companion", "--mavlink", f"udpin:127.0.0.1:{port}", "--timeout", "0.2"))
    assert f"no heartbeat of an autopilot within 0.2 s on udpin:127.0.0.1:{port}: nothing was received" in said
    assert "check --mavlink" in said


def test_no_simulated_clock_names_its_key() -> None:
    with Programs() as programs:
        arguments = ("--mavlink", "udpin:127.0.0.1:0", "--timeout", "0.2", "--use-sim-time", "--ns", "site")
        said = last_line(programs.start("companion", *arguments))
    assert "no simulated clock on site/clock within 0.2 s: start the simulation" in said


def test_no_vehicle_fix_names_its_key() -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    with Programs() as programs:
        autopilot = ("--mavlink", f"udpout:127.0.0.1:{port}", "-l", endpoint, "--vehicle", "car")
        programs.start("sim-autopilot", *autopilot).err.wait_for("ready")
        companion = ("--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint, "--vehicle", "car", "--timeout", "3")
        said = last_line(programs.start("companion", *companion, "--start"))
    assert "no vehicle fix on decklander/car/fix within 3 s: start the vehicle" in said
    assert "--vehicle" in said


def test_a_peer_that_it_cannot_fly_is_told_by_what_it_is() -> None:
    port = free_udp_port()
    fixed_wing, px4 = mavlink.MAV_TYPE_FIXED_WING, mavlink.MAV_AUTOPILOT_PX4
    heartbeat = mavlink.MAVLink_heartbeat_message(fixed_wing, px4, 0, 0, mavlink.MAV_STATE_ACTIVE, 3)
    codec = MavlinkCodec(1, mavlink.MAV_COMP_ID_AUTOPILOT1)
    with Programs() as programs, open_transport(f"udpout:127.0.0.1:{port}") as transport:
        companion = programs.start("companion", "--mavlink", f"udpin:127.0.0.1:{port}", "--timeout", "2")

        def has_ended() -> bool:
            transport.send(codec.encode(heartbeat))
            return companion.out.finished(0.05)

        until(has_ended, "the companion's end")
        said = last_line(companion)
    assert "MAV_TYPE 1, which is no multirotor" in said
