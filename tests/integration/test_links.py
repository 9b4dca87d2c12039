"""Several links of the real simulated autopilot."""

import time

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.transports.opening import open_transport
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.programs import DEADLINE_S, Programs

pytestmark = pytest.mark.wire

BEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)


def test_clients_on_tcp_and_udp_hear_the_autopilot_and_each_other() -> None:
    tcp_port, udp_port = free_tcp_endpoint().rpartition(":")[2], free_udp_port()
    links = ("--mavlink", f"tcpin:127.0.0.1:{tcp_port}", "--mavlink", f"udpin:127.0.0.1:{udp_port}")
    with Programs() as programs:
        programs.start("sim-autopilot", *links, "-l", "tcp/127.0.0.1:0")
        devices = [f"tcp:127.0.0.1:{tcp_port}"] * 2 + [f"udpout:127.0.0.1:{udp_port}"] * 2
        transports = [open_transport(device) for device in devices]
        codecs = [MavlinkCodec(250 + number, 190) for number in range(4)]
        heard: list[set[int]] = [set() for _ in codecs]
        end_s = time.monotonic() + DEADLINE_S
        while not _all_met(heard):
            assert time.monotonic() < end_s, heard
            for transport, codec, systems in zip(transports, codecs, heard, strict=True):
                transport.send(codec.encode(BEAT))
                systems |= {one.get_srcSystem() for one in codec.decode(transport.receive(0.02))}
        for transport in transports:
            transport.close()


def _all_met(heard: list[set[int]]) -> bool:
    """Whether everybody heard the autopilot, and those on the other link."""
    return all({1, 250, 251} <= one for one in heard[2:]) and all({1, 252, 253} <= one for one in heard[:2])
