"""Reading recordings: all files of one start, in order, up to where each was written, complete or not.

Anybody may have made a file: what is damaged is one clear line, and nothing in it says how much memory is taken.
"""

import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import IO, Any

import zstandard
from mcap.exceptions import EndOfFile, McapError
from mcap.records import Attachment, Channel, Chunk, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from link.errors import UserError
from link.payloads.decklander_msgs import RosMessage
from link.recording.file_names import present_files
from link.zenoh.keys import Keys

_RECORD_BYTES_MAX = 1 << 26  # a hundred times the largest chunk that is written
_SHOWN = 40  # characters of what a file says


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recorded:
    """A message and when it was recorded."""

    message: RosMessage
    log_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingHead:
    """What a recording says of itself."""

    path: Path
    metadata: dict[str, str]
    attachments: dict[str, str]

    def value(self, name: str) -> str:
        """Return a value of the metadata.

        Raises:
            UserError: it is not there.
        """
        return self._found(self.metadata, name)

    @property
    def keys(self) -> Keys:
        """The keys under which its messages came.

        Raises:
            UserError: one of their names is not there, or none.
        """
        namespace, vehicle, drone = map(self.value, ("namespace", "vehicle", "drone"))
        try:
            return Keys(namespace, vehicle, drone)
        except UserError as error:
            raise UserError(f"{self.path}: names in it are none of a key's ({error})") from None

    def number(self, name: str, least: int, most: float = math.inf) -> int:
        """Return a whole number of the metadata.

        Raises:
            UserError: it is not there, none, or not from `least` to `most`.
        """
        text = self.value(name)
        try:
            found = int(text)
        except ValueError:
            found = least - 1
        if not least <= found <= most:
            bounds = f"from {least} on" if math.isinf(most) else f"from {least} to {most}"
            raise UserError(f"{self.path}: its {name} is no whole number {bounds}: {text[:_SHOWN]!r}")
        return found

    def attachment(self, name: str) -> str:
        """Return the text of an attached file.

        Raises:
            UserError: it is not there.
        """
        return self._found(self.attachments, name)

    def _found(self, table: dict[str, str], name: str) -> str:
        if name not in table:
            raise UserError(f"{self.path}: holds no {name}; is it a recording of a run?")
        return table[name]


def recordings(folder: Path, stem: str) -> list[list[Path]]:
    """Return the recordings in a folder, one for each start of the program, each with its files, oldest first.

    Raises:
        UserError: there are none.
    """
    if folder.is_file():
        raise UserError(f"{folder}: is a file of a recording, which may have several; name its folder {folder.parent}")
    files = present_files(folder, stem)
    if not files:
        raise UserError(f"{folder}: holds no recording {stem}_*.mcap; name a run that was flown without --no-record")
    return [[file.path for file in group] for _, group in groupby(files, lambda file: file.start)]


def recording_files(folder: Path, stem: str) -> list[Path]:
    """Return the files of the newest recording in a folder, oldest first.

    Raises:
        UserError: there are none.
    """
    return recordings(folder, stem)[-1]


def read_head(path: Path) -> RecordingHead:
    """Return what stands at the beginning of a file.

    Raises:
        UserError: it cannot be read, or is damaged.
    """
    metadata: dict[str, str] = {}
    attachments: dict[str, str] = {}
    for record in _records(path):
        match record:
            case Metadata():
                metadata |= record.metadata
            case Attachment():
                attachments[record.name] = _text(path, record)
            case Message():
                break
    return RecordingHead(path=path, metadata=metadata, attachments=attachments)


def read_messages(files: list[Path]) -> Iterator[Recorded]:
    """Return the messages in the order of their recording.

    Raises:
        UserError: one of the files cannot be read, or is damaged.
    """
    for path in files:
        schemas: dict[int, str] = {}
        channels: dict[int, tuple[str, str]] = {}
        for record in _records(path):
            match record:
                case Schema():
                    schemas[record.id] = record.name
                case Channel():
                    channels[record.id] = (record.topic.removeprefix("/"), schemas.get(record.schema_id, ""))
                case Message():
                    if record.channel_id not in channels:
                        raise UserError(_damaged(path, f"there is no channel {record.channel_id}"))
                    topic, type_name = channels[record.channel_id]
                    message = RosMessage(topic=topic, type_name=type_name, payload=record.data)
                    yield Recorded(message=message, log_ns=record.log_time)


def _text(path: Path, attachment: Attachment) -> str:
    try:
        return attachment.data.decode()
    except UnicodeDecodeError as error:
        raise UserError(_damaged(path, f"{attachment.name[:_SHOWN]}: {error.reason}")) from None


def _records(path: Path) -> Iterator[object]:
    """Return the records of a file; one that breaks off ends there."""
    if path.is_fifo():
        raise UserError(_damaged(path, "it is a pipe"))  # which would be waited for without an end
    try:
        with path.open("rb") as file:
            stream: Any = _BoundedFile(file, path.stat().st_size)
            try:
                for record in StreamReader(stream, emit_chunks=True, record_size_limit=_RECORD_BYTES_MAX).records:
                    yield from _opened(record)
            except (EndOfFile, EOFError, struct.error):
                return
            except (McapError, zstandard.ZstdError, ValueError, OverflowError, MemoryError) as error:
                raise UserError(_damaged(path, str(error))) from None
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None


class _BoundedFile:
    """A file of which no more is asked for than there is, whatever a length in it says."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file = file
        self._left = size

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes, fewer at the end."""
        data = self._file.read(self._left if size < 0 else min(size, self._left))
        self._left -= len(data)
        return data


def _opened(record: object) -> list[object]:
    """Return what a chunk holds, any other record by itself.

    Raises:
        ValueError: it would be larger than any that is written.
    """
    if not isinstance(record, Chunk):
        return [record]
    if record.compression not in {"", "zstd"}:
        raise ValueError(f"its compression {record.compression[:_SHOWN]!r} is not one of ours")
    told = record.uncompressed_size
    if record.compression:
        told = max(told, zstandard.get_frame_parameters(record.data).content_size)
    if told > _RECORD_BYTES_MAX:
        raise ValueError(f"a chunk of {told} bytes, {_RECORD_BYTES_MAX} are the most")
    return list(breakup_chunk(record))


def _damaged(path: Path, why: str) -> str:
    plain = why.partition(", invalid magic")[0]  # whose bytes help nobody
    return f"{path}: is damaged, or no recording ({plain or 'it makes no sense'}); name another one"
