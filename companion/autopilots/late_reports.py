"""Finds reports of the state that newer messages have overtaken, by MAVLink's sequence numbers.

A link that jitters delivers datagrams out of order, and one that repeats old ones may have lost the first. A heartbeat
from before a change of mode, taken after one from behind it, reads as a pilot who has changed the mode.
Source: MAVLink guide, "Packet serialization": each sender counts its packets by 8 bits.
"""

from link.mavlink.dialect import Message
from link.mavlink.sequence import NUMBERS

_REPORTS = frozenset({"HEARTBEAT", "CURRENT_MODE", "EXTENDED_SYS_STATE", "GPS_RAW_INT"})
_AHEAD_MAX = 64  # packets lost in a row: 0.2 s of some 300 a second; more may be an old one, counted around the circle
_SILENT_S = 0.5  # without one in order the numbers tell nothing: so many may have been lost, or the count began anew


class LateReports:
    """Knows the newest message, and of which kinds of reports the last one was late.

    Jitter has one report overtaken now and then. A forged number makes all true ones late: of a kind that is late twice
    in a row the second counts, and what follows.
    """

    def __init__(self) -> None:
        self._newest: tuple[int, int] | None = None
        self._late_kinds: set[str] = set()

    def is_late(self, message: Message, local_ns: int) -> bool:
        """Take a message, and return whether it is a report that was sent before one that has come already."""
        kind, number = message.get_type(), message.get_seq()
        if not self._is_overtaken(number, local_ns):
            self._newest = number, local_ns
            self._late_kinds.discard(kind)
            return False
        is_first = kind in _REPORTS and kind not in self._late_kinds
        self._late_kinds.add(kind)
        return is_first

    def _is_overtaken(self, number: int, local_ns: int) -> bool:
        if self._newest is None:
            return False
        newest, in_order_ns = self._newest
        return (number - newest) % NUMBERS > _AHEAD_MAX and (local_ns - in_order_ns) * 1e-9 < _SILENT_S
