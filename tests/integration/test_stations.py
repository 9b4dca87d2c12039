"""A landing by plain MAVLink through the autopilot: real ground stations' libraries start, watch and break it off."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from companion.component.parameters import PARAMETERS
from companion.situation.phases import Phase
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.conformance.mavproxy_client import mavproxy
from tests.integration.observer import PASSES_SOON, Observer, observer
from tests.integration.programs import Programs

pytestmark = pytest.mark.wire


@contextmanager
def landing(firmware: str, *options: str) -> Iterator[tuple[Programs, Observer, int]]:
    """A drone and a vehicle with a companion that waits for a start, and the port of the autopilot's other link."""
    port, station_port, endpoint = free_udp_port(), free_udp_port(), free_tcp_endpoint()
    links = ("--mavlink", f"udpout:127.0.0.1:{port}", "--mavlink", f"udpout:127.0.0.1:{station_port}")
    flags = ("--firmware", firmware, "--instant")
    with Programs() as programs, observer(endpoint) as bystander:
        programs.start("ground-vehicle", "--scenario", PASSES_SOON, "--use-sim-time", "-l", endpoint)
        device = f"udpin:127.0.0.1:{port}"
        programs.start("companion", "--mavlink", device, "-e", endpoint, "--use-sim-time", *options)
        programs.start("sim-autopilot", *links, *flags, "-e", endpoint)
        bystander.wait_for_relative_position()
        yield programs, bystander, station_port


def test_mavsdk_lands_by_one_command() -> None:
    with landing("px4") as (programs, bystander, port):
        pilot = programs.start("tests.integration.mavsdk_pilot", f"udpin://127.0.0.1:{port}")
        bystander.wait_for_phase(Phase.SECURED)
        assert pilot.wait() == 0
        told = json.loads(pilot.out.all[-1])
        assert told["result"] == 0
        assert {10, 40, 60, 80} <= set(told["percents"])
        assert any("descend" in text for text in told["texts"])
        assert len(told["texts"]) < 40
        assert told["pads"] > 5


def test_mavsdk_fetches_what_describes_the_parameters() -> None:
    with landing("px4") as (programs, _, port):
        client = programs.start("tests.integration.mavsdk_metadata", f"udpin://127.0.0.1:{port}")
        assert client.wait() == 0
        described = {one["name"]: one for one in json.loads(client.out.all[-1])["parameters"]}
        assert set(described) == {one.name for one in PARAMETERS}
        assert described["DL_WAIT_ALT"]["units"] == "m"


def test_mavproxy_starts_and_aborts_a_landing(tmp_path: Path) -> None:
    with landing("ardupilot") as (_, bystander, port), mavproxy(f"udpin:127.0.0.1:{port}", tmp_path) as station:
        station.heard("online system 1")
        station.type("set target_component 191")
        station.ask("ftp list", r"parameters\.json\.xz")
        station.ask("long USER_1", "USER_1: IN_PROGRESS")
        station.heard("Decklander chase")
        station.ask("long USER_3", "USER_3: ACCEPTED")
        station.heard("command : 31010, result : 6")  # cancelled, which it has no name for
        bystander.wait_for_phase(Phase.HOLD)


def test_mavproxy_starts_and_aborts_a_landing_by_a_channel_of_the_transmitter(tmp_path: Path) -> None:
    switch = ("--set", "autopilot.pilot_switch.channel=7", "--set", "autopilot.pilot_switch.arms=true")
    with (
        landing("ardupilot", *switch) as (_, bystander, port),
        mavproxy(f"udpin:127.0.0.1:{port}", tmp_path) as station,
    ):
        station.heard("online system 1")
        for channels in ("all 1500", "7 2000"):
            station.type(f"rc {channels}")
        bystander.wait_for_phase(Phase.CHASE)
        station.type("rc 7 1000")
        bystander.wait_for_phase(Phase.HOLD)
        assert bystander.recording.status is not None
        assert bystander.recording.status.reason_code == "BROKEN_OFF"
