"""A landing on a vehicle that speaks ROS 2 over a router, and what the graph then shows."""

import json
from pathlib import Path

import pytest

from scenarios.recordings.result import LANDED
from tests.integration.programs import Programs
from tests.integration.ros2_landing import land
from tests.integration.ros_vehicle import DOMAIN

pytestmark = pytest.mark.wire


def check_graph(programs: Programs, client: tuple[str, ...]) -> None:
    graph = programs.start("scenarios", "ros2", "topics", "--domain", str(DOMAIN), "--json", *client)
    assert graph.wait() == 0
    shown = {row["topic"]: row for row in json.loads("".join(graph.out.all))["topics"]}
    state = shown["/localization/kinematic_state"]
    assert (state["type"], state["publishers"]) == ("nav_msgs/msg/Odometry", ["/localization/ekf_localizer"])
    assert "/drone/companion" in state["subscriptions"]
    assert shown["/drone/landing/status"]["publishers"] == ["/drone/companion"]


def test_companion_lands_on_a_vehicle_that_only_follows_rmw_zenohs_design(tmp_path: Path) -> None:
    assert land(tmp_path, 1, check_graph).tier in LANDED
