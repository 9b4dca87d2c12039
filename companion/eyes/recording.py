"""The recording of what a detector saw, `eyes_000.mcap` and on: pictures, and the drawings that belong to them."""

from pathlib import Path

from msgspec import Struct

from companion.eyes.annotation import Drawing, drawing_message, jpeg_of
from companion.eyes.sources.frames import Captured
from link.messages import CompressedPicture
from link.payloads import cdr
from link.payloads.decklander_msgs import RosMessage
from link.recording.file_names import EYES_STEM
from link.recording.mcap_writer import McapRecording, RecordingSpec
from link.recording.recorder import BackgroundRecorder
from link.zenoh.keys import Keys

PERIOD_NS = 200_000_000
"""Between two pictures: five a second of 0.1 MB each fill the space of a recording in an hour."""
_CAPACITY = 10  # pictures that wait for the disk


class PictureRecord(Struct, frozen=True, kw_only=True):
    """A frame and what is drawn on it."""

    captured: Captured
    drawing: Drawing


def open_recorder(folder: Path, keys: Keys) -> BackgroundRecorder:
    """Return where frames are recorded, by a thread of its own.

    Raises:
        UserError: the folder cannot be written.
    """
    names = {"namespace": keys.namespace, "vehicle": keys.vehicle, "drone": keys.drone}
    store = McapRecording(RecordingSpec(folder=folder, stem=EYES_STEM, metadata=names))
    return BackgroundRecorder(EyesSink(store, keys), capacity=_CAPACITY)


class EyesSink:
    """Turns frames into messages of a recording."""

    def __init__(self, store: McapRecording, keys: Keys) -> None:
        self._store = store
        self._keys = keys
        self.close = store.close

    def write(self, record: PictureRecord) -> None:
        """Write a frame, and its drawing with the same stamp."""
        captured = record.captured
        picture = CompressedPicture(t_ns=captured.t_ns, format="jpeg", data=jpeg_of(captured.shades))
        kind = cdr.ROS_TYPES[CompressedPicture]
        topic = self._keys.camera_compressed
        self._store.add(RosMessage(topic=topic, type_name=kind, payload=cdr.encode(picture)), captured.t_ns)
        drawn = drawing_message(self._keys.pad_annotations, captured.t_ns, record.drawing, captured.size_px)
        self._store.add(drawn, captured.t_ns)
