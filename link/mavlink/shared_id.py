"""Notices two autopilots under one system id: each answers what is asked of the other, and obeys what it is told.

One clock answers a question twice where the link doubles it. Both answers are then made between asking and hearing the
later one, so they are no farther apart than that took; two clocks, started at different times, are.
"""

from collections import deque

from link.mavlink.dialect import Message, mavlink

_ASKED_MAX = 16  # questions whose answers are compared; the newest ones
_CLOCKS_APART_NS = 20_000_000  # more than an autopilot corrects its answers by for its port
_CONFIRMATIONS = 3  # one may be anybody's, or garbled
_REMEMBERED_NS = 10_000_000_000


class SharedIdWatch:
    """The answers to our questions of the time."""

    def __init__(self) -> None:
        self._told_ns: dict[int, int | None] = {}
        self._doubled_ns: deque[int] = deque(maxlen=_CONFIRMATIONS)

    def ask(self, t_ns: int) -> None:
        """Take note of a question that is sent at local time `t_ns`, which is its `ts1`."""
        self._told_ns[t_ns] = None
        if len(self._told_ns) > _ASKED_MAX:
            del self._told_ns[next(iter(self._told_ns))]

    def hear(self, message: Message, t_ns: int) -> None:
        """Take a message of the autopilot's address at local time `t_ns`, whatever its clock shows."""
        if message.get_msgId() != mavlink.MAVLINK_MSG_ID_TIMESYNC or message.ts1 not in self._told_ns:
            return
        asked_ns, told_ns = message.ts1, message.tc1
        before_ns, self._told_ns[asked_ns] = self._told_ns[asked_ns], told_ns
        if before_ns is not None and abs(told_ns - before_ns) > t_ns - asked_ns + _CLOCKS_APART_NS:
            self._told_ns[asked_ns] = None  # each question counts once
            self._doubled_ns.append(t_ns)

    def is_shared(self, t_ns: int) -> bool:
        """Whether two autopilots have answered lately, at local time `t_ns`."""
        return len(self._doubled_ns) == _CONFIRMATIONS and t_ns - self._doubled_ns[0] <= _REMEMBERED_NS
