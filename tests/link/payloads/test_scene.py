"""Scenes against independent authorities: Foxglove's own schemas, and a reader of MCAP that knows nothing of ours."""

from pathlib import Path
from typing import Any

import foxglove.messages
import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorSet
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from link.messages import PadGeometry
from link.payloads.decklander_msgs import RosMessage, typestore
from link.payloads.foxglove_msgs import DEFINITIONS, PACKAGE
from link.payloads.scene import Cone, Scene, location_message, log_message, scene_message, transform_message
from link.recording.mcap_writer import McapRecording, RecordingSpec

T_NS = 1_700_000_000_250_000_000
PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.4, antenna_to_pad_m=(0.0, 0.0, 0.0))
FULL = Scene(
    t_ns=T_NS,
    drone=((1.0, 2.0, 3.5), (0.8, 0.0, 0.6, 0.0)),
    vehicle=((10.0, -20.0, 0.3), (0.6, 0.0, 0.0, 0.8)),
    pad=PAD,
    cone=Cone(radius_at_pad_m=0.3, slope=0.35),
    forecast_enu_m=np.array([[10.0 + i, -20.0, 1.7] for i in range(11)]),
    forecast_std_m=np.array([[0.1 + 0.02 * i, 0.05, 0.3] for i in range(11)]),
    plan_enu_m=np.array([[1.0, 2.0, 3.5], [2.0, 1.0, 3.2]]),
    label="descend: waits",
)


def read_back(folder: Path, messages: list[RosMessage]) -> dict[str, Any]:
    recording = McapRecording(RecordingSpec(folder=folder, stem="scene"))
    for message in messages:
        recording.add(message, T_NS)
    recording.close()
    (file,) = folder.glob("*.mcap")
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        return {channel.topic: message for _, channel, _, message in reader.iter_decoded_messages()}


def published_fields() -> dict[str, list[str]]:
    """The fields of the messages of a scene and of a picture's annotations, as Foxglove's library has them."""
    kinds = foxglove.messages.SceneUpdate, foxglove.messages.ImageAnnotations
    return {
        message.name: [field.name for field in message.field]
        for kind in kinds
        for file in FileDescriptorSet.FromString(kind.get_schema().data).file
        if file.package == "foxglove"
        for message in file.message_type
    }


@pytest.mark.parametrize("name", DEFINITIONS)
def test_definition_has_the_fields_of_foxgloves_own_schema(name: str) -> None:
    fields = typestore().fielddefs[f"{PACKAGE}/{name}"][1]
    assert sorted(field for field, _ in fields) == sorted(published_fields()[name])


def test_kinds_of_lines_and_deletions_are_foxgloves() -> None:
    files = FileDescriptorSet.FromString(foxglove.messages.SceneUpdate.get_schema().data)
    line = next(m for f in files.file for m in f.message_type if m.name == "LinePrimitive")
    values = {value.name: value.number for value in line.enum_type[0].value}
    constants = {name: value for name, _, value in typestore().fielddefs[f"{PACKAGE}/LinePrimitive"][0]}
    assert constants == values
    assert FieldDescriptorProto.TYPE_ENUM in {field.type for field in line.field}


def test_scene_is_read_by_an_independent_reader(tmp_path: Path) -> None:
    transforms = transform_message(FULL)
    assert transforms is not None
    read = read_back(tmp_path, [transforms, scene_message(FULL, "scene")])
    placed = {one.child_frame_id: one for one in read["/tf"].transforms}
    assert {(one.header.frame_id, child) for child, one in placed.items()} == {
        ("map", "base_link"),
        ("map", "vehicle"),
        ("vehicle", "pad"),
    }
    turned = placed["base_link"].transform.rotation
    assert (turned.w, turned.x, turned.y, turned.z) == (0.8, 0.0, 0.6, 0.0)
    assert placed["pad"].transform.translation.z == 1.4
    scene = read["/scene"]
    assert not scene.deletions
    entities = {entity.id: entity for entity in scene.entities}
    assert {name: entity.frame_id for name, entity in entities.items()} == {
        "drone": "base_link",
        "vehicle": "vehicle",
        "cone": "pad",
        "forecast": "map",
        "plan": "map",
    }
    assert entities["drone"].texts[0].text == "descend: waits"
    assert [(point.x, point.z) for point in entities["plan"].lines[0].points] == [(1.0, 3.5), (2.0, 3.2)]


def test_cone_is_as_wide_as_configured_at_the_pad_and_above(tmp_path: Path) -> None:
    scene = read_back(tmp_path, [scene_message(FULL, "scene")])["/scene"]
    (wall,) = next(entity for entity in scene.entities if entity.id == "cone").cylinders
    assert 0.5 * wall.size.x * wall.bottom_scale == pytest.approx(0.3)
    assert 0.5 * wall.size.x * wall.top_scale == pytest.approx(0.3 + 0.35 * wall.size.z)
    assert wall.pose.position.z == pytest.approx(0.5 * wall.size.z)


def test_ellipses_are_one_standard_deviation_wide_and_one_a_second(tmp_path: Path) -> None:
    scene = read_back(tmp_path, [scene_message(FULL, "scene")])["/scene"]
    way, *rings = next(entity for entity in scene.entities if entity.id == "forecast").lines
    assert len(way.points) == 11
    assert len(rings) == 3
    for ring, index in zip(rings, (0, 5, 10), strict=True):
        along = [point.x for point in ring.points]
        across = [point.y for point in ring.points]
        assert (max(along) + min(along)) / 2 == pytest.approx(10.0 + index)
        assert (max(along) - min(along)) / 2 == pytest.approx(0.1 + 0.02 * index)
        assert (max(across) - min(across)) / 2 == pytest.approx(0.05)


def test_what_is_not_known_is_deleted(tmp_path: Path) -> None:
    nothing = Scene(t_ns=T_NS)
    assert transform_message(nothing) is None
    scene = read_back(tmp_path, [scene_message(nothing, "scene")])["/scene"]
    assert not scene.entities
    assert {one.id for one in scene.deletions} == {"drone", "vehicle", "cone", "forecast", "plan"}


def test_location_and_log_are_standard_messages(tmp_path: Path) -> None:
    there = location_message("location", T_NS, (0.9, -0.2, 61.0))
    read = read_back(tmp_path, [there, log_message("log", T_NS, "companion", "chase")])
    location, log = read["/location"], read["/log"]
    assert (location.latitude, location.longitude) == pytest.approx(tuple(np.degrees((0.9, -0.2))))
    assert location.altitude == 61.0
    assert (log.name, log.msg, log.level) == ("companion", "chase", 20)
    assert (log.stamp.sec, log.stamp.nanosec) == (1_700_000_000, 250_000_000)
