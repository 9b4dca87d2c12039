"""The component without I/O: answers requests, reports each step, and sends its periodic messages."""

from collections.abc import Iterable, Sequence

from companion.autopilots.state import AutopilotState
from companion.component.commands import COMMANDS, StationCommands
from companion.component.identity import ComputerLoad, component_information, computer_status, heartbeat_state
from companion.component.pad_messages import adsb_vehicle, follow_target
from companion.component.parameters import answers
from companion.component.texts import Texts, cut_text
from companion.config.autopilot import PadOnMap
from companion.config.companion import CompanionConfig
from companion.landing.step_data import StepOutputs
from companion.situation.phases import FLYING_PHASES, Phase
from link.mavlink.dialect import COMMAND_CANCEL_ID, COMPONENT_INFORMATION_BASIC_ID, Message, mavlink
from link.mavlink.session import MavlinkSession
from link.mavlink.timer import Timer
from link.messages import Command, CommandReply

_PAD_NS = 500_000_000
_COMMAND_IDS = (mavlink.MAVLINK_MSG_ID_COMMAND_LONG, mavlink.MAVLINK_MSG_ID_COMMAND_INT)


class MavlinkComponent:
    """What ground stations see of a companion.

    Args:
        session: by which it sends.
        is_open: it hears ground stations, and tells them more than what is new.
    """

    def __init__(self, session: MavlinkSession, *, is_open: bool) -> None:
        self._is_open = is_open
        self._session = session
        self._commands = StationCommands()
        self._texts = Texts()
        self._pad_timer = Timer(_PAD_NS)
        self._load: ComputerLoad | None = None

    def take(
        self, requests: Sequence[Message], config: CompanionConfig, phase: Phase, local_ns: int
    ) -> CompanionConfig:
        """Take what others have asked; return the configuration that holds then."""
        for message in requests if self._is_open else ():
            kind = message.get_msgId()
            if kind in _COMMAND_IDS:
                self._take_command(message, config, local_ns)
            elif kind == COMMAND_CANCEL_ID:
                self._send(self._commands.cancel(message))
            else:
                may_change = config.ground_station.takes_mavlink_commands and phase not in FLYING_PHASES
                config, told = answers(message, config, may_change=may_change)
                self._send(told)
        return config

    def next_command(self) -> Command | None:
        """Return what the step that is made now is commanded; None when nobody waits for one."""
        return self._commands.next()

    def answer(self, reply: CommandReply, local_ns: int) -> bool:
        """Take the step's reply to a command; return whether it was to one of `next_command`."""
        if not self._commands.is_asked:
            return False
        self._send(self._commands.answer(reply, local_ns))
        if not reply.accepted:
            self._send(self._texts.pieces(f"refuses: {reply.reason}", mavlink.MAV_SEVERITY_WARNING))
        return True

    def tell(
        self, outputs: StepOutputs, phase: Phase, state: AutopilotState, config: CompanionConfig, local_ns: int
    ) -> None:
        """Tell what a step has brought."""
        if not self._is_open:
            self._send([] if outputs.text is None else [cut_text(outputs.text)])
            return
        self._session.heartbeat_state = heartbeat_state(phase)
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
        if message.param1 == COMPONENT_INFORMATION_BASIC_ID:
            answer = component_information((self._session.clock.local_to_boot_ns(local_ns) or 0) // 1_000_000)
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
