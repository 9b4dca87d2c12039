"""MAVLink 2 signing: frames that prove who sent them, and when.

A signature is a link id, a timestamp in units of 10 us since 2015-01-01 UTC (48 bits), and the first 48 bits of the
SHA-256 of key, frame, link id and timestamp. On each stream (system, component, link id) timestamps only grow.
Source: https://mavlink.io/en/guide/message_signing.html.
"""

import hashlib
import hmac
from pathlib import Path

from link.errors import UserError
from link.mavlink.contents import with_checksum
from link.mavlink.dialect import mavlink
from link.program.text import read_bounded

KEY_BYTES = 32
SIGNING_EPOCH_NS = 1_420_070_400 * 10**9
"""2015-01-01 UTC."""

_UNIT_NS = 10_000
_TIMESTAMP_MAX = (1 << 48) - 1
_NEW_STREAM_LATE_MAX = 60 * 10**9 // _UNIT_NS
_CHECKSUM_BYTES = 2
_SIGNATURE_BYTES = 6
_STAMP_BYTES = 7  # link id and timestamp
_RADIO_IDS = (mavlink.MAVLINK_MSG_ID_RADIO, mavlink.MAVLINK_MSG_ID_RADIO_STATUS)  # a radio has no key

Streams = dict[tuple[int, int, int], int]
"""The newest timestamp of each (system, component, link id) that was heard."""


def signing_timestamp(t_ns: int) -> int:
    """A UTC time as a signature has it; 0 before 2015."""
    return min(max((t_ns - SIGNING_EPOCH_NS) // _UNIT_NS, 0), _TIMESTAMP_MAX)


def read_key(path: Path) -> bytes:
    """Reads a key: 32 bytes as they are, or 64 hexadecimal digits.

    Raises:
        UserError: The file cannot be read or holds no key.
    """
    try:
        content = read_bounded(path)
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); name a file with a signing key") from error
    except ValueError:  # a device without an end
        content = b""
    if len(content) == KEY_BYTES:
        return content
    try:
        key = bytes.fromhex(content.decode("ascii").strip())
    except ValueError:
        key = b""
    if len(key) != KEY_BYTES:
        raise UserError(f"{path}: is no signing key; write 32 bytes, or 64 hexadecimal digits, into it")
    return key


class Signing:
    """Signs what one link sends and checks what it receives.

    Args:
        key: 32 bytes that both ends share.
        link_id: of this link.
        timestamp: to begin after, in the signature's units; 0 when none is stored.
        takes_unsigned: accept everything, as on a link that is trusted by itself.
        streams: what was heard; links that share the key share it, or a frame could be replayed on another link.

    Raises:
        ValueError: The key has another length.
    """

    def __init__(
        self,
        key: bytes,
        link_id: int = 0,
        timestamp: int = 0,
        *,
        takes_unsigned: bool = False,
        streams: Streams | None = None,
    ) -> None:
        if len(key) != KEY_BYTES:
            raise ValueError(f"a signing key has {KEY_BYTES} bytes, not {len(key)}")
        self._key = key
        self._link_id = link_id
        self._timestamp = timestamp
        self._takes_unsigned = takes_unsigned
        self._streams: Streams = {} if streams is None else streams

    @property
    def timestamp(self) -> int:
        """The newest of all that was signed and taken."""
        return self._timestamp

    @property
    def streams(self) -> Streams:
        """The newest of each stream."""
        return dict(self._streams)

    def advance(self, t_ns: int) -> None:
        """Takes note of the time, UTC; the timestamp never goes back."""
        self._timestamp = max(self._timestamp, signing_timestamp(t_ns))

    def sign(self, frame: bytes) -> bytes:
        """Returns an unsigned MAVLink 2 frame signed, each with a later timestamp than the one before."""
        self._timestamp = min(self._timestamp + 1, _TIMESTAMP_MAX)
        head = bytearray(frame[:-_CHECKSUM_BYTES])
        head[2] |= mavlink.MAVLINK_IFLAG_SIGNED
        signed = with_checksum(head, int.from_bytes(frame[7:10], "little"))
        signed += bytes((self._link_id,)) + self._timestamp.to_bytes(6, "little")
        return signed + self._signature(signed)

    def accepts(self, frame: bytes | bytearray) -> bool:
        """Whether a frame with a right checksum may be taken; remembers its timestamp if it is signed rightly."""
        return self._is_right(bytes(frame)) or self._takes_unsigned or self._is_radios(frame)

    def _is_radios(self, frame: bytes | bytearray) -> bool:
        """Whether a frame is a radio's of its own; who has signed has a key, and is none."""
        sender = _sender(frame)
        return _message_id(frame) in _RADIO_IDS and all(stream[:2] != sender for stream in self._streams)

    def _is_right(self, frame: bytes) -> bool:
        if frame[0] != mavlink.PROTOCOL_MARKER_V2 or not frame[2] & mavlink.MAVLINK_IFLAG_SIGNED:
            return False
        signed, signature = frame[:-_SIGNATURE_BYTES], frame[-_SIGNATURE_BYTES:]
        stamp = signed[-_STAMP_BYTES:]
        stream, timestamp = (frame[5], frame[6], stamp[0]), int.from_bytes(stamp[1:], "little")
        if not self._is_timely(stream, timestamp) or not hmac.compare_digest(self._signature(signed), signature):
            return False
        self._streams[stream] = timestamp
        self._timestamp = max(self._timestamp, timestamp)
        return True

    def _is_timely(self, stream: tuple[int, int, int], timestamp: int) -> bool:
        newest = self._streams.get(stream)
        if newest is None:
            return timestamp + _NEW_STREAM_LATE_MAX >= self._timestamp
        return timestamp > newest

    def _signature(self, signed: bytes) -> bytes:
        return hashlib.sha256(self._key + signed).digest()[:_SIGNATURE_BYTES]


def _sender(frame: bytes | bytearray) -> tuple[int, int]:
    """Return the frame's system and component."""
    system, component = frame[3:5] if frame[0] == mavlink.PROTOCOL_MARKER_V1 else frame[5:7]
    return system, component


def _message_id(frame: bytes | bytearray) -> int:
    if frame[0] == mavlink.PROTOCOL_MARKER_V1:
        return frame[5]
    return int.from_bytes(frame[7:10], "little")
