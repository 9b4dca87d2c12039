"""The view in Foxglove: what it sends of a state, and the layout."""

import json
from typing import Any, cast

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from link.errors import UserError
from link.messages import BodyTruth, PadGeometry
from link.payloads.decklander_msgs import RosMessage, typestore
from link.payloads.scene import Scene
from link.zenoh.keys import Keys
from scenarios.view.foxglove import FoxgloveView, scene_of
from scenarios.view.foxglove_layout import layout_json
from scenarios.view.state import Estimate, ViewState
from tests.scenarios.view.test_view import drone_at, status_with

KEYS = Keys(namespace="site", drone="d1")
DESCENT = CompanionConfig().descent
PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.4, antenna_to_pad_m=(0.0, 0.0, -0.1))


class Source:
    def __init__(self, state: ViewState) -> None:
        self.state = state

    def advance(self, _: float) -> ViewState:
        return self.state


class Server:
    port = 1

    def __init__(self) -> None:
        self.messages: list[tuple[int, RosMessage]] = []

    def add(self, message: RosMessage, log_ns: int) -> None:
        self.messages.append((log_ns, message))


def shown(state: ViewState, ticks: int) -> list[tuple[int, RosMessage]]:
    source, server = cast("Any", Source(state)), Server()
    view = FoxgloveView(source, DESCENT, KEYS, cast("Any", server))
    for tick in range(ticks):
        view.show(tick, 0.05 * tick)
    return server.messages


def test_transforms_come_each_time_scenes_every_second_and_a_phase_once() -> None:
    messages = shown(ViewState(t_ns=7, drone_truth=drone_at(7), status=status_with(armed=True)), 4)
    topics = [message.topic for _, message in messages]
    assert topics.count("tf") == 4
    assert topics.count("site/d1/companion/scene") == 2
    assert topics.count("site/d1/companion/log") == 1
    assert {log_ns for log_ns, _ in messages} == {7}


def test_nothing_is_sent_before_anything_is_known() -> None:
    assert shown(ViewState(), 2) == []


def test_vehicle_is_the_true_one_where_there_is_truth() -> None:
    estimate = Estimate(t_ns=0, position_enu_m=np.array([5.0, 6.0, 1.5]), velocity_enu_m_s=np.zeros(3), yaw_rad=0.0)
    known = ViewState(t_ns=1, estimate=estimate, pad=PAD)
    estimated = scene_of(known, DESCENT).vehicle
    assert estimated is not None
    assert estimated[0] == pytest.approx((5.0, 6.0, 0.0))
    true: BodyTruth = drone_at(1, height_m=0.2)
    scene: Scene = scene_of(ViewState(t_ns=1, estimate=estimate, pad=PAD, vehicle_truth=true), DESCENT)
    assert scene.vehicle == ((1.0, 2.0, 0.2), (1.0, 0.0, 0.0, 0.0))


def paths_in(node: Any) -> list[str]:
    """All topics, with what is shown of them, in a layout."""
    if isinstance(node, dict):
        found = [node["value"]] if isinstance(node.get("value"), str) else []
        found += [node[key] for key in ("followTopic", "topicToRender") if isinstance(node.get(key), str)]
        found += list(node["topics"]) if isinstance(node.get("topics"), dict) else []
        return found + [path for value in node.values() for path in paths_in(value)]
    return [path for value in node for path in paths_in(value)] if isinstance(node, list) else []


def test_layout_shows_topics_and_fields_that_a_recording_has() -> None:
    paths = paths_in(json.loads(layout_json(KEYS)))
    prefix = "/site/d1/companion/"
    assert len(paths) >= 9
    assert all(path.startswith(prefix) for path in paths)
    topics = {path.removeprefix(prefix).partition(".")[0] for path in paths}
    assert topics == {"scene", "step", "location", "log"}
    fields = {name for name, _ in typestore().fielddefs["decklander_msgs/msg/Step"][1]}
    shown_fields = {path.partition(".")[2].partition("[")[0] for path in paths if "." in path}
    assert shown_fields
    assert shown_fields <= fields


def test_missing_library_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(UserError, match=r"the extra 'foxglove'"):
        layout_json(KEYS)
