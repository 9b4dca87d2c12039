"""The log service: a log of each flight, kept until it is erased, listed and sent in pieces of 90 bytes.

Source: MAVLink log messages, as the firmwares' own log handlers answer them.
"""

from datetime import UTC, datetime
from functools import partial

from msgspec import Struct

from link.ftp.store import Shown
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.ground_station.logs.flight_log import LogRules, Row

_PIECE = 90
_PIECES_A_STEP = 20
"""LOG_DATA sent in 10 ms: 180 kB/s."""
_ROW_NS = 200_000_000
_KEPT_MAX = 20
"""Flights; the oldest logs go first, as on a full card."""
_CHUNK = 8192
_CHUNKS_MAX = 500
"""Bytes written together, and how often: a log grows to 4 MB at most, hours of flight."""


class Log(Struct, frozen=True, kw_only=True):
    """A finished log, and when it began, in whole seconds of UTC."""

    began_s: int
    data: bytes


class Sending(Struct, frozen=True, kw_only=True):
    """A download under way: on which link, which log, from where to where."""

    link: int
    number: int
    offset: int
    end: int


class Logs(Struct, frozen=True, kw_only=True):
    """What the service remembers.

    Attributes:
        kept: finished logs, the oldest first.
        chunks: written of the flight under way.
        rest: behind these.
        began_s: of that flight, None on the ground.
        next_ns: when its next row is due, since boot.
        sending: a download under way.
        listed: whether anybody has asked for the list, before which PX4 sends nothing.
    """

    kept: tuple[Log, ...] = ()
    chunks: tuple[bytes, ...] = ()
    rest: bytes = b""
    began_s: int | None = None
    next_ns: int = 0
    sending: Sending | None = None
    listed: bool = False


NO_LOGS = Logs()


def is_due(logs: Logs, boot_ns: int, *, armed: bool) -> bool:
    """Return whether the log wants to hear of this moment."""
    begins_or_ends = armed is (logs.began_s is None)
    return begins_or_ends or (armed and boot_ns >= logs.next_ns)


def add_row(logs: Logs, row: Row, now_s: int, rules: LogRules, *, armed: bool) -> Logs:
    """Return the logs with one row more, or with the flight's log finished when the motors stand."""
    if not armed:
        log = Log(began_s=now_s if logs.began_s is None else logs.began_s, data=b"".join(logs.chunks) + logs.rest)
        return replace(logs, kept=(*logs.kept, log)[-_KEPT_MAX:], chunks=(), rest=b"", began_s=None, sending=None)
    if logs.began_s is None:
        logs = replace(logs, began_s=now_s, rest=rules.head(row))
    logs = replace(logs, rest=logs.rest + rules.row(row), next_ns=row.boot_ns + _ROW_NS)
    if len(logs.rest) < _CHUNK or len(logs.chunks) >= _CHUNKS_MAX:
        return logs if len(logs.chunks) < _CHUNKS_MAX else replace(logs, rest=b"")
    return replace(logs, chunks=(*logs.chunks, logs.rest), rest=b"")


def shown_logs(logs: Logs, rules: LogRules) -> Shown:
    """Return the logs as files."""
    return {
        rules.path.format(datetime.fromtimestamp(log.began_s, UTC), number): partial(bytes, log.data)
        for number, log in enumerate(logs.kept, rules.first_id)
    }


def entries(logs: Logs, first: int, last: int, rules: LogRules) -> tuple[Message, ...]:
    """Return the LOG_ENTRYs that answer a request for the logs from number `first` to `last`."""
    count = len(logs.kept)
    if count == 0:
        return (mavlink.MAVLink_log_entry_message(0, 0, 0, 0, 0),) if rules.told_empty else ()
    newest = count - 1 + rules.first_id
    chosen = range(max(first, rules.first_id), min(last, newest) + 1)
    logs_chosen = ((number, logs.kept[number - rules.first_id]) for number in chosen)
    return tuple(
        mavlink.MAVLink_log_entry_message(number, count, newest, log.began_s, len(log.data))
        for number, log in logs_chosen
    )


def begin_download(logs: Logs, link: int, request: Message, rules: LogRules) -> Logs:
    """Return the logs with a download begun, where there is such a log and such a place in it."""
    number, offset, count = request.id, request.ofs, request.count
    index = number - rules.first_id
    known = 0 <= index < len(logs.kept) and (logs.listed or rules.told_empty)
    if not known or offset >= len(logs.kept[index].data):
        return replace(logs, sending=None)
    end = min(offset + count, len(logs.kept[index].data))
    return replace(logs, sending=Sending(link=link, number=number, offset=offset, end=end))


def pieces(logs: Logs, rules: LogRules) -> tuple[Logs, tuple[Message, ...]]:
    """Return the logs one step on, and the LOG_DATA of a download under way that go now."""
    sending = logs.sending
    if sending is None:
        return logs, ()
    messages: list[Message] = []
    data, offset = logs.kept[sending.number - rules.first_id].data, sending.offset
    while offset < sending.end and len(messages) < _PIECES_A_STEP:
        piece = data[offset : min(offset + _PIECE, sending.end)]
        padded = list(piece.ljust(_PIECE, b"\0"))
        messages.append(mavlink.MAVLink_log_data_message(sending.number, offset, len(piece), padded))
        offset += len(piece)
    rest = replace(sending, offset=offset) if offset < sending.end else None
    return replace(logs, sending=rest), tuple(messages)
