"""Finds state reports that a newer one has overtaken, by MAVLink's sequence numbers.

A link that jitters delivers datagrams out of order. A heartbeat from before a change of mode, taken after one from
behind it, reads as a pilot who has changed the mode.
Source: MAVLink guide, "Packet serialization": each sender counts its packets by 8 bits.
"""

from link.mavlink.dialect import Message

_REPORTS = frozenset({"HEARTBEAT", "CURRENT_MODE", "EXTENDED_SYS_STATE"})
_OVERTAKEN_MAX = 32  # packets: 0.1 s of some 300 a second; more is a sequence that restarted
_OVERTAKEN_S = 0.5  # and the same once nothing was reported for so long


class LateReports:
    """Knows the newest report of the state, and of which kinds the last one was late.

    Jitter has one report overtaken now and then. A forged number makes all true ones late: of a kind that is late twice
    in a row the second counts, and what follows.
    """

    def __init__(self) -> None:
        self._newest: tuple[int, int] | None = None
        self._late_kinds: set[str] = set()

    def is_late(self, message: Message, local_ns: int) -> bool:
        """Take a message, and return whether it is a report that was sent before one that has come already."""
        kind = message.get_type()
        if kind not in _REPORTS:
            return False
        if self._is_overtaken(message.get_seq(), local_ns):
            is_first = kind not in self._late_kinds
            self._late_kinds.add(kind)
            return is_first
        self._late_kinds.discard(kind)
        self._newest = message.get_seq(), local_ns
        return False

    def _is_overtaken(self, number: int, local_ns: int) -> bool:
        if self._newest is None:
            return False
        newest, heard_ns = self._newest
        return 0 < (newest - number) % 256 <= _OVERTAKEN_MAX and (local_ns - heard_ns) * 1e-9 < _OVERTAKEN_S
