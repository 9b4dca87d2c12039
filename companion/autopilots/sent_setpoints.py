"""Sends setpoints, and tells by what the autopilot says that it flies to which of them it has heard."""

from companion.autopilots.driver import Driver
from companion.core.data import Setpoint
from link.mavlink.answers import Answers, with_answer
from link.mavlink.dialect import Message
from link.mavlink.session import MavlinkSession

_KEPT = 64  # more than a second of them


class SentSetpoints:
    """The setpoints of late.

    Args:
        session: to the autopilot.

    Attributes:
        answers: how they show in the autopilot's POSITION_TARGET_LOCAL_NED.
        bad: how many the message could not hold; they were left out.
    """

    def __init__(self, session: MavlinkSession) -> None:
        self.answers = Answers()
        self.bad = 0
        self._session = session
        self._sent: dict[int, Message] = {}  # by local time, in ns

    def send(self, setpoint: Setpoint, driver: Driver, local_ns: int) -> None:
        """Send one for the flight."""
        target = self._session.target_system_id
        if target is None:
            return
        boot_ns = self._session.clock.local_to_boot_ns(local_ns) or 0
        try:
            message = driver.setpoint_message(setpoint, boot_ns // 1_000_000, target)
        except ValueError:
            self.bad += 1
            return
        self._session.send(message)
        self._sent[local_ns] = message
        if len(self._sent) > _KEPT:
            del self._sent[next(iter(self._sent))]

    def hear(self, told: Message, driver: Driver, local_ns: int) -> None:
        """Take a POSITION_TARGET_LOCAL_NED; one that shows none of these tells nothing."""
        for sent_ns, sent in reversed(self._sent.items()):
            if driver.flies_to(sent, told):
                self.answers = with_answer(self.answers, sent_ns, local_ns)
                return

    def start_over(self) -> None:
        """Forget everything, as after a restart."""
        self.answers = Answers()
        self._sent.clear()
