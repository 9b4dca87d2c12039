"""Our own heartbeats: once a second, and at once when what they tell of a flight changes."""

from collections import deque
from collections.abc import Callable

from link.mavlink.dialect import Message, mavlink
from link.mavlink.peer import companion_heartbeat
from link.mavlink.timer import Timer

_PERIOD_NS = 1_000_000_000  # by the MAVLink heartbeat protocol
_KEPT = 3  # an echo of an older one would come after the time in which a peer counts as lost


class OwnHeartbeat:
    """When one is due, what it tells, and which of those heard is only an echo."""

    def __init__(self) -> None:
        self._timer = Timer(_PERIOD_NS)
        self._state: tuple[int, int] = (mavlink.MAV_STATE_ACTIVE, 0)
        self._sent: deque[bytes] = deque(maxlen=_KEPT)

    def tell(self, state: tuple[int, int]) -> None:
        """Takes MAV_STATE and the custom mode to be told; another MAV_STATE is told at once."""
        if state[0] != self._state[0]:
            self._timer.restart()
        self._state = state

    def poll(self, t_ns: int, encode: Callable[[Message], bytes]) -> list[bytes]:
        """The frame, made by `encode`, of a heartbeat that is due at local time `t_ns`."""
        if not self._timer.is_due(t_ns):
            return []
        frame = encode(companion_heartbeat(*self._state))
        self._sent.append(frame)
        return [frame]

    def is_echo(self, message: Message) -> bool:
        """Whether a message is one that was sent from here."""
        return bytes(message.get_msgbuf()) in self._sent
