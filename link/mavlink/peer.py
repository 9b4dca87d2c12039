"""Who is at the other end: heartbeats, which messages are the autopilot's, and whether it is heard or has restarted."""

from dataclasses import dataclass

from link.mavlink.clock_map import ClockMap
from link.mavlink.dialect import COMMAND_CANCEL_ID, Message, mavlink
from link.mavlink.events import AutopilotRestarted, Event, LinkFound, LinkLost, LinkRegained

_BROADCAST = 0
LOST_AFTER_NS = 3_000_000_000  # of silence: three of the autopilot's heartbeats
_MODE_UNKNOWN_NS = 6_000_000_000  # six heartbeats, lost among other messages, where nothing else tells the mode
_TELL_MODE = frozenset({mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_CURRENT_MODE})
_JUMP_NS = 1_000_000_000  # boot time falling back by more is a restart, by less a late message
_JUMP_CONFIRMATIONS = 3  # so many messages in a row have to say so


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


_TO_ONE = frozenset(
    {
        mavlink.MAVLINK_MSG_ID_COMMAND_LONG,
        mavlink.MAVLINK_MSG_ID_COMMAND_INT,
        COMMAND_CANCEL_ID,
        mavlink.MAVLINK_MSG_ID_PARAM_SET,
        mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL,
    }
)
_REQUESTS_MAX = 100  # between two calls; a ground station asks for some at once
_TO_ALL = frozenset({mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST, mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ})


def is_request(message: Message, own: Address) -> bool:
    """Whether a message asks something of the component `own`.

    What changes anything has to name it: ground stations send the autopilot's own commands to all components, too.
    """
    kind = message.get_msgId()
    if kind in _TO_ONE:
        return bool(message.target_system == own.system_id and message.target_component == own.component_id)
    return kind in _TO_ALL and own.is_meant_by(message)


def is_beat(message: Message) -> bool:
    """Whether a message is a heartbeat, anybody's."""
    return bool(message.get_msgId() == mavlink.MAVLINK_MSG_ID_HEARTBEAT)


def is_beat_of(message: Message, address: Address) -> bool:
    """Whether a message is the heartbeat of `address`."""
    return is_beat(message) and Address(message.get_srcSystem(), message.get_srcComponent()) == address


class Peer:
    """The autopilot as seen from a companion.

    Args:
        own: our own address.
        target_system_id: whose messages are taken; None takes the first autopilot that is heard.
    """

    def __init__(self, own: Address, target_system_id: int | None) -> None:
        self.target_system_id = target_system_id
        self.autopilot: int | None = None
        self.vehicle_type: int | None = None
        self.is_up = False
        self.others: set[int] = set()
        """Systems of further autopilots that were heard."""
        self._own = own
        self._requests: list[Message] = []
        self._last_heard_ns = self._last_mode_ns = 0
        self._other_told: int | None = None

    def accepts(self, message: Message) -> bool:
        """Whether a message is from the autopilot and for us or for everybody; anybody's requests are kept."""
        is_for_us = is_request(message, self._own) or is_beat_of(message, self._own)
        if is_for_us and len(self._requests) < _REQUESTS_MAX:
            self._requests.append(message)
        if self.target_system_id is None:
            return is_autopilot_heartbeat(message)
        if is_beat(message) and message.autopilot == mavlink.MAV_AUTOPILOT_INVALID:
            return False  # of something that was left at the autopilot's address, which is many a library's default
        if message.get_srcSystem() != self.target_system_id and is_autopilot_heartbeat(message):
            self.others.add(message.get_srcSystem())
        return bool(
            message.get_srcSystem() == self.target_system_id
            and message.get_srcComponent() == AUTOPILOT_COMPONENT_ID
            and self._own.is_meant_by(message)
        )

    def take_requests(self) -> list[Message]:
        """Gives what was asked of us as a component since the last call, and heartbeats of whoever has our address."""
        taken, self._requests = self._requests, []
        return taken

    def heard(self, message: Message, t_ns: int) -> list[Event]:
        """Takes note of an accepted message; returns what it says about the link."""
        events: list[Event] = []
        if message.get_msgId() in _TELL_MODE:
            self._last_mode_ns = t_ns
        if is_autopilot_heartbeat(message):
            events = self._heartbeat(message, t_ns)
        if self.autopilot is not None and not self.is_up and t_ns - self._last_mode_ns <= _MODE_UNKNOWN_NS:
            events.append(LinkRegained(t_ns=t_ns, silence_ns=t_ns - self._last_heard_ns))
            self.is_up = True
        self._last_heard_ns = t_ns
        return events

    def poll(self, t_ns: int) -> list[Event]:
        """Tells when the autopilot has been silent, or has not told its mode, for too long."""
        is_heard = t_ns - self._last_heard_ns <= LOST_AFTER_NS and t_ns - self._last_mode_ns <= _MODE_UNKNOWN_NS
        if not self.is_up or is_heard:
            return []
        self.is_up = False
        return [LinkLost(t_ns=t_ns, last_heard_ns=self._last_heard_ns)]

    def _heartbeat(self, message: Message, t_ns: int) -> list[Event]:
        self.target_system_id = message.get_srcSystem()
        if self.autopilot is not None and not self._is_exchanged(message):
            self.vehicle_type = message.type
            return []
        self.autopilot, self.vehicle_type = message.autopilot, message.type
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

    def _is_exchanged(self, message: Message) -> bool:
        """Whether another kind of autopilot answers with its motors off, as after its firmware was exchanged.

        A single heartbeat may be anybody's.
        """
        is_other = message.autopilot != self.autopilot and not message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
        told: int | None = message.autopilot if is_other else None
        is_told_again, self._other_told = told is not None and told == self._other_told, told
        return is_told_again


class RestartWatch:
    """Notices a restart by the time since boot, misled neither by messages that come late nor by a forged one."""

    def __init__(self) -> None:
        self._newest_ns = 0
        self._heard_ns: int | None = None
        self._earlier_in_a_row = 0
        self._earlier_ns = 0
        self._ahead_in_a_row = 0

    def doubts(self, boot_ns: int, t_ns: int, clock: ClockMap) -> bool:
        """Whether a boot time, ahead of what the clock can show by now, is to be confirmed by further ones."""
        is_jump = self._heard_ns is not None and boot_ns > self._newest_ns + (t_ns - self._heard_ns) + _JUMP_NS
        self._ahead_in_a_row = self._ahead_in_a_row + 1 if is_jump or clock.is_ahead(boot_ns, t_ns) else 0
        return 0 < self._ahead_in_a_row < _JUMP_CONFIRMATIONS

    @property
    def is_behind(self) -> bool:
        """Whether the boot time seen last is so far behind that further ones have to confirm a restart."""
        return self._earlier_in_a_row > 0

    def _is_late(self, boot_ns: int, t_ns: int) -> bool:
        """Whether a boot time is more than has passed since the autopilot was last heard: no restart can be so old."""
        if self._heard_ns is None or t_ns - self._heard_ns > LOST_AFTER_NS:
            return False
        return boot_ns > t_ns - self._heard_ns + _JUMP_NS

    def see(self, boot_ns: int, t_ns: int) -> AutopilotRestarted | None:
        """Takes note of a boot time of the autopilot; returns the restart that it proves, if it does."""
        if boot_ns >= self._newest_ns - _JUMP_NS:
            if boot_ns >= self._newest_ns:
                self._newest_ns, self._heard_ns = boot_ns, t_ns
            self._earlier_in_a_row = 0
            return None
        if self._is_late(boot_ns, t_ns):
            self._earlier_in_a_row = 1
            return None
        # A clock runs on: frames of one instant, which come late together, tell of it once.
        if self._earlier_in_a_row == 0 or boot_ns > self._earlier_ns:
            self._earlier_in_a_row += 1
        self._earlier_ns = boot_ns
        if self._earlier_in_a_row < _JUMP_CONFIRMATIONS:
            return None
        before_ns, self._newest_ns, self._heard_ns = self._newest_ns, boot_ns, t_ns
        self._earlier_in_a_row = 0
        return AutopilotRestarted(t_ns=t_ns, boot_before_ns=before_ns, boot_now_ns=boot_ns)


AUTOPILOT_COMPONENT_ID: int = mavlink.MAV_COMP_ID_AUTOPILOT1
_MAVLINK_VERSION = 3  # of the messages' definitions, the same for all of MAVLink 1 and 2


def companion_heartbeat(status: int = mavlink.MAV_STATE_ACTIVE, mode: int = 0) -> Message:
    """The heartbeat of an onboard computer, which flies nothing itself.

    Args:
        status: MAV_STATE.
        mode: a number of its own.
    """
    return mavlink.MAVLink_heartbeat_message(
        type=mavlink.MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot=mavlink.MAV_AUTOPILOT_INVALID,
        base_mode=0,
        custom_mode=mode,
        system_status=status,
        mavlink_version=_MAVLINK_VERSION,
    )


def is_autopilot_heartbeat(message: Message) -> bool:
    """Whether a message is the heartbeat of an autopilot, not of a ground station, gimbal or companion."""
    return bool(
        is_beat(message)
        and message.get_srcComponent() == AUTOPILOT_COMPONENT_ID
        and message.autopilot != mavlink.MAV_AUTOPILOT_INVALID
    )
