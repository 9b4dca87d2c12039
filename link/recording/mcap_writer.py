"""A recording as MCAP files in a folder, with ROS 2 schemas: rotated by size, the oldest given up for the newest.

What earlier starts have recorded there is never overwritten; it counts, and is given up, like this one's oldest files.
Each file is complete in itself: it repeats the metadata, the attachments and the schemas.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from io import RawIOBase
from pathlib import Path
from typing import Any

from mcap.well_known import Profile, SchemaEncoding
from mcap.writer import CompressionType, Writer

from link.errors import UserError
from link.payloads.decklander_msgs import RosMessage, definition
from link.recording.disk import sync
from link.recording.file_names import present_files, recording_path
from link.recording.recorder import RecordsLost

_CHUNK_BYTES = 128 * 1024  # what is lost at most when the power fails, and how long compressing takes at once
_PATIENCE = 2_000  # records that are dropped after the disk failed before it is tried again


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingSpec:
    """What a recording is called, holds beside its messages, and may take.

    Attributes:
        folder: made when it is missing, also where it was deleted meanwhile.
        stem: of the files' names, `<stem>_000.mcap` and so on (`link.recording.file_names`).
        metadata: such as versions.
        attachments: texts by file name, such as the configuration.
        file_max_bytes: after which the next file is begun.
        total_max_bytes: of all files of this stem in the folder; the oldest are deleted.
    """

    folder: Path
    stem: str
    metadata: Mapping[str, str] = field(default_factory=dict)
    attachments: Mapping[str, str] = field(default_factory=dict)
    file_max_bytes: int = 256_000_000
    total_max_bytes: int = 2_000_000_000


class _WholeRecords(RawIOBase):
    """A file that holds each write in full or not at all, so that a full disk leaves no half of a record."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("xb", buffering=0)
        self.size = 0

    def writable(self) -> bool:
        """Return that it is."""
        return True

    def tell(self) -> int:
        """Return the size."""
        return self.size

    def write(self, data: Any) -> int:
        """Write all of `data`.

        Raises:
            OSError: nothing of it is written.
        """
        left = memoryview(data)
        try:
            while left:
                left = left[self._file.write(left) or 0 :]
        except OSError:
            self._file.truncate(self.size)
            self._file.seek(self.size)
            raise
        self.size += len(data)
        return len(data)

    def sync(self) -> None:
        """Have what was written on the disk itself, as `disk.sync` does."""
        sync(self._file.fileno())

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()


class _Unbuffered:
    """What MCAP's writer takes for a stream that it need not buffer itself."""

    def __init__(self, file: _WholeRecords) -> None:
        self.write, self.tell = file.write, file.tell
        self.flush = partial(bool, None)


class McapFile:
    """One file of a recording.

    Args:
        path: of a file that does not exist yet.
        spec: of the recording.

    Raises:
        OSError: it exists, or cannot be written.
    """

    def __init__(self, path: Path, spec: RecordingSpec) -> None:
        self.path = path
        self._file = _WholeRecords(path)
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._sequences: dict[str, int] = {}
        self.pending = 0  # messages that are not in the file yet
        stream: Any = _Unbuffered(self._file)
        self._writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.ZSTD)
        try:
            self._writer.start(profile=Profile.ROS2, library="decklander")
            self._writer.add_metadata("decklander", dict(spec.metadata))
            for name, text in spec.attachments.items():
                self._writer.add_attachment(0, 0, name, "text/plain", text.encode())
        except OSError:
            self._file.close()
            path.unlink(missing_ok=True)  # the next try, once there is room again, takes the same name
            raise

    @property
    def size(self) -> int:
        """Bytes written so far."""
        return self._file.size

    def add(self, message: RosMessage, log_ns: int) -> None:
        """Add a message that was recorded at `log_ns`.

        Raises:
            OSError: what was added since the last chunk may be lost, and the file is to be abandoned.
        """
        topic = message.topic
        channel = self._channels.get(topic)
        if channel is None:
            channel = self._channels[topic] = self._register(topic, message.type_name)
        sequence = self._sequences[topic] = self._sequences.get(topic, -1) + 1
        size = self.size
        self.pending += 1
        try:
            self._writer.add_message(channel, log_ns, message.payload, log_ns, sequence)
        finally:  # an index that fails comes after its chunk
            if self.size > size:
                self._file.sync()
                self.pending = 0

    def finish(self) -> None:
        """Complete the file.

        Raises:
            OSError: it has no summary; what was written before can be read.
        """
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]  # the library leaves its return type out
            self._file.sync()
        finally:
            self._file.close()

    def abandon(self) -> None:
        """Close the file as it is."""
        self._file.close()

    def _register(self, topic: str, type_name: str) -> int:
        schema = self._schemas.get(type_name)
        if schema is None:
            text = definition(type_name).encode()
            schema = self._schemas[type_name] = self._writer.register_schema(type_name, SchemaEncoding.ROS2, text)
        return self._writer.register_channel(f"/{topic}", "cdr", schema)


class McapRecording:
    """A recording over as many files as it needs.

    Args:
        spec: of the recording.

    Raises:
        UserError: the folder cannot be written.
    """

    def __init__(self, spec: RecordingSpec) -> None:
        self._spec = spec
        self._count = self._skip = 0
        self._file: McapFile | None = None
        try:
            earlier = present_files(spec.folder, spec.stem)
            self._start = earlier[-1].start + 1 if earlier else 1
            self._files = [file.path for file in earlier]
            self._file = self._next_file()
        except OSError as error:
            raise UserError(
                f"{spec.folder}: cannot be recorded into ({error.strerror}); choose another place"
            ) from error

    def add(self, message: RosMessage, log_ns: int) -> None:
        """Add a message that was recorded at `log_ns`.

        Raises:
            RecordsLost: it is not written, nor are those before it that were not in the file yet.
            OSError: it is not written; after some more messages a new file is tried.
        """
        if self._skip:
            self._skip -= 1
            raise OSError("the disk has failed a moment ago")
        try:
            if self._file is None:
                self._file = self._next_file()
            self._file.add(message, log_ns)
            if self._file.size >= self._spec.file_max_bytes:
                full, self._file = self._file, None
                full.finish()
        except OSError as error:
            self._skip = _PATIENCE
            file, self._file = self._file, None
            if file is None:
                raise
            file.abandon()
            raise RecordsLost(file.pending, error) from error

    def close(self) -> None:
        """Complete the last file.

        Raises:
            OSError: it has no summary.
        """
        if self._file is not None:
            file, self._file = self._file, None
            file.finish()

    def _next_file(self) -> McapFile:
        self._spec.folder.mkdir(parents=True, exist_ok=True)
        self._delete_oldest()
        path = recording_path(self._spec.folder, self._spec.stem, self._start, self._count)
        file = McapFile(path, self._spec)
        self._files.append(path)
        self._count += 1
        return file

    def _delete_oldest(self) -> None:
        """Make room for one more file inside the limit of them all."""
        sizes = [path.stat().st_size if path.exists() else 0 for path in self._files]
        while self._files and sum(sizes) + self._spec.file_max_bytes > self._spec.total_max_bytes:
            self._files.pop(0).unlink(missing_ok=True)
            sizes.pop(0)
