"""What a step is commanded, and who hears the reply: the pilot's switch before operators, these before stations.

A station's hold or abort goes before what an operator begins: operators who ask in every step would keep it waiting.
"""

from collections.abc import Callable
from enum import Enum, auto

from companion.component.component import MavlinkComponent
from companion.core.reasons import Cause, Reason, sentence
from link.messages import Command, CommandReply, Station

_ENDS = (Command.HOLD, Command.ABORT)


class _Sender(Enum):
    SWITCH = auto()
    OPERATOR = auto()
    STATION = auto()


class StepCommands:
    """The commands that wait for a step, and the replies that wait for operators.

    Args:
        component: by which ground stations command, and by which the pilot is told of a refusal.
    """

    def __init__(self, component: MavlinkComponent) -> None:
        self._component = component
        self._requested: tuple[Command, Station | None] | None = None
        self._sent: tuple[_Sender, Command] | None = None
        self._replies: list[CommandReply] = []

    @property
    def waits(self) -> bool:
        """Whether an operator's command waits for a step."""
        return self._requested is not None

    def request(self, command: Command, station: Station | None) -> None:
        """Take an operator's command, a follow with its station."""
        self._requested = command, station

    def next(
        self, switched: Command | None, start_refusal: Callable[[], CommandReply | None], local_ns: int
    ) -> tuple[Command | None, Station | None]:
        """Return the command for the step that is made now, and the station of a follow.

        Args:
            switched: what the pilot's switch commands.
            start_refusal: the answer to a start that no step is to judge; an operator's has been asked before.
            local_ns: on the companion's own clock.
        """
        if switched in _ENDS:
            self._refuse_beginnings()
        sender, wanted = _Sender.SWITCH, switched
        if switched is None:
            sender, wanted = _Sender.STATION, self._of_station()
        if wanted is None and self._requested is not None:
            (command, station), self._requested = self._requested, None
            self._sent = _Sender.OPERATOR, command
            return command, station
        self._sent = None if wanted is None else (sender, wanted)
        refusal = start_refusal() if wanted is Command.START else None
        if refusal is None:
            return wanted, None
        self.answer(refusal, local_ns)
        return None, None

    def _of_station(self) -> Command | None:
        """Return what a ground station has asked for, if it goes before what an operator has."""
        if self._requested is not None and self._requested[0] in _ENDS:
            return None
        return self._component.next_command(only_ends=self._requested is not None)

    def _refuse_beginnings(self) -> None:
        """Refuse what waits to begin something, which the next step would do against the pilot."""
        self._component.refuse_beginnings()
        if self._requested is not None and self._requested[0] not in _ENDS:
            self._requested = None
            refusal = sentence(Cause(Reason.PILOT_SWITCHES_OFF))
            self._replies.append(CommandReply(accepted=False, reason=refusal))

    def answer(self, reply: CommandReply, local_ns: int) -> None:
        """Give the reply to who has sent the command; a pilot is told of a start that is refused, and of nothing else.

        A hold or an abort with nothing under way is a switch that is put where it belongs.
        """
        match self._sent:
            case (_Sender.OPERATOR, _):
                self._replies.append(reply)
            case (_Sender.STATION, _):
                self._component.answer(reply, local_ns)
            case (_Sender.SWITCH, Command.START) if not reply.accepted:
                self._component.refuse(reply.reason)
            case _:
                pass
        self._sent = None

    def take_replies(self) -> list[CommandReply]:
        """Return the replies to operators, once, in their order."""
        taken, self._replies = self._replies, []
        return taken


def refuse_motors_off() -> CommandReply:
    """Return the answer to a switch that may not start the motors."""
    return CommandReply(accepted=False, reason=sentence(Cause(Reason.MOTORS_OFF_AT_SWITCH)))
