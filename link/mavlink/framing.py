"""Where frames are in bytes, and how long is looked for them: their checksums and contents are `codec`'s business.

A stream is searched on behind whatever is no frame. Of noise one byte in 128 is a marker; bytes with four times as many
were made to cost time, and the rest of them is thrown away. Source of the lengths: MAVLink's own C library, which takes
a version 1 frame from its definition without extensions to that with all of them.
"""

import re
from functools import cache

from link.mavlink.contents import base_size
from link.mavlink.dialect import mavlink

MARKER_V1 = mavlink.PROTOCOL_MARKER_V1
MARKER_V2 = mavlink.PROTOCOL_MARKER_V2
_MARKER = re.compile(b"[\xfd\xfe]")
_SIGNED = mavlink.MAVLINK_IFLAG_SIGNED
_SIGNATURE_SIZE = mavlink.MAVLINK_SIGNATURE_BLOCK_LEN
_HEADER_V1, _HEADER_V2 = mavlink.HEADER_LEN_V1, mavlink.HEADER_LEN_V2
_OVERHEAD_V1, _OVERHEAD_V2 = _HEADER_V1 + 2, _HEADER_V2 + 2
_KNOWN = mavlink.mavlink_map
NOT_A_FRAME = 0
UNFINISHED = -1
WAIT_MAX_NS = 200_000_000
"""For the rest of a frame: the longest takes 0.15 s at 19,200 baud."""

_BYTES_A_MARKER_MIN = 32
_PATIENCE_MIN = 64  # so that a few bytes may be as bad as they like
_PATIENCE_CHECKSUM = 4  # as much time as four markers that begin nothing
_PATIENCE_UNKNOWN = 2


def frame_size(head: bytes | bytearray, start: int) -> int:
    """Length in bytes of the frame that starts at `start`, `NOT_A_FRAME` when its flags are not ones that we know."""
    length = head[start + 1]
    if head[start] == MARKER_V1:
        return int(length + _OVERHEAD_V1)
    flags = head[start + 2]
    if flags & ~_SIGNED:
        return NOT_A_FRAME
    return int(length + _OVERHEAD_V2 + (_SIGNATURE_SIZE if flags else 0))


def message_id_at(buffer: bytes | bytearray, start: int) -> int:
    """Message id of the frame whose header starts at `start`."""
    if buffer[start] == MARKER_V1:
        return buffer[start + 5]
    return buffer[start + 7] | buffer[start + 8] << 8 | buffer[start + 9] << 16


class Stream:
    """The bytes of one sender that are not used up yet.

    Attributes:
        buffer: these bytes.
        bad_bytes: those passed over because no frame begins there.
        bad_frames: places where one seemed to.
        is_in_step: whether the next frame begins at the present place, since what was before it was one. Only then is
            a message taken for one that the dialect does not have: it has no checksum to be told by.
    """

    def __init__(self) -> None:
        self.buffer = bytearray()
        self.bad_bytes = self.bad_frames = 0
        self.is_in_step = True
        self._start = 0
        self._patience = 0
        self._waits_since_ns: int | None = None

    def is_overdue(self, t_ns: int | None) -> bool:
        """Whether the rest of a frame has been waited for too long."""
        if t_ns is None or self._waits_since_ns is None or not self.buffer:
            return False
        return t_ns - self._waits_since_ns > WAIT_MAX_NS

    def add(self, data: bytes, t_ns: int | None) -> None:
        """Take bytes; at `t_ns` a frame whose rest has not come for too long is no frame."""
        if self.is_overdue(t_ns):
            self.skip()
        if not self.buffer:
            self._waits_since_ns = t_ns
        self.buffer += data
        self._patience = _PATIENCE_MIN + len(self.buffer) // _BYTES_A_MARKER_MIN

    def find(self, *, ends: bool) -> tuple[int, int] | None:
        """Find the next place where a frame may begin, and its size.

        Args:
            ends: whether nothing follows the bytes that are there, so that a frame that goes on is none.

        Returns:
            None when there is no further one, or not all of it yet.
        """
        while self._go_to_marker():
            size = self._size()
            if size > 0:
                return self._start, size
            if size == UNFINISHED and not ends:
                return None
            self.skip()
        return None

    def take(self, size: int, *, is_known: bool) -> None:
        """Go on behind a frame; of a message that is not known it may be none at all."""
        self._start += size
        self.is_in_step = True
        if not is_known:
            self._lose_patience(_PATIENCE_UNKNOWN)

    def skip(self, *, has_wrong_checksum: bool = False) -> None:
        """Go on at the next byte: there is no frame here."""
        self._start += 1
        self.bad_bytes += 1
        self.bad_frames += 1
        self.is_in_step = False
        self._lose_patience(_PATIENCE_CHECKSUM if has_wrong_checksum else 1)

    def settle(self, t_ns: int | None, *, ends: bool) -> None:
        """Forget what is used up, or everything if it `ends`; what is left waits for its rest from now on."""
        if ends:
            self._drop(len(self.buffer))
        if self._start:
            del self.buffer[: self._start]
            self._start = 0
            self._waits_since_ns = t_ns

    def _lose_patience(self, by: int) -> None:
        self._patience -= by
        if self._patience < 0:
            self._drop(len(self.buffer))

    def _go_to_marker(self) -> bool:
        buffer, start = self.buffer, self._start
        if start < len(buffer) and buffer[start] == MARKER_V2:  # the usual case needs no search
            return True
        found = _MARKER.search(buffer, start)
        self._drop(len(buffer) if found is None else found.start())
        return found is not None

    def _drop(self, end: int) -> None:
        if end > self._start:
            self.bad_bytes += end - self._start
            self._start, self.is_in_step = end, False

    def _size(self) -> int:
        """Size of the frame that begins here, `NOT_A_FRAME` or `UNFINISHED`."""
        buffer, start = self.buffer, self._start
        left = len(buffer) - start
        if left < (_HEADER_V1 if buffer[start] == MARKER_V1 else _HEADER_V2):
            return UNFINISHED
        size = frame_size(buffer, start)
        if size == NOT_A_FRAME or not self._is_plausible(start):
            return NOT_A_FRAME
        return size if size <= left else UNFINISHED

    def _is_plausible(self, start: int) -> bool:
        message_id = message_id_at(self.buffer, start)
        if message_id not in _KNOWN:
            return self.is_in_step
        return self.buffer[start] == MARKER_V2 or self.buffer[start + 1] in lengths_v1(message_id)


@cache
def lengths_v1(message_id: int) -> range:
    """How long the payload of a known message may be in a version 1 frame."""
    return range(base_size(message_id), _KNOWN[message_id].unpacker.size + 1)
