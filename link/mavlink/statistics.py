"""Counters of a MAVLink link, as snapshots."""

from msgspec import Struct


class CodecStatistics(Struct, frozen=True, kw_only=True):
    """What a codec has seen so far.

    Attributes:
        bytes_received: all of them, good or bad.
        messages_received: known messages with a right checksum.
        messages_sent: frames encoded.
        bad_frames: places where a frame seemed to start and did not hold.
        bad_bytes: bytes that belonged to no frame.
        unknown_messages: frames whose message id the dialect does not know.
        refused_messages: without a right signature where one is required.
        repeated_messages: that came before, byte for byte.
        lost_messages: gaps in the sequence numbers of the first 64 senders.
    """

    bytes_received: int
    messages_received: int
    messages_sent: int
    bad_frames: int
    bad_bytes: int
    unknown_messages: int
    refused_messages: int
    repeated_messages: int
    lost_messages: int


class SessionStatistics(Struct, frozen=True, kw_only=True):
    """What a session has seen so far.

    Attributes:
        codec: the counters of its codec.
        filtered_messages: messages that were from, or for, somebody else, or from a time that is not confirmed.
        commands_retried: command frames sent again.
        commands_timed_out: commands never answered.
        round_trips: TIMESYNC answers used.
    """

    codec: CodecStatistics
    filtered_messages: int
    commands_retried: int
    commands_timed_out: int
    round_trips: int
