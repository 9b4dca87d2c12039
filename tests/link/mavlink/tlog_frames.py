"""Reads what `link.mavlink.tlog` writes."""

import struct
from collections.abc import Iterator

from link.mavlink.framing import NOT_A_FRAME, frame_size

_HEAD_BYTES = 3  # of a frame, that tell its length
_TIME = struct.Struct(">Q")


def frames_of(recording: bytes) -> Iterator[tuple[int, bytes]]:
    """Gives the frames of a recording in order.

    Args:
        recording: the content of its file; what is cut off at its end is left out.

    Yields:
        UTC in ns, to the microsecond, and one frame.

    Raises:
        ValueError: It is no such recording from some byte on.
    """
    start = 0
    while start + _TIME.size + _HEAD_BYTES <= len(recording):
        (t_us,) = _TIME.unpack_from(recording, start)
        start += _TIME.size
        size = frame_size(recording, start)
        if size == NOT_A_FRAME:
            raise ValueError(f"no frame at byte {start} of the recording")
        yield t_us * 1000, recording[start : start + size]
        start += size
