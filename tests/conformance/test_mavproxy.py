"""MAVProxy takes the stand-in for the autopilot that it stands in for: as ArduCopter over TCP, as PX4 over UDP."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conformance.mavproxy_client import MavProxy, mavproxy
from tests.conformance.programs import SPEED, StandIn, stand_in, wait

pytestmark = [pytest.mark.wire, pytest.mark.timeout(300)]

MISSION = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t52.4733\t13.4017\t89\t1
1\t0\t3\t22\t0\t0\t0\t0\t52.4733\t13.4017\t5\t1
2\t0\t3\t16\t0\t0\t0\t0\t52.4735\t13.4017\t6\t1
"""
FENCE = """QGC WPL 110
0\t0\t3\t5001\t3\t0\t0\t0\t52.4723\t13.4007\t0\t1
1\t0\t3\t5001\t3\t0\t0\t0\t52.4743\t13.4007\t0\t1
2\t0\t3\t5001\t3\t0\t0\t0\t52.4743\t13.4037\t0\t1
"""
RALLY = """QGC WPL 110
0\t0\t3\t5100\t0\t0\t0\t0\t52.4723\t13.4007\t20\t1
"""
PARAMETERS = {"px4": ("MPC_XY_CRUISE", 897), "ardupilot": ("WPNAV_ACCEL", 1395)}


@pytest.fixture(scope="module", params=["px4", "ardupilot"])
def autopilot(request: pytest.FixtureRequest) -> Iterator[StandIn]:
    """A stand-in for all cases of the module: none starts it anew."""
    # PX4 streams unasked; at four times real time MAVProxy takes most of a core to read it
    with stand_in(request.param, 2.0 if request.param == "px4" else SPEED) as here:
        yield here


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mavproxy")
    for name, text in (("mission.txt", MISSION), ("fence.txt", FENCE), ("rally.txt", RALLY)):
        (folder / name).write_text(text)
    return folder


@pytest.fixture(scope="module")
def client(autopilot: StandIn, folder: Path) -> Iterator[MavProxy]:
    over_udp = autopilot.firmware == "px4"
    udp, tcp = f"udpin:127.0.0.1:{autopilot.udp_port}", f"tcp:127.0.0.1:{autopilot.tcp_port}"
    with mavproxy(udp if over_udp else tcp, folder) as running:
        running.heard(f"Received {PARAMETERS[autopilot.firmware][1]} parameters")
        yield running


def test_mavproxy_fetches_shows_and_sets_parameters(client: MavProxy, autopilot: StandIn) -> None:
    name, _ = PARAMETERS[autopilot.firmware]
    client.type(f"param set {name} 7")  # which it sends when it is idle
    wait(lambda: client.ask(f"param show {name}", rf"{name} +\d+\.0").endswith(" 7.0"))
    client.ask(f"param fetch {name}", rf"{name} = 7\.0")


def test_mavproxy_arms_takes_off_and_lands(client: MavProxy, autopilot: StandIn) -> None:
    if autopilot.firmware == "ardupilot":
        client.ask("mode GUIDED", "Mode GUIDED")
    client.ask("arm throttle", "ARMED")
    height = "5" if autopilot.firmware == "ardupilot" else "95"  # PX4's is above the sea, where the ground is at 89 m
    client.ask(f"takeoff {height}", "NAV_TAKEOFF: ACCEPTED")
    if autopilot.firmware == "px4":  # whose modes MAVProxy cannot name
        client.heard(r"Mode TAKEOFF[\s\S]*Mode LOITER")
        client.ask("disarm", "COMPONENT_ARM_DISARM: TEMPORARILY_REJECTED")
        client.ask("disarm force", "DISARMED")
    else:
        wait(lambda: float(client.ask("alt", r"Altitude: +[-\d.]+").split()[1]) > 4.0)
        client.ask("setyaw 90 20 0", "CONDITION_YAW: ACCEPTED")
        client.ask("mode LAND", "Mode LAND")
        client.heard("Disarming motors")


def test_mavproxy_lists_and_downloads_the_log_of_that_flight(client: MavProxy, folder: Path) -> None:
    client.ask("log list", "numLogs 1")
    client.ask("log download latest flight.log", "Finished downloading")
    assert (folder / "flight.log").read_bytes()[:4] in {b"ULog", b"\xa3\x95\x80\x80"}


def test_mavproxy_sends_and_reads_missions(client: MavProxy, autopilot: StandIn) -> None:
    client.ask("wp load mission.txt", "TYPE_MISSION: ACCEPTED")
    frame = 6 if autopilot.firmware == "px4" else 3  # PX4 tells whole numbers in the frames named after them
    client.ask("wp list", rf"16 {frame} 52\.4735")


def test_mavproxy_lists_files(client: MavProxy, autopilot: StandIn) -> None:
    client.ask("ftp list", "etc" if autopilot.firmware == "px4" else "@PARAM")


def test_mavproxy_sends_fences_and_rally_points_and_switches_the_fence(client: MavProxy, autopilot: StandIn) -> None:
    if autopilot.firmware == "px4":
        pytest.skip("PX4 waits 5 s for the end of MAVProxy's last download, and has no switch")
    client.ask("fence load fence.txt", "TYPE_FENCE: ACCEPTED")
    client.ask("fence enable", "DO_FENCE_ENABLE: ACCEPTED")
    client.ask("fence disable", "DO_FENCE_ENABLE: ACCEPTED")
    client.ask("fence clear", "TYPE_FENCE: ACCEPTED")
    client.ask("rally load rally.txt", "TYPE_RALLY: ACCEPTED")
    client.ask("rally list", r"5100 3 52\.4723")


def test_mavproxy_reboots_it_where_it_can_be(client: MavProxy, autopilot: StandIn) -> None:
    client.ask("ping", "ping response")
    result = "DENIED" if autopilot.firmware == "px4" else "ACCEPTED"
    client.ask("reboot", f"PREFLIGHT_REBOOT_SHUTDOWN: {result}")
