"""The component without I/O: answers requests, reports each step, and sends its periodic messages."""

from collections.abc import Iterable, Sequence

from companion.autopilots.driver import AutopilotView
from companion.autopilots.state import AutopilotState
from companion.component.commands import COMMANDS, StationCommands
from companion.component.identity import (
    ComputerLoad,
    component_information,
    computer_status,
    heartbeat_state,
    tells_of_flight,
)
from companion.component.metadata import FileServer, component_metadata
from companion.component.pad_messages import adsb_vehicle, follow_target
from companion.component.parameters import answers
from companion.config.autopilot import PadOnMap
from companion.config.companion import CompanionConfig
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepOutputs
from companion.situation.phases import FLYING_PHASES, Phase
from link.mavlink.dialect import (
    COMMAND_CANCEL_ID,
    COMPONENT_INFORMATION_BASIC_ID,
    COMPONENT_METADATA_ID,
    Message,
    mavlink,
)
from link.mavlink.peer import LOST_AFTER_NS
from link.mavlink.session import MavlinkSession
from link.mavlink.timer import Timer
from link.messages import Command, CommandReply, LandingStatus

_TEXT_SIZE = 50  # of a STATUSTEXT; longer ones are sent in pieces of one id
_IDS = 0xFFFF
_LASTS_NS = 1_000_000_000  # what holds a landing up for less is not told
_APART_NS = 5_000_000_000
_WARNED_OF = frozenset({Phase.ABORT, Phase.HOLD, Phase.PILOT, Phase.RALLY})
_BEGINNINGS = frozenset({Phase.TAKEOFF, Phase.ON_DECK})
_TOLD_IN = frozenset({Phase.WAITING.value, Phase.CHASE.value, Phase.ALIGN.value, Phase.DESCEND.value})


def cut_text(text: str, severity: int = mavlink.MAV_SEVERITY_INFO) -> Message:
    """Return the one STATUSTEXT that a text has to fit into, cut where it is longer."""
    return mavlink.MAVLink_statustext_message(severity, _encoded(text)[:_TEXT_SIZE])


class Texts:
    """Makes STATUSTEXTs."""

    def __init__(self) -> None:
        self._last_id = 0
        self._told_ns: int | None = None
        self._told: tuple[str, str] | None = None
        self._since: tuple[tuple[str, str], int] | None = None

    def news(self, text: str, phase: Phase, status: LandingStatus, local_ns: int) -> list[Message]:
        """Return what says that something is new: a phase, or what stands in a landing's way."""
        self._told, self._told_ns = _matter(status), local_ns
        return self.pieces(text, mavlink.MAV_SEVERITY_WARNING if phase in _WARNED_OF else mavlink.MAV_SEVERITY_INFO)

    def progress(self, status: LandingStatus, local_ns: int) -> list[Message]:
        """Return what says why a landing waits, once that has lasted and the last text can have been read."""
        matter = _matter(status)
        if status.phase not in _TOLD_IN or matter == self._told:
            self._since = None
            return []
        if self._since is None or self._since[0] != matter:
            self._since = matter, local_ns
        long_ago = self._told_ns is None or local_ns - self._told_ns >= _APART_NS
        if not long_ago or local_ns - self._since[1] < _LASTS_NS:
            return []
        self._told, self._told_ns = matter, local_ns
        return self.pieces(f"{status.phase}: {status.reason}", mavlink.MAV_SEVERITY_INFO)

    def pieces(self, text: str, severity: int) -> list[Message]:
        """Return the STATUSTEXTs of a text."""
        told = _encoded(text)
        if len(told) <= _TEXT_SIZE:
            return [cut_text(text, severity)]
        self._last_id = self._last_id % _IDS + 1
        pieces = [told[start : start + _TEXT_SIZE] for start in range(0, len(told), _TEXT_SIZE)]
        if len(pieces[-1]) == _TEXT_SIZE:
            pieces.append(b"")  # a piece that is not full says that it is the last
        return [
            mavlink.MAVLink_statustext_message(severity, piece, self._last_id, place)
            for place, piece in enumerate(pieces)
        ]


def _encoded(text: str) -> bytes:
    return f"Decklander {text}".encode("ascii", "replace")


def _matter(status: LandingStatus) -> tuple[str, str]:
    return status.phase, status.reason_code


_PAD_NS = 500_000_000
_COMMAND_IDS = (mavlink.MAVLINK_MSG_ID_COMMAND_LONG, mavlink.MAVLINK_MSG_ID_COMMAND_INT)


class MavlinkComponent:
    """What ground stations see of a companion.

    Args:
        session: by which it sends.
        is_open: it hears ground stations, and tells them more than what is new.
        dry_run: it flies nothing, whatever the phase.
    """

    def __init__(self, session: MavlinkSession, *, is_open: bool, dry_run: bool) -> None:
        self._is_open, self._dry_run = is_open, dry_run
        self._session = session
        self._commands = StationCommands()
        self._files = FileServer()
        self._texts = Texts()
        self._pad_timer = Timer(_PAD_NS)
        self._load: ComputerLoad | None = None
        self._other_flies_ns: int | None = None
        self._found_ns: int | None = None
        self.would_know_of_flight = not is_open
        """Whether another companion that flies the drone would have been heard by now."""

    def is_drone_flown(self, memory: StepMemory, view: AutopilotView, local_ns: int) -> bool:
        """Return whether another companion flies the drone that this one does not, as its heartbeats have just told.

        They come where the autopilot passes them on, and need no network that both companions share. Who flies goes
        on; of two that start at the same moment both give way, before the motors are ordered or on the ground.
        """
        told_ns = self._other_flies_ns
        phase = memory.progress.phase
        begins = phase in _BEGINNINGS and (not memory.control.driver.arm_asked or view.landed is True)
        gives_way = begins or phase not in FLYING_PHASES
        return gives_way and told_ns is not None and local_ns - told_ns <= LOST_AFTER_NS

    def take(
        self, requests: Sequence[Message], config: CompanionConfig, phase: Phase, local_ns: int
    ) -> CompanionConfig:
        """Take what others have asked; return the configuration that holds then."""
        self._listen(local_ns)
        for message in requests if self._is_open else ():
            kind = message.get_msgId()
            if kind in _COMMAND_IDS:
                self._take_command(message, config, local_ns)
            elif kind == COMMAND_CANCEL_ID:
                self._send(self._commands.cancel(message))
            elif kind == mavlink.MAVLINK_MSG_ID_HEARTBEAT:
                self._hear_other(message, local_ns)
            elif kind == mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL:
                self._send(self._files.answer(message, local_ns))
            else:
                may_change = config.ground_station.takes_mavlink_commands and phase not in FLYING_PHASES
                config, told = answers(message, config, may_change=may_change)
                self._send(told)
        self._send(self._files.continue_burst())
        return config

    def _listen(self, local_ns: int) -> None:
        """Take note of how long the autopilot has been heard, which passes on what another companion tells."""
        if self._found_ns is None and self._session.link_up:
            self._found_ns = local_ns
        if self._found_ns is not None and local_ns - self._found_ns > LOST_AFTER_NS:
            self.would_know_of_flight = True

    def _hear_other(self, heartbeat: Message, local_ns: int) -> None:
        if tells_of_flight(heartbeat):
            self._other_flies_ns = local_ns

    def next_command(self, *, only_ends: bool = False) -> Command | None:
        """Return what the step that is made now is commanded, or only what ends a flight; None when nobody waits."""
        return self._commands.next(only_ends=only_ends)

    def answer(self, reply: CommandReply, local_ns: int) -> None:
        """Take the step's reply to the command of `next_command`."""
        self._send(self._commands.answer(reply, local_ns))
        if not reply.accepted:
            self.refuse(reply.reason)

    def refuse_beginnings(self) -> None:
        """Refuse what ground stations have asked for and no step has begun."""
        self._send(self._commands.refuse_beginnings())

    def refuse(self, why: str) -> None:
        """Tell people why a command was refused."""
        self.warn(f"refuses: {why}")

    def warn(self, of_what: str) -> None:
        """Tell people what is not as it should be."""
        self._send(self._texts.pieces(of_what, mavlink.MAV_SEVERITY_WARNING))

    def tell(
        self, outputs: StepOutputs, phase: Phase, state: AutopilotState, config: CompanionConfig, local_ns: int
    ) -> None:
        """Tell what a step has brought."""
        if not self._is_open:
            self._send([] if outputs.text is None else [cut_text(outputs.text)])
            return
        self._session.heartbeat.tell(heartbeat_state(phase, dry_run=self._dry_run))
        if outputs.text is not None:
            self._send(self._texts.news(outputs.text, phase, outputs.status, local_ns))
        else:
            self._send(self._texts.progress(outputs.status, local_ns))
        self._send(self._commands.follow(phase, outputs.status, local_ns))
        if outputs.pad is not None and self._pad_timer.is_due(local_ns):
            boot_ms = (self._session.clock.local_to_boot_ns(local_ns) or 0) // 1_000_000
            if config.ground_station.pad_on_map is not PadOnMap.NONE:
                self._send([follow_target(outputs.pad, state, boot_ms)])
            if config.ground_station.pad_on_map is PadOnMap.ADSB:
                self._send([adsb_vehicle(outputs.pad, state)])

    def tell_load(self, load: ComputerLoad, local_ns: int) -> None:
        """Tell what the computer does."""
        self._load = load
        self._send([computer_status(load, self._session.clock.local_to_utc_ns(local_ns))])

    def _take_command(self, message: Message, config: CompanionConfig, local_ns: int) -> None:
        if message.command == mavlink.MAV_CMD_REQUEST_MESSAGE:
            self._take_question(message, local_ns)
        elif message.command in COMMANDS and not config.ground_station.takes_mavlink_commands:
            self._acknowledge(message, mavlink.MAV_RESULT_DENIED)
        else:
            self._send(self._commands.take(message, local_ns))

    def _take_question(self, message: Message, local_ns: int) -> None:
        """Answer a MAV_CMD_REQUEST_MESSAGE."""
        answer: Message | None = None
        boot_ms = (self._session.clock.local_to_boot_ns(local_ns) or 0) // 1_000_000
        if message.param1 == COMPONENT_INFORMATION_BASIC_ID:
            answer = component_information(boot_ms)
        elif message.param1 == COMPONENT_METADATA_ID:
            answer = component_metadata(boot_ms)
        elif message.param1 == mavlink.MAVLINK_MSG_ID_ONBOARD_COMPUTER_STATUS and self._load is not None:
            answer = computer_status(self._load, self._session.clock.local_to_utc_ns(local_ns))
        is_known = answer is not None
        self._acknowledge(message, mavlink.MAV_RESULT_ACCEPTED if is_known else mavlink.MAV_RESULT_UNSUPPORTED)
        self._send([answer])

    def _acknowledge(self, message: Message, result: int) -> None:
        who = message.get_srcSystem(), message.get_srcComponent()
        self._send([mavlink.MAVLink_command_ack_message(message.command, result, 255, 0, *who)])

    def _send(self, messages: Iterable[Message | None]) -> None:
        for message in messages:
            if message is not None:
                self._session.send(message)
