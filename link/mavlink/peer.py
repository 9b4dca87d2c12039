"""Who is at the other end: which messages are the autopilot's, whether it is heard, whether it restarted."""

from dataclasses import dataclass

from link.mavlink.dialect import Message
from link.mavlink.events import AutopilotRestarted, Event, LinkFound, LinkLost, LinkRegained
from link.mavlink.heartbeat import AUTOPILOT_COMPONENT_ID, is_autopilot_heartbeat
from link.mavlink.session_config import SessionConfig, duration_ns

_BROADCAST = 0


@dataclass(frozen=True, slots=True)
class Address:
    """A MAVLink system and component."""

    system_id: int
    component_id: int

    def is_meant_by(self, message: Message) -> bool:
        """Whether a message is for this address: named by it, by a broadcast, or by having no target at all."""
        system: int = getattr(message, "target_system", _BROADCAST)
        component: int = getattr(message, "target_component", _BROADCAST)
        return system in (_BROADCAST, self.system_id) and component in (_BROADCAST, self.component_id)


class Peer:
    """The autopilot as seen from a companion.

    Args:
        own: our own address.
        target_system_id: whose messages are taken; None takes the first autopilot that is heard.
        config: patience.
    """

    def __init__(self, own: Address, target_system_id: int | None, config: SessionConfig) -> None:
        self.target_system_id = target_system_id
        self.autopilot: int | None = None
        self.vehicle_type: int | None = None
        self.is_up = False
        self.others: set[int] = set()
        """Systems of further autopilots that were heard."""
        self._own = own
        self._lost_after_ns = duration_ns(config.link_lost_after_s)
        self._last_heard_ns = 0

    def accepts(self, message: Message) -> bool:
        """Whether a message is from the autopilot and for us or for everybody."""
        if self.target_system_id is None:
            return is_autopilot_heartbeat(message)
        if message.get_srcSystem() != self.target_system_id and is_autopilot_heartbeat(message):
            self.others.add(message.get_srcSystem())
        return bool(
            message.get_srcSystem() == self.target_system_id
            and message.get_srcComponent() == AUTOPILOT_COMPONENT_ID
            and self._own.is_meant_by(message)
        )

    def heard(self, message: Message, t_ns: int) -> list[Event]:
        """Takes note of an accepted message; returns what it says about the link."""
        events: list[Event] = []
        if is_autopilot_heartbeat(message):
            events = self._heartbeat(message, t_ns)
        if self.autopilot is not None and not self.is_up:
            events.append(LinkRegained(t_ns=t_ns, silence_ns=t_ns - self._last_heard_ns))
            self.is_up = True
        self._last_heard_ns = t_ns
        return events

    def poll(self, t_ns: int) -> list[Event]:
        """Tells when the autopilot has been silent for too long."""
        if not self.is_up or t_ns - self._last_heard_ns <= self._lost_after_ns:
            return []
        self.is_up = False
        return [LinkLost(t_ns=t_ns, last_heard_ns=self._last_heard_ns)]

    def _heartbeat(self, message: Message, t_ns: int) -> list[Event]:
        is_first = self.autopilot is None
        self.target_system_id = message.get_srcSystem()
        self.autopilot = message.autopilot
        self.vehicle_type = message.type
        if not is_first:
            return []
        self.is_up = True
        return [
            LinkFound(
                t_ns=t_ns,
                system_id=message.get_srcSystem(),
                component_id=message.get_srcComponent(),
                autopilot=message.autopilot,
                vehicle_type=message.type,
            )
        ]


class RestartWatch:
    """Notices a restart by the time since boot, and is not misled by messages that come late.

    Args:
        config: threshold and confirmations.
    """

    def __init__(self, config: SessionConfig) -> None:
        self._threshold_ns = duration_ns(config.restart_threshold_s)
        self._confirmations = config.restart_confirmations
        self._newest_ns = 0
        self._earlier_in_a_row = 0

    def see(self, boot_ns: int, t_ns: int) -> AutopilotRestarted | None:
        """Takes note of a boot time of the autopilot; returns the restart that it proves, if it does."""
        if boot_ns >= self._newest_ns - self._threshold_ns:
            self._newest_ns = max(self._newest_ns, boot_ns)
            self._earlier_in_a_row = 0
            return None
        self._earlier_in_a_row += 1
        if self._earlier_in_a_row < self._confirmations:
            return None
        before_ns, self._newest_ns = self._newest_ns, boot_ns
        self._earlier_in_a_row = 0
        return AutopilotRestarted(t_ns=t_ns, boot_before_ns=before_ns, boot_now_ns=boot_ns)
