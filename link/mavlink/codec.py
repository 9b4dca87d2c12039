"""Messages to bytes and back: frames are found here, their contents are pymavlink's business.

Framing is not left to pymavlink: after a wrong checksum it throws away as many bytes as the broken frame claimed to
have, good frames included. Here the search goes on at the next byte.
"""

import re
import struct
from collections import Counter

from link.mavlink.contents import frame_of, message_of
from link.mavlink.dialect import Message, mavlink
from link.mavlink.sequence import SequenceTracker
from link.mavlink.signing import Signing
from link.mavlink.statistics import CodecStatistics
from link.mavlink.version1 import as_version1

_MARKER_V1 = mavlink.PROTOCOL_MARKER_V1
_MARKER_V2 = mavlink.PROTOCOL_MARKER_V2
_SIGNED = mavlink.MAVLINK_IFLAG_SIGNED
_MARKER = re.compile(b"[\xfd\xfe]")
_HEAD_SIZE = 3  # marker, payload length, incompatibility flags: enough to know a frame's length
_OVERHEAD_V1 = mavlink.HEADER_LEN_V1 + 2
_OVERHEAD_V2 = mavlink.HEADER_LEN_V2 + 2
NOT_A_FRAME = 0
_UNKNOWN_IDS_MAX = 64  # counted apart; noise would make up thousands
_PEERS_MAX = 64  # whose unfinished frames are kept; more than a transport has at a time


def frame_size(head: bytes | bytearray, start: int) -> int:
    """Length in bytes of the frame that starts at `start`, `NOT_A_FRAME` when its flags are not ones that we know."""
    length = head[start + 1]
    if head[start] == _MARKER_V1:
        return int(length + _OVERHEAD_V1)
    flags = head[start + 2]
    if flags & ~_SIGNED:
        return NOT_A_FRAME
    return int(length + _OVERHEAD_V2 + (mavlink.MAVLINK_SIGNATURE_BLOCK_LEN if flags else 0))


def _header(frame: bytearray) -> tuple[int, int, int, int]:
    """Sequence number, system, component and message id of a frame."""
    if frame[0] == _MARKER_V1:
        return frame[2], frame[3], frame[4], frame[5]
    return frame[4], frame[5], frame[6], frame[7] | frame[8] << 8 | frame[9] << 16


class MavlinkCodec:
    """One end's encoder and decoder; any bytes may come in, and none of them raises.

    Args:
        system_id: of the sender of what is encoded.
        component_id: likewise.
        records_input: keep each frame received for `take_input`, unknown ones included.
        signing: signs what is encoded and refuses what is not signed rightly; None for links without a key.
        answers_version1: encode MAVLink 1 as long as nothing else was received.
    """

    def __init__(
        self,
        system_id: int,
        component_id: int,
        *,
        records_input: bool = False,
        signing: Signing | None = None,
        answers_version1: bool = False,
    ) -> None:
        self.signing = signing
        self._system_id, self._component_id = system_id, component_id
        self._sequence = 0
        self._answers_version1 = answers_version1
        self._version1_heard = self._version2_heard = False
        self._buffer = bytearray()
        self._unfinished: dict[int, bytearray] = {0: self._buffer}
        self._records_input = records_input
        self._input: list[bytes] = []
        self._sequences: dict[tuple[int, int], SequenceTracker] = {}
        self._unknown: Counter[int] = Counter()
        self._unknown_messages = 0
        self._bytes_received = self._messages_received = 0
        self._bytes_sent = self._messages_sent = 0
        self._bad_bytes = self._bad_frames = 0
        self._refused = 0

    @property
    def statistics(self) -> CodecStatistics:
        """The counters as they stand."""
        sequences = self._sequences.values()
        return CodecStatistics(
            bytes_received=self._bytes_received,
            messages_received=self._messages_received,
            messages_sent=self._messages_sent,
            bytes_sent=self._bytes_sent,
            bad_frames=self._bad_frames,
            bad_bytes=self._bad_bytes,
            unknown_messages=self._unknown_messages,
            unknown_ids=tuple(sorted(self._unknown.items())),
            refused_messages=self._refused,
            lost_messages=sum(one.lost for one in sequences),
            late_messages=sum(one.late for one in sequences),
            doubled_messages=sum(one.doubled for one in sequences),
        )

    def encode(self, message: Message) -> bytes:
        """Packs a message into one frame with the next sequence number.

        Args:
            message: any of the dialect's messages.

        Returns:
            The frame; nothing for a message that MAVLink 1 does not have, where that is spoken.

        Raises:
            ValueError: A field does not fit its type, or the dialect does not have the message.
        """
        try:
            frame = frame_of(message, self._sequence, self._system_id, self._component_id)
        except (struct.error, TypeError, OverflowError, KeyError) as error:
            raise ValueError(f"{message.get_type()} cannot be packed: {error}") from error
        if self._answers_version1 and self._version1_heard and not self._version2_heard:
            frame = as_version1(frame) or b""
            if not frame:
                return frame
        elif self.signing is not None:
            frame = self.signing.sign(frame)
        self._sequence = (self._sequence + 1) % 256
        self._messages_sent += 1
        self._bytes_sent += len(frame)
        return frame

    def decode(self, data: bytes, peer: int = 0) -> list[Message]:
        """Takes bytes as they come and gives the messages completed by them.

        Frames may be cut anywhere. Bad bytes and unknown messages are counted and dropped.

        Args:
            data: what was received since the last call.
            peer: from whom; a frame is put together of one peer's bytes only.

        Returns:
            Known messages, in their order of arrival.
        """
        self._bytes_received += len(data)
        buffer = self._buffer = self._buffer_of(peer)
        buffer += data
        messages: list[Message] = []
        start = 0
        while (start := self._next_marker(start)) + _HEAD_SIZE <= len(buffer):
            size = frame_size(buffer, start)
            if start + size > len(buffer):
                break
            start += self._take(start, size, messages)
        del buffer[:start]
        if peer and not buffer:
            del self._unfinished[peer]
        return messages

    def take_input(self) -> list[bytes]:
        """Gives the frames received since the last call, for a recording; empty unless `records_input`."""
        frames, self._input = self._input, []
        return frames

    def _buffer_of(self, peer: int) -> bytearray:
        if peer not in self._unfinished:
            if len(self._unfinished) == _PEERS_MAX:
                oldest = min(one for one in self._unfinished if one)
                self._bad_bytes += len(self._unfinished.pop(oldest))
            self._unfinished[peer] = bytearray()
        return self._unfinished[peer]

    def _next_marker(self, start: int) -> int:
        """The next place where a frame may start, or the end; what lies before it is bad."""
        buffer = self._buffer
        if start < len(buffer) and buffer[start] == _MARKER_V2:  # the usual case needs no search
            return start
        found = _MARKER.search(buffer, start)
        end = len(buffer) if found is None else found.start()
        self._bad_bytes += end - start
        return end

    def _take(self, start: int, size: int, messages: list[Message]) -> int:
        """Decodes the frame at `start`; returns how many bytes it used up."""
        frame = self._buffer[start : start + size]
        if size == NOT_A_FRAME:
            return self._skip()
        sequence, system, component, message_id = _header(frame)
        if message_id not in mavlink.mavlink_map:
            if not self._ends_at_frame(start + size):
                return self._skip()
            self._count_unknown(message_id)
        else:
            message = message_of(frame, message_id)
            if message is None:
                return self._skip()
            if self.signing is not None and not self.signing.accepts(frame):
                self._refused += 1
                return size
            self._version1_heard |= frame[0] == _MARKER_V1
            self._version2_heard |= frame[0] == _MARKER_V2
            messages.append(message)
            self._messages_received += 1
            if (system, component) not in self._sequences:
                self._sequences[system, component] = SequenceTracker()
        # An unknown message has no checksum to prove its sender, so it introduces none.
        tracker = self._sequences.get((system, component))
        if tracker is not None:
            tracker.see(sequence)
        if self._records_input:
            self._input.append(bytes(frame))
        return size

    def _count_unknown(self, message_id: int) -> None:
        self._unknown_messages += 1
        if message_id in self._unknown or len(self._unknown) < _UNKNOWN_IDS_MAX:
            self._unknown[message_id] += 1

    def _ends_at_frame(self, end: int) -> bool:
        """Whether a frame of an unknown message, whose checksum cannot be told, is followed by a frame or nothing."""
        return end == len(self._buffer) or self._buffer[end] in (_MARKER_V1, _MARKER_V2)

    def _skip(self) -> int:
        self._bad_frames += 1
        self._bad_bytes += 1
        return 1
