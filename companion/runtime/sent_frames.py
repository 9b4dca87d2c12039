"""What a turn of the loop sends to the autopilot, unless it took too long, and what the telemetry log has of that."""

import time
from collections.abc import Sequence

from link.mavlink.session import MavlinkSession
from link.mavlink.tlog import TlogFrames
from link.recording.recorder import Recorder
from link.transports.transport import Transport

_OLD_S = 0.5  # as `abort.own_age_max_s`: by then the drone is elsewhere than the turn took it to be


class SentFrames:
    """Sends and records.

    Args:
        transport: to the autopilot.
        session: on it, whose clock the log has.
        tlog: None records nothing.
    """

    def __init__(self, transport: Transport, session: MavlinkSession, tlog: Recorder | None) -> None:
        self._transport = transport
        self._session = session
        self._tlog = tlog

    @property
    def records_lost(self) -> int:
        """How many records of the log could not be written."""
        return 0 if self._tlog is None else self._tlog.dropped

    @property
    def why_lost(self) -> str:
        """Why the first of them could not be; empty while there is none."""
        return "" if self._tlog is None else self._tlog.why_dropped

    def send(self, frames: Sequence[bytes], local_ns: int, began_s: float) -> None:
        """Send what a turn has made.

        A process that is stopped between its step and its sending, or waits for memory, goes on with setpoints of then;
        an autopilot that has stayed in its mode would fly by them. What is dropped besides is asked again.

        Args:
            frames: in their order.
            local_ns: local time of the turn.
            began_s: when the turn had heard all that it goes by, on `time.perf_counter`.
        """
        if time.perf_counter() - began_s > _OLD_S:
            return
        for frame in frames:
            self._transport.send(frame)
        self.record(frames, local_ns)

    def record(self, frames: Sequence[bytes], local_ns: int) -> None:
        """Put frames that came or went into the log."""
        if self._tlog is not None and frames:
            self._tlog.put(TlogFrames(list(frames), self._session.clock.local_to_utc_ns(local_ns)))
