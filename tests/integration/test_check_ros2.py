"""`companion check` beside a vehicle that speaks ROS 2 over a router."""

import json
from pathlib import Path

import pytest

from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from sim_autopilot.runtime.config import DatumConfig
from tests.integration.programs import Programs
from tests.integration.ros2_landing import MAP
from tests.integration.ros_vehicle import DOMAIN

pytestmark = pytest.mark.wire


def test_check_hears_a_vehicle_of_a_ros_2_graph(tmp_path: Path) -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    topics = tmp_path / "topics.toml"
    topics.write_text(MAP.format(**DatumConfig().model_dump()), encoding="utf-8")
    client = ("-m", "client", "-e", endpoint)
    with Programs() as programs:
        programs.start("tests.integration.zenoh_router", endpoint).out.wait_for("ready")
        programs.start("tests.integration.ros_vehicle", endpoint, "1").out.wait_for("ready")
        link = f"udpout:127.0.0.1:{port}"
        world = programs.start("scenarios", "world", "straight_5", "--mavlink", link, *client)
        world.err.wait_for("ready")
        ros2 = ("--ros2", str(DOMAIN), "--ros2-map", str(topics))
        listening = ("--mavlink", f"udpin:127.0.0.1:{port}", "--duration", "3", "--json")
        check = programs.start("companion", "check", *listening, *ros2, *client)
        check.wait()
        by_name = {one["name"]: one for one in json.loads("\n".join(check.out.all))["findings"]}
    assert by_name["vehicle fixes"]["level"] == "pass"
    assert by_name["vehicle pad"]["level"] == "pass"
