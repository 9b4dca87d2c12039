"""Message intervals: asked for until granted, and again when the messages stay away."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from link.mavlink.dialect import mavlink
from link.mavlink.events import CommandAcknowledged, CommandTimedOut
from link.mavlink.requests import CommandParams

_US_PER_S = 1e6
_OFF_US = -1.0
_SILENT_AFTER_NS = 5_000_000_000  # a granted stream that stays away so long is asked for again
_PERIODS_SILENT = 5  # a slow stream is silent only after so many of its own periods
_FINAL_REFUSALS = (mavlink.MAV_RESULT_DENIED, mavlink.MAV_RESULT_UNSUPPORTED)


class _State(Enum):
    ASKED = "asked"
    GRANTED = "granted"
    POSTPONED = "postponed"
    REFUSED = "refused"


@dataclass(slots=True)
class _Stream:
    interval_us: float
    state: _State
    ticket: int
    since_ns: int  # of the state, or of the last message
    patience_ns: int

    @property
    def is_awaited(self) -> bool:
        """Whether a message, or another try, is to be expected: one that is to stay away is no loss."""
        if self.state is _State.GRANTED:
            return self.interval_us != _OFF_US
        return self.state is _State.POSTPONED


class StreamRequests:
    """The streams wanted.

    Args:
        command: called with command id, parameters and time to send a command; returns its ticket.
    """

    def __init__(self, command: Callable[[int, CommandParams, int], int]) -> None:
        self._command = command
        self._streams: dict[int, _Stream] = {}
        self._by_ticket: dict[int, int] = {}

    def request(self, message_id: int, rate_hz: float, t_ns: int) -> None:
        """Asks for a message at a rate, 0 for never.

        Raises:
            ValueError: The rate is negative or not finite.
        """
        if not (math.isfinite(rate_hz) and rate_hz >= 0.0):
            raise ValueError(f"a message's rate must be finite and not negative, is {rate_hz} Hz")
        self._ask(message_id, _US_PER_S / rate_hz if rate_hz > 0.0 else _OFF_US, t_ns)

    def seen(self, message_id: int, t_ns: int) -> None:
        """Takes note of a message."""
        stream = self._streams.get(message_id)
        if stream is not None and stream.state is _State.GRANTED:
            stream.since_ns = t_ns

    def acknowledged(self, event: CommandAcknowledged) -> None:
        """Takes an acknowledgement, which may be that of another command."""
        if event.is_repeat or event.result == mavlink.MAV_RESULT_IN_PROGRESS or event.ticket is None:
            return
        message_id = self._by_ticket.pop(event.ticket, None)
        if message_id is None:
            return
        stream = self._streams[message_id]
        if stream.ticket == event.ticket:
            stream.state = _state_by_result(event.result)
            stream.since_ns = event.t_ns

    def timed_out(self, event: CommandTimedOut) -> bool:
        """Asks again when a request of ours timed out; returns whether it was one."""
        message_id = self._by_ticket.pop(event.ticket, None)
        if message_id is None:
            return False
        stream = self._streams[message_id]
        if stream.ticket == event.ticket:
            self._ask(message_id, stream.interval_us, event.t_ns)
        return True

    def poll(self, t_ns: int) -> None:
        """Asks again for streams that stay away or were refused for the time being."""
        for message_id, stream in self._streams.items():
            if t_ns - stream.since_ns > stream.patience_ns and stream.is_awaited:
                self._ask(message_id, stream.interval_us, t_ns)

    def start_over(self, t_ns: int) -> None:
        """Asks for everything again, as after a restart."""
        for message_id, stream in self._streams.items():
            if stream.state is not _State.ASKED:
                self._ask(message_id, stream.interval_us, t_ns)

    def _ask(self, message_id: int, interval_us: float, t_ns: int) -> None:
        params = (float(message_id), interval_us, 0.0, 0.0, 0.0, 0.0, 0.0)
        ticket = self._command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, params, t_ns)
        patience_ns = max(_SILENT_AFTER_NS, round(_PERIODS_SILENT * interval_us * 1000))
        self._streams[message_id] = _Stream(interval_us, _State.ASKED, ticket, t_ns, patience_ns)
        self._by_ticket[ticket] = message_id


def _state_by_result(result: int) -> _State:
    if result == mavlink.MAV_RESULT_ACCEPTED:
        return _State.GRANTED
    return _State.REFUSED if result in _FINAL_REFUSALS else _State.POSTPONED
