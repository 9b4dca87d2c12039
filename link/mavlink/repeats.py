"""Finds frames of autopilots that a network delivers again, long after they were sent.

An old heartbeat that is heard again reads as a pilot who has changed the mode, an old answer as one to a newer order. A
frame that comes again is the same to the byte, its number included, and its number is not the next one. Numbers have 8
bits, so a report that stays as it is may be made again with the same number; then it is the next one, unless the one
before it was lost.
Source: MAVLink guide, "Packet serialization": each sender counts its packets.
"""

from collections import OrderedDict

from link.mavlink.dialect import mavlink
from link.mavlink.framing import message_id_at

DELIVERED_AGAIN_NS = 30_000_000_000
"""So late a network may deliver a datagram again."""

_FRAMES_MAX = 20_000  # 30 s of 700 a second; some megabytes
_BEATS_MISSED_NS = 3_000_000_000  # without one a heartbeat is taken that may be new: the link must not be lost for this


class RepeatedFrames:
    """The frames of the last seconds."""

    def __init__(self) -> None:
        self._heard_ns: OrderedDict[bytes, int] = OrderedDict()
        self._beat_ns: dict[int, int] = {}

    def has(self, frame: bytes | bytearray, system_id: int, t_ns: int, *, is_next: bool) -> bool:
        """Take a frame, and return whether it has come before.

        Args:
            frame: a whole one, its checksum right.
            system_id: of its sender.
            t_ns: the time now.
            is_next: whether its number is the one that its sender uses next.
        """
        self._forget(t_ns)
        content = bytes(frame)
        is_beat = message_id_at(content, 0) == mavlink.MAVLINK_MSG_ID_HEARTBEAT
        is_missed = is_beat and t_ns - self._beat_ns.get(system_id, t_ns) > _BEATS_MISSED_NS
        if content in self._heard_ns and not (is_next or is_missed):
            return True
        if is_beat:
            self._beat_ns[system_id] = t_ns
        self._heard_ns[content] = t_ns
        self._heard_ns.move_to_end(content)
        return False

    def _forget(self, t_ns: int) -> None:
        heard_ns = self._heard_ns
        while heard_ns and (len(heard_ns) >= _FRAMES_MAX or t_ns - next(iter(heard_ns.values())) > DELIVERED_AGAIN_NS):
            heard_ns.popitem(last=False)
