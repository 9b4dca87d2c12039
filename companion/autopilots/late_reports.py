"""Finds state reports that a newer one has overtaken, by MAVLink's sequence numbers.

A link that jitters delivers datagrams out of order. A heartbeat from before a change of mode, taken after one from
behind it, reads as a pilot who has changed the mode.
Source: MAVLink guide, "Packet serialization": each sender counts its packets by 8 bits.
"""

from link.mavlink.dialect import Message

_REPORTS = frozenset({"HEARTBEAT", "CURRENT_MODE", "EXTENDED_SYS_STATE"})
_OVERTAKEN_MAX = 32  # packets: 0.1 s of some 300 a second; more is a sequence that restarted
_OVERTAKEN_S = 0.5  # and the same once nothing was reported for so long
_ANEW_S = 3.0  # three heartbeats, within which no jitter makes two reports of a kind late: the numbers are wrong


class LateReports:
    """Knows the newest report of the state, and when one of each kind was late.

    A forged number makes all true ones late: of each kind the second counts again.
    """

    def __init__(self) -> None:
        self._newest: tuple[int, int] | None = None
        self._late_ns: dict[str, int] = {}

    def is_late(self, message: Message, local_ns: int) -> bool:
        """Take a message, and return whether it is a report that was sent before one that has come already."""
        if message.get_type() not in _REPORTS:
            return False
        number = message.get_seq()
        if self._newest is not None:
            newest, heard_ns = self._newest
            behind = (newest - number) % 256
            if 0 < behind <= _OVERTAKEN_MAX and (local_ns - heard_ns) * 1e-9 < _OVERTAKEN_S:
                before_ns = self._late_ns.get(message.get_type())
                self._late_ns[message.get_type()] = local_ns
                return before_ns is None or (local_ns - before_ns) * 1e-9 > _ANEW_S
        self._newest = number, local_ns
        return False
