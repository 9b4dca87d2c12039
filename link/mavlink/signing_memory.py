"""What signing remembers over restarts: without it, whatever was recorded in the last minute could be sent again.

The file has the newest time stamp of all and that of each stream, in a signature's units. It is written each second by
a thread of its own. So a stream's stamp may be a second old when the program is killed, and is raised by as much when
it is read: who goes on sending is past that before the program is back. One program keeps its stamps there: a second
one, which hears less, would put older ones in their place.
"""

import fcntl
import os
import time
from pathlib import Path
from typing import Annotated

import msgspec

from link.errors import UserError
from link.mavlink.signing import Signing, Streams, read_key, signing_timestamp
from link.program.whole_file import replace_file
from link.recording.recorder import BackgroundRecorder

_PERIOD_NS = 1_000_000_000
_PERIOD = _PERIOD_NS // 10_000  # in the signature's units
_BYTES_MAX = 1 << 22  # 256 systems with 256 components would take 1.8 MB

_Stamp = Annotated[int, msgspec.Meta(ge=0, lt=1 << 48)]
_Id = Annotated[int, msgspec.Meta(ge=0, lt=256)]


class _Kept(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The file: the newest stamp, and rows of system, component, link and that stream's newest."""

    timestamp: _Stamp
    streams: list[tuple[_Id, _Id, _Id, _Stamp]]


def restored(path: Path, key: bytes, t_ns: int) -> Signing:
    """Return signing that goes on where the file ended.

    Args:
        path: of the file; where there is none, what is a minute old may be taken.
        key: 32 bytes that both ends share.
        t_ns: UTC now, which may be behind.

    Raises:
        UserError: the file cannot be read, or is no such file.
    """
    kept = _read(path)
    streams: Streams = {row[:3]: row[3] + _PERIOD for row in kept.streams}
    return Signing(key, timestamp=max(kept.timestamp + _PERIOD, signing_timestamp(t_ns)), streams=streams)


def stamps_file(key_file: Path, stamps: Path | None) -> Path:
    """Return where the stamps are kept: beside the key, unless `stamps` says otherwise."""
    return key_file.with_name(f"{key_file.name}.stamps") if stamps is None else stamps


def open_signing(key_file: Path, stamps: Path | None) -> Signing:
    """Return signing with a key from a file that goes on where it ended the last time.

    Raises:
        UserError: a file cannot be read, or is none of these.
    """
    return restored(stamps_file(key_file, stamps), read_key(key_file), time.time_ns())


class SigningMemory:
    """Keeps what `signing` has seen.

    Args:
        path: of the file.
        signing: of the session.

    Raises:
        UserError: the file cannot be written, or another program keeps its stamps there.
    """

    def __init__(self, path: Path, signing: Signing) -> None:
        self._signing = signing
        self._due_ns: int | None = None
        try:
            sink = _File(path)
            sink.write(self._present())
        except BlockingIOError as error:
            what = "another program keeps time stamps of signatures there"
            raise UserError(f"{path}: {what}; end it, or name another place by --signing-stamps") from error
        except OSError as error:
            where = "name a place that may be written by --signing-stamps"
            raise UserError(f"{path}: cannot be written ({error.strerror}); {where}") from error
        self._recorder = BackgroundRecorder(sink, capacity=2)

    @property
    def why_lost(self) -> str:
        """Why stamps could not be written; empty while all were."""
        return self._recorder.why_dropped

    def poll(self, monotonic_ns: int) -> None:
        """Write when that is due; never waits."""
        if self._due_ns is None or monotonic_ns >= self._due_ns:
            self._due_ns = monotonic_ns + _PERIOD_NS
            self._recorder.put(self._present())

    def close(self) -> None:
        """Write the last."""
        self._recorder.put(self._present())
        self._recorder.close()

    def _present(self) -> _Kept:
        rows = [(*stream, stamp) for stream, stamp in self._signing.streams.items()]
        return _Kept(self._signing.timestamp, rows)


class _File:
    def __init__(self, path: Path) -> None:
        self._path = path
        self._lock = os.open(path.with_name(f"{path.name}.lock"), os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(self._lock)
            raise

    def write(self, record: _Kept) -> None:
        """Replace the file as a whole."""
        replace_file(self._path, msgspec.json.encode(record))

    def close(self) -> None:
        """Let another program keep its stamps there."""
        os.close(self._lock)


def _read(path: Path) -> _Kept:
    try:
        with path.open("rb") as file:
            return msgspec.json.decode(file.read(_BYTES_MAX), type=_Kept)
    except FileNotFoundError:
        return _Kept(0, [])
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); name another file by --signing-stamps") from error
    except (msgspec.DecodeError, RecursionError) as error:
        raise UserError(f"{path}: holds no time stamps of signatures ({error}); delete it") from error
