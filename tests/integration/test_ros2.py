"""A landing on a vehicle that speaks ROS 2 over a router, and what the graph then shows."""

import json
from pathlib import Path

import pytest

from link.ros2.options import Ros2Options
from link.ros2.session import open_ros2_session
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from scenarios.recordings.result import LANDED
from sim_autopilot.runtime.config import DatumConfig
from tests.integration.observer import Observer
from tests.integration.programs import Programs
from tests.integration.ros_vehicle import DOMAIN

pytestmark = pytest.mark.wire

SPEED = "3"
MAP = """
[vehicle]
odometry = "/localization/kinematic_state"
odometry_origin = [{latitude_deg}, {longitude_deg}, {altitude_m}]
[pad]
size_m = [1.5, 1.5]
height_m = 1.5
"""


def test_companion_lands_on_a_vehicle_that_only_follows_rmw_zenohs_design(tmp_path: Path) -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    topics = tmp_path / "topics.toml"
    topics.write_text(MAP.format(**DatumConfig().model_dump()), encoding="utf-8")
    client = ("-m", "client", "-e", endpoint)
    ros2 = ("--ros2", str(DOMAIN), "--ros2-map", str(topics))
    by_router = ZenohOptions(mode="client", connect=(endpoint,))
    with (
        open_session(ZenohOptions(mode="router", listen=(endpoint,))),
        Programs() as programs,
        open_ros2_session(by_router, Ros2Options(domain=DOMAIN), Keys(), ("/tests", "bystander")) as zenoh,
    ):
        vehicle = programs.start("tests.integration.ros_vehicle", endpoint)
        vehicle.out.wait_for("ready")
        bystander = Observer(zenoh, Keys())
        listening = ("--mavlink", f"udpin:127.0.0.1:{port}", "--start", "--use-sim-time")
        programs.start("companion", *listening, *ros2, *client)
        speaking = ("--mavlink", f"udpout:127.0.0.1:{port}", "--speed", SPEED)
        programs.start("scenarios", "world", "straight_5", *speaking, *client)
        bystander.wait_for_relative_position()
        graph = programs.start("scenarios", "ros2", "topics", "--domain", str(DOMAIN), "--json", *client)
        assert graph.wait() == 0
        shown = {row["topic"]: row for row in json.loads("".join(graph.out.all))["topics"]}
        state = shown["/localization/kinematic_state"]
        assert (state["type"], state["publishers"]) == ("nav_msgs/msg/Odometry", ["/localization/ekf_localizer"])
        assert "/drone/companion" in state["subscriptions"]
        assert shown["/drone/landing/status"]["publishers"] == ["/drone/companion"]
        assert bystander.wait_for_end().tier in LANDED
