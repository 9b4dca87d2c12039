"""A ULog that is streamed to a client: its head piece by piece, each acknowledged, then rows that nobody acknowledges.

Source: MAVLink LOGGING_DATA and LOGGING_DATA_ACKED, and PX4's streaming of logs,
https://docs.px4.io/main/en/dev_log/logging.html#log-streaming.
"""

import struct
from dataclasses import dataclass

from link.mavlink.dialect import Message, mavlink
from link.records import replace

_PIECE = 249
_ULOG_FILE_HEAD = 16
_RETRY_NS = 50_000_000
_TRIES_MAX = 50
_ROW_NS = 20_000_000
_NO_START = 255
"""Stands for a piece in which no message begins."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LogStream:
    """A stream under way.

    Attributes:
        link: on which it goes.
        client: its system and component.
        waiting: the piece that is not acknowledged yet.
        head: whether the head is still being sent.
        tries: of the piece that waits.
        sent_ns: when that was sent last, since boot.
        row_ns: when the next row is due, since boot.
        sequence: of the next piece.
        rest: not sent yet.
        starts: where messages begin in that.
    """

    link: int
    client: tuple[int, int]
    rest: bytes
    starts: tuple[int, ...]
    head: bool = True
    waiting: Message | None = None
    tries: int = 0
    sent_ns: int = 0
    row_ns: int = 0
    sequence: int = 0


def begun_stream(head: bytes, link: int, client: tuple[int, int]) -> LogStream:
    """Return a stream that begins with `head`."""
    starts, at = [0], _ULOG_FILE_HEAD
    while at < len(head):
        starts.append(at)
        at += struct.calcsize("<HB") + int(struct.unpack_from("<H", head, at)[0])
    return LogStream(link=link, client=client, rest=head, starts=tuple(starts))


def with_acknowledged(stream: LogStream, sequence: int) -> LogStream:
    """Return the stream after an acknowledgement."""
    waiting = stream.waiting
    return stream if waiting is None or waiting.sequence != sequence else replace(stream, waiting=None)


def wants_row(stream: LogStream, boot_ns: int) -> bool:
    """Return whether a row is due."""
    return not stream.head and boot_ns >= stream.row_ns


def with_row(stream: LogStream, row: bytes, boot_ns: int) -> LogStream:
    """Return the stream with a row to be sent."""
    starts = (*stream.starts, len(stream.rest))
    return replace(stream, rest=stream.rest + row, starts=starts, row_ns=boot_ns + _ROW_NS)


def stream_on(stream: LogStream, boot_ns: int) -> tuple[LogStream | None, tuple[Message, ...]]:
    """Return the stream one step on, None where its client has not answered, and what goes to that."""
    if stream.waiting is not None:
        return _again(stream, stream.waiting, boot_ns)
    if stream.head and stream.rest:
        stream, piece = _cut(stream, mavlink.MAVLink_logging_data_acked_message)
        return replace(stream, waiting=piece, tries=1, sent_ns=boot_ns), (piece,)
    messages: list[Message] = []
    while len(stream.rest) >= _PIECE:
        stream, piece = _cut(stream, mavlink.MAVLink_logging_data_message)
        messages.append(piece)
    return replace(stream, head=False) if stream.head else stream, tuple(messages)


def _again(stream: LogStream, waiting: Message, boot_ns: int) -> tuple[LogStream | None, tuple[Message, ...]]:
    if boot_ns - stream.sent_ns < _RETRY_NS:
        return stream, ()
    if stream.tries >= _TRIES_MAX:
        return None, ()
    return replace(stream, tries=stream.tries + 1, sent_ns=boot_ns), (waiting,)


def _cut(stream: LogStream, kind: type[Message]) -> tuple[LogStream, Message]:
    data, rest = stream.rest[:_PIECE], stream.rest[_PIECE:]
    first = next((start for start in stream.starts if start < len(data)), _NO_START)
    piece = kind(*stream.client, stream.sequence, len(data), first, list(data.ljust(_PIECE, b"\0")))
    starts = tuple(start - len(data) for start in stream.starts if start >= len(data))
    sequence = (stream.sequence + 1) % 65536
    return replace(stream, rest=rest, starts=starts, sequence=sequence), piece
