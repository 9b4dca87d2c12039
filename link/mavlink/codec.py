"""Messages to bytes and back: frames are checked here, their contents are pymavlink's business.

Framing is not left to pymavlink: after a wrong checksum it throws away as many bytes as the broken frame claimed to
have, good frames included. Here the search goes on at the next byte. Each sender's sequence numbers tell what was lost,
not what came late or twice. A frame of an autopilot that a network delivers again is dropped.
"""

import struct

from link.mavlink.contents import as_version1, frame_of, message_of
from link.mavlink.dialect import Message, mavlink
from link.mavlink.framing import MARKER_V1, MARKER_V2, Stream, message_id_at
from link.mavlink.repeats import RepeatedFrames
from link.mavlink.sequence import NUMBERS, SequenceTracker
from link.mavlink.signing import Signing
from link.mavlink.statistics import CodecStatistics

_PEERS_MAX = 64  # whose unfinished frames are kept; more than a transport has at a time
_SENDERS_MAX = 64  # whose sequences are followed; forgers would make up 65,536, and all are summed with each status


class MavlinkCodec:
    """One end's encoder and decoder; any bytes may come in, and none of them raises.

    Args:
        system_id: of the sender of what is encoded.
        component_id: of the sender of what is encoded.
        records_input: keep each frame received for `take_input`, unknown ones included.
        signing: signs what is encoded and refuses what is not signed rightly; None for links without a key.
        answers_version1: encode MAVLink 1 as long as nothing else was received.
        first_number: with which the sequence of what is encoded begins.
    """

    def __init__(
        self,
        system_id: int,
        component_id: int,
        *,
        records_input: bool = False,
        signing: Signing | None = None,
        answers_version1: bool = False,
        first_number: int = 0,
    ) -> None:
        self.signing = signing
        self._system_id, self._component_id = system_id, component_id
        self._sequence = first_number % NUMBERS
        self._answers_version1 = answers_version1
        self._version1_heard = self._version2_heard = False
        self._streams: dict[int, Stream] = {}
        self._records_input = records_input
        self._input: list[bytes] = []
        self._sequences: dict[tuple[int, int], SequenceTracker] = {}
        self._repeats = RepeatedFrames()
        self._unknown_messages = 0
        self._bytes_received = self._messages_received = 0
        self._messages_sent = 0
        self._bad_bytes = self._bad_frames = 0
        self._refused = self._repeated = 0

    @property
    def statistics(self) -> CodecStatistics:
        """The counters as they stand."""
        sequences = self._sequences.values()
        return CodecStatistics(
            bytes_received=self._bytes_received,
            messages_received=self._messages_received,
            messages_sent=self._messages_sent,
            bad_frames=self._bad_frames,
            bad_bytes=self._bad_bytes,
            unknown_messages=self._unknown_messages,
            refused_messages=self._refused,
            repeated_messages=self._repeated,
            lost_messages=sum(one.lost for one in sequences),
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
        self._sequence = (self._sequence + 1) % NUMBERS
        self._messages_sent += 1
        return frame

    def decode(
        self, data: bytes, peer: int = 0, *, t_ns: int | None = None, is_datagram: bool = False
    ) -> list[Message]:
        """Takes bytes as they come and gives the messages completed by them.

        Bad bytes and unknown messages are counted and dropped.

        Args:
            data: what was received since the last call.
            peer: from whom; a frame is put together of one peer's bytes only.
            t_ns: the time now; a frame of a stream whose rest does not come for `WAIT_MAX_NS` is none, and an
                autopilot's that has come before is dropped. None waits on and takes everything.
            is_datagram: `data` are whole frames, the end of which is theirs; frames of a stream may be cut anywhere.

        Returns:
            Known messages, in their order of arrival.
        """
        self._bytes_received += len(data)
        stream = Stream() if is_datagram else self._stream_of(peer)
        stream.add(data, t_ns)
        messages: list[Message] = []
        while (found := stream.find(ends=is_datagram)) is not None:
            self._take(stream, *found, messages, t_ns)
        stream.settle(t_ns, ends=is_datagram)
        self._count_bad(stream)
        return messages

    def flush(self, t_ns: int) -> list[tuple[int, Message]]:
        """Gives up frames whose rest has not come in time; returns the messages found behind them, with their peers.

        Args:
            t_ns: the time now, on the clock of `decode`.
        """
        overdue = [peer for peer, stream in self._streams.items() if stream.is_overdue(t_ns)]
        return [(peer, message) for peer in overdue for message in self.decode(b"", peer, t_ns=t_ns)]

    def take_input(self) -> list[bytes]:
        """Gives the frames received since the last call, for a recording; empty unless `records_input`."""
        frames, self._input = self._input, []
        return frames

    def _stream_of(self, peer: int) -> Stream:
        if peer not in self._streams:
            if len(self._streams) == _PEERS_MAX:
                oldest = min(self._streams)
                self._bad_bytes += len(self._streams.pop(oldest).buffer)
            self._streams[peer] = Stream()
        return self._streams[peer]

    def _count_bad(self, stream: Stream) -> None:
        self._bad_bytes += stream.bad_bytes
        self._bad_frames += stream.bad_frames
        stream.bad_bytes = stream.bad_frames = 0

    def _take(self, stream: Stream, start: int, size: int, messages: list[Message], t_ns: int | None) -> None:
        """Decodes what may be a frame, and goes on behind it or, if it is none, at the next byte."""
        frame = stream.buffer[start : start + size]
        message_id = message_id_at(frame, 0)
        is_known = message_id in mavlink.mavlink_map
        if not is_known and not _is_followed_by_frame(stream, start + size):
            stream.skip()
            return
        message = message_of(frame, message_id) if is_known else None
        if is_known and message is None:
            stream.skip(has_wrong_checksum=True)
            return
        stream.take(size, is_known=is_known)
        if message is None:
            self._unknown_messages += 1
        elif self.signing is not None and not self.signing.accepts(frame):
            self._refused += 1
            return
        if self._records_input:
            self._input.append(bytes(frame))
        sequence, system, component = frame[2:5] if frame[0] == MARKER_V1 else frame[4:7]
        if message is not None:
            if t_ns is not None and self._is_repeat(frame, (system, component), sequence, t_ns):
                self._repeated += 1
                return
            self._receive(message, frame, messages)
        # An unknown message has no checksum to prove its sender, so it introduces none.
        tracker = self._sequences.get((system, component))
        if tracker is not None:
            tracker.see(sequence)

    def _is_repeat(self, frame: bytearray, sender: tuple[int, int], sequence: int, t_ns: int) -> bool:
        if sender[1] != mavlink.MAV_COMP_ID_AUTOPILOT1:
            return False  # a script that gives one order begins its numbers anew each time
        tracker = self._sequences.get(sender)
        return self._repeats.has(frame, sender[0], t_ns, is_next=tracker is not None and tracker.follows(sequence))

    def _receive(self, message: Message, frame: bytearray, messages: list[Message]) -> None:
        self._version1_heard |= frame[0] == MARKER_V1
        self._version2_heard |= frame[0] == MARKER_V2
        messages.append(message)
        self._messages_received += 1
        sender = message.get_srcSystem(), message.get_srcComponent()
        if sender not in self._sequences and len(self._sequences) < _SENDERS_MAX:
            self._sequences[sender] = SequenceTracker()


def _is_followed_by_frame(stream: Stream, end: int) -> bool:
    """Whether a frame of an unknown message, whose checksum cannot be told, is followed by a frame or nothing."""
    return end == len(stream.buffer) or stream.buffer[end] in (MARKER_V1, MARKER_V2)
