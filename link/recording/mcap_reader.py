"""Reading recordings: all files of one start, in order, up to where each was written, complete or not."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from mcap.exceptions import McapError
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

from link.errors import UserError
from link.payloads.decklander_msgs import RosMessage
from link.recording.file_names import present_files


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recorded:
    """A message and when it was recorded."""

    message: RosMessage
    log_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingHead:
    """What a recording says of itself."""

    metadata: dict[str, str]
    attachments: dict[str, str]


def recordings(folder: Path, stem: str) -> list[list[Path]]:
    """Return the recordings in a folder, one for each start of the program, each with its files, oldest first.

    Raises:
        UserError: there are none.
    """
    files = present_files(folder, stem)
    if not files:
        raise UserError(f"{folder}: holds no recording {stem}_*.mcap; is this a run's folder?")
    return [[file.path for file in group] for _, group in groupby(files, lambda file: file.start)]


def recording_files(folder: Path, stem: str) -> list[Path]:
    """Return the files of the newest recording in a folder, oldest first.

    Raises:
        UserError: there are none.
    """
    return recordings(folder, stem)[-1]


def read_head(path: Path) -> RecordingHead:
    """Return what stands at the beginning of a file."""
    metadata: dict[str, str] = {}
    attachments: dict[str, str] = {}
    for record in _records(path):
        match record:
            case Metadata():
                metadata |= record.metadata
            case Attachment():
                attachments[record.name] = record.data.decode()
            case Message():
                break
    return RecordingHead(metadata=metadata, attachments=attachments)


def read_messages(files: list[Path]) -> Iterator[Recorded]:
    """Return the messages in the order of their recording."""
    for path in files:
        schemas: dict[int, str] = {}
        channels: dict[int, tuple[str, str]] = {}
        for record in _records(path):
            match record:
                case Schema():
                    schemas[record.id] = record.name
                case Channel():
                    channels[record.id] = (record.topic.removeprefix("/"), schemas[record.schema_id])
                case Message():
                    topic, type_name = channels[record.channel_id]
                    message = RosMessage(topic=topic, type_name=type_name, payload=record.data)
                    yield Recorded(message=message, log_ns=record.log_time)


def _records(path: Path) -> Iterator[object]:
    """Return the records of a file; one that breaks off ends there."""
    try:
        with path.open("rb") as file:
            try:
                yield from StreamReader(file).records
            except (McapError, EOFError, struct.error):
                return
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None
