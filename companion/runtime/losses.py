"""What gets lost in a flight and leaves no other trace, said once each in the log, and to the pilot where it counts."""

from companion.autopilots.choice import WHY_REFUSED
from companion.runtime.node import CompanionNode
from companion.runtime.recorded_node import RecordingNode
from companion.runtime.sent_frames import SentFrames
from link.mavlink.signing_memory import SigningMemory
from link.recording.log import Log
from link.zenoh.session import ZenohSession


class Losses:
    """Watches the counters of what could not be sent or written.

    Args:
        node: the companion.
        sent: its frames, with their log.
        zenoh: session by which it publishes.
        log: of the program.
        signing: where its time stamps are kept, if there are any.
    """

    def __init__(
        self,
        node: CompanionNode,
        sent: SentFrames,
        zenoh: ZenohSession,
        log: Log,
        *,
        signing: SigningMemory | None = None,
    ) -> None:
        self._node = node
        self._sent = sent
        self._zenoh = zenoh
        self._log = log
        self._signing = signing
        self._was_heard = False
        self._refused_before: int | None = 0  # messages, when the autopilot was lost; None once they are told
        self._are_records_told = self._are_setpoints_told = self._are_statuses_told = self._are_stamps_told = False

    def say(self) -> None:
        """Say what has been lost since the last call and is not told yet."""
        self._say_refused()
        if not self._are_records_told:
            self._say_records()
        if not self._are_setpoints_told and (withheld := self._node.autopilot.setpoints.bad):
            self._are_setpoints_told = True
            self._log.warning("setpoints are withheld: not finite, or absurd", withheld=withheld)
            self._node.warn("withholds setpoints that are not finite")
        if not self._are_statuses_told and (lost := self._node.publisher.unpublished + self._zenoh.unpublished):
            self._are_statuses_told = True
            self._log.warning("statuses are not published: no message holds them, or Zenoh takes none", lost=lost)
        if not self._are_stamps_told and self._signing is not None and (why := self._signing.why_lost):
            self._are_stamps_told = True
            self._log.warning("time stamps of signatures are not kept: old frames may count after a restart", why=why)

    def _say_refused(self) -> None:
        """Say, once each time that the autopilot is not heard, that messages come and are not signed rightly."""
        session = self._node.autopilot.session
        if session.link_up:
            self._was_heard = True
            return
        refused = session.statistics.codec.refused_messages
        if self._was_heard:
            self._refused_before, self._was_heard = refused, False
        elif self._refused_before is not None and refused > self._refused_before:
            self._refused_before = None
            self._log.warning("messages of MAVLink are refused", why=WHY_REFUSED)

    def _say_records(self) -> None:
        recorders = (self._sent, self._node) if isinstance(self._node, RecordingNode) else (self._sent,)
        if lost := sum(one.records_lost for one in recorders):
            self._are_records_told = True
            why = next(one.why_lost for one in recorders if one.records_lost)
            self._log.warning("records are lost", lost=lost, why=why)
            self._node.warn(f"does not record: {why}")
