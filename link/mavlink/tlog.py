"""Recordings that ground stations read: before each frame, the time in microseconds as 8 bytes, big-endian."""

import struct
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from link.errors import UserError
from link.recording.disk import sync
from link.recording.file_names import free_path
from link.units import NS_PER_S

_TIME = struct.Struct(">Q")


class TlogWriter:
    """Writes frames of both directions to a file.

    Args:
        path: of the file; where it exists that is kept, and the next free of `<stem>_2` and so on is taken.

    Raises:
        UserError: The file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        try:
            self._file = free_path(path).open("xb")
        except OSError as error:
            raise UserError(f"{path}: cannot be written ({error.strerror}); choose another place") from error

    def write(self, frame: bytes, t_ns_utc: int) -> None:
        """Appends one frame.

        Args:
            frame: one whole MAVLink frame.
            t_ns_utc: when it was sent or received.
        """
        self._file.write(_TIME.pack(t_ns_utc // 1000) + frame)

    def sync(self) -> None:
        """Has what was written so far on the disk itself, as `disk.sync` does.

        Raises:
            OSError: It is not there.
        """
        self._file.flush()
        sync(self._file.fileno())

    def close(self) -> None:
        """Ends the recording."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class TlogFrames(NamedTuple):
    """Frames that were sent or received at the same time."""

    frames: list[bytes]
    t_ns_utc: int

    def size(self) -> int:
        """Return how many bytes they take in a recording."""
        return sum(_TIME.size + len(frame) for frame in self.frames)


class TlogSink:
    """A recorder's sink that writes a recording of frames; a power failure costs the last second.

    Args:
        path: of the file, as `TlogWriter` takes it.

    Raises:
        UserError: The file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._writer = TlogWriter(path)
        self._synced_ns = 0

    def write(self, record: TlogFrames) -> None:
        """Writes frames.

        Raises:
            OSError: They are not written.
        """
        for frame in record.frames:
            self._writer.write(frame, record.t_ns_utc)
        if abs(record.t_ns_utc - self._synced_ns) >= NS_PER_S:  # UTC may be set back
            self._writer.sync()
            self._synced_ns = record.t_ns_utc

    def close(self) -> None:
        """Ends the recording.

        Raises:
            OSError: Its end is missing.
        """
        self._writer.sync()
        self._writer.close()
