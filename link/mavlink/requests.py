"""What is asked of the autopilot until it answers or it has been enough: commands, one of a kind at a time; parameters.

An acknowledgement names the command only, not which of several it answers. So two commands with the same id, such as
two message intervals, are never under way together: the second waits for the end of the first.
Source: MAVLink command protocol, https://mavlink.io/en/services/command.html.
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import CommandAcknowledged, CommandTimedOut, ParameterMissing, ParameterRead
from link.mavlink.parameters import NAME_LENGTH_MAX, parameter_value

CommandParams = tuple[float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Retries:
    """How often a command is sent at most, and after which time without an acknowledgement it is sent again."""

    attempts: int = 5
    patience_ns: int = 500_000_000


PATIENT = Retries()
ONCE = Retries(attempts=1)
_PARAMS = 7
_AUTOPILOT = mavlink.MAV_COMP_ID_AUTOPILOT1
_CONFIRMATION_MAX = 255
_PROGRESS_NS = 10_000_000_000  # patience after an IN_PROGRESS


def command_params(params: Sequence[float]) -> CommandParams:
    """Fills up to seven parameters with zeros.

    Raises:
        ValueError: There are too many, or one is infinite.
    """
    if len(params) > _PARAMS or any(math.isinf(one) for one in params):
        raise ValueError(f"a command has up to {_PARAMS} parameters, none of them infinite, not {params}")
    one, two, three, four, five, six, seven = (*params, *([0.0] * (_PARAMS - len(params))))
    return one, two, three, four, five, six, seven


def command_message(target_system: int, command: int, params: CommandParams, confirmation: int) -> Message:
    """Returns the COMMAND_LONG to an autopilot, sent for the `confirmation`-th time again."""
    return mavlink.MAVLink_command_long_message(target_system, _AUTOPILOT, command, confirmation, *params)


@dataclass(slots=True)
class _Command:
    ticket: int
    command: int
    params: CommandParams
    retries: Retries
    attempts: int = 0
    due_ns: int = 0
    in_progress: bool = False


class CommandSender:
    """The commands under way.

    Args:
        send: called with command, parameters and confirmation count to put a COMMAND_LONG on its way.
    """

    def __init__(self, send: Callable[[int, CommandParams, int], None]) -> None:
        self.retried = 0
        self.timed_out = 0
        self._send = send
        self._queues: dict[int, deque[_Command]] = {}
        self._last_ticket: dict[int, int] = {}
        self._tickets = 0

    def submit(self, command: int, params: CommandParams, t_ns: int, retries: Retries) -> int:
        """Queues a command and sends it when no other of its kind is under way; returns its ticket."""
        self._tickets += 1
        queue = self._queues.setdefault(command, deque())
        queue.append(_Command(self._tickets, command, params, retries))
        if len(queue) == 1:
            self._transmit(queue[0], t_ns)
        return self._tickets

    def acknowledged(self, message: Message, t_ns: int) -> CommandAcknowledged:
        """Takes a COMMAND_ACK."""
        queue = self._queues.get(message.command)
        pending = queue[0] if queue else None
        if queue and pending is not None:
            if message.result == mavlink.MAV_RESULT_IN_PROGRESS:
                pending.in_progress = True
                pending.due_ns = t_ns + _PROGRESS_NS
            else:
                self._finish(queue, t_ns)
        return CommandAcknowledged(
            t_ns=t_ns,
            command=message.command,
            result=message.result,
            ticket=pending.ticket if pending is not None else self._last_ticket.get(message.command),
            is_repeat=pending is None,
        )

    def poll(self, t_ns: int) -> list[CommandTimedOut]:
        """Sends again what was not answered and gives up what was sent often enough."""
        return [
            self._give_up(queue, t_ns)
            for queue in self._queues.values()
            if queue and t_ns >= queue[0].due_ns and not self._send_again(queue[0], t_ns)
        ]

    def drop_all(self, t_ns: int) -> list[CommandTimedOut]:
        """Gives up everything, as after a restart: a command meant for a flight must not reach the next one."""
        dropped = [one for queue in self._queues.values() for one in queue]
        self._queues.clear()
        self.timed_out += len(dropped)
        return [_time_out(one, t_ns) for one in dropped]

    def _send_again(self, pending: _Command, t_ns: int) -> bool:
        if pending.in_progress or pending.attempts >= pending.retries.attempts:
            return False
        self.retried += 1
        self._transmit(pending, t_ns)
        return True

    def _give_up(self, queue: deque[_Command], t_ns: int) -> CommandTimedOut:
        self.timed_out += 1
        return _time_out(self._finish(queue, t_ns), t_ns)

    def _finish(self, queue: deque[_Command], t_ns: int) -> _Command:
        done = queue.popleft()
        self._last_ticket[done.command] = done.ticket
        if queue:
            self._transmit(queue[0], t_ns)
        return done

    def _transmit(self, pending: _Command, t_ns: int) -> None:
        self._send(pending.command, pending.params, min(pending.attempts, _CONFIRMATION_MAX))
        pending.attempts += 1
        pending.due_ns = t_ns + pending.retries.patience_ns


def _time_out(pending: _Command, t_ns: int) -> CommandTimedOut:
    return CommandTimedOut(t_ns=t_ns, command=pending.command, ticket=pending.ticket, attempts=pending.attempts)


_PARAMETER_RETRY_NS = 500_000_000
_PARAMETER_ATTEMPTS = 6


@dataclass(slots=True)
class _Question:
    attempts: int
    due_ns: int


class ParameterReader:
    """The parameters asked for.

    Args:
        send: called with a parameter's name to put a PARAM_REQUEST_READ on its way.
    """

    def __init__(self, send: Callable[[str], None]) -> None:
        self._send = send
        self._questions: dict[str, _Question] = {}

    def read(self, name: str, t_ns: int) -> None:
        """Asks for a parameter, unless it has been asked for already.

        Raises:
            ValueError: No parameter can have this name.
        """
        if not (0 < len(name) <= NAME_LENGTH_MAX and name.isascii()):
            raise ValueError(f"a parameter's name has 1 to {NAME_LENGTH_MAX} ASCII characters, not {name!r}")
        if name not in self._questions:
            self._questions[name] = _Question(attempts=1, due_ns=t_ns + _PARAMETER_RETRY_NS)
            self._send(name)

    def received(self, message: Message, autopilot: int, t_ns: int) -> list[ParameterRead]:
        """Takes a PARAM_VALUE, which may be one that nobody asked for."""
        name: str = message.param_id
        value = parameter_value(message, autopilot)
        if name not in self._questions or value is None:
            return []
        del self._questions[name]
        return [ParameterRead(t_ns=t_ns, name=name, value=value)]

    def poll(self, t_ns: int) -> list[ParameterMissing]:
        """Asks again for what did not come and gives up what was asked for often enough."""
        due = [(name, question) for name, question in self._questions.items() if t_ns >= question.due_ns]
        return [ParameterMissing(t_ns=t_ns, name=name) for name, question in due if not self._ask_again(name, t_ns)]

    def start_over(self, t_ns: int) -> None:
        """Asks for everything outstanding again, as after a restart."""
        for name in self._questions:
            self._questions[name] = _Question(attempts=1, due_ns=t_ns + _PARAMETER_RETRY_NS)
            self._send(name)

    def _ask_again(self, name: str, t_ns: int) -> bool:
        question = self._questions[name]
        if question.attempts >= _PARAMETER_ATTEMPTS:
            del self._questions[name]
            return False
        question.attempts += 1
        question.due_ns = t_ns + _PARAMETER_RETRY_NS
        self._send(name)
        return True
