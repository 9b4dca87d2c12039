"""What a detector saw is recorded with the picture that it saw it in, and shown."""

from pathlib import Path
from typing import Any

import pytest

from companion.eyes.annotation import drawing_of
from companion.eyes.picture import WholePicture
from companion.eyes.recording import PictureRecord, open_recorder
from companion.eyes.sight import SightMemory, sight_step
from companion.eyes.sources.frames import Captured, gray_of_file
from link.messages import CompressedPicture
from link.payloads import cdr
from link.payloads.decklander_msgs import typestore
from link.recording.file_names import EYES_STEM
from link.recording.mcap_reader import read_messages, recording_files
from link.zenoh.keys import Keys
from tests.companion.eyes.frames import case, system

KEYS = Keys()


def test_recording_holds_the_picture_and_its_drawing_with_one_stamp(tmp_path: Path) -> None:
    one = case(4.0, board=system().board.config)
    _, sight = sight_step(SightMemory(), one.frame, system())
    drawing = drawing_of(sight, system())
    assert isinstance(one.frame.picture, WholePicture)
    captured = Captured(t_ns=one.frame.t_ns, shades=one.frame.picture.shades)
    recorder = open_recorder(tmp_path, KEYS)
    recorder.put(PictureRecord(captured=captured, drawing=drawing))
    recorder.close()
    by_topic = {each.message.topic: each for each in read_messages(recording_files(tmp_path, EYES_STEM))}
    assert by_topic.keys() == {KEYS.camera_compressed, KEYS.pad_annotations}
    picture = cdr.decode(CompressedPicture, by_topic[KEYS.camera_compressed].message.payload)
    assert picture.t_ns == captured.t_ns
    assert abs(gray_of_file(picture).astype(float) - captured.shades).mean() < 3.0
    recorded = by_topic[KEYS.pad_annotations].message
    drawn: Any = typestore().deserialize_cdr(recorded.payload, recorded.type_name)
    assert len(drawn.points) == 1 + len(sight.tags)
    corner = drawn.points[0].points[0]
    assert (corner.x - 0.5, corner.y - 0.5) == pytest.approx(drawing.outlines[0][0][0])
    assert drawn.texts[0].text == drawing.text
