"""Commands for the companion from ground stations and scripts, and their acknowledgements, without I/O.

MAV_CMD_USER_1 starts a landing, USER_2 holds it, USER_3 aborts it; USER_4 launches from the vehicle, USER_5 calls home
to it. A start is acknowledged as in progress with its percentage, once a second and with each phase, until it has
ended. Each command has to name the component: what a ground station sends to all components does none of this.
What begins a flight is obeyed once: a network that delivers it again, after a hold or when the pilot has taken over,
must not begin another. It is told by its bytes, its number included; holds and aborts are always obeyed, and first.
Source: MAVLink command protocol, https://mavlink.io/en/services/command.html.
"""

from collections import deque
from typing import NamedTuple

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.mavlink.dialect import MAV_RESULT_CANCELLED, Message, mavlink
from link.mavlink.repeats import DELIVERED_AGAIN_NS
from link.mavlink.timer import Timer
from link.messages import Command, CommandReply, LandingStatus

COMMANDS = {
    int(mavlink.MAV_CMD_USER_1): Command.START,
    int(mavlink.MAV_CMD_USER_2): Command.HOLD,
    int(mavlink.MAV_CMD_USER_3): Command.ABORT,
    int(mavlink.MAV_CMD_USER_4): Command.LAUNCH,
    int(mavlink.MAV_CMD_USER_5): Command.RETURN,
}
_START = int(mavlink.MAV_CMD_USER_1)
_ENDS = (int(mavlink.MAV_CMD_USER_2), int(mavlink.MAV_CMD_USER_3), None)  # what a landing or a sortie ends by
_PROGRESS_NS = 1_000_000_000  # MAVSDK waits for 3 s, QGroundControl for 3 s
_REPEATED_NS = 5_000_000_000  # an acknowledgement that was lost is given again for so long
_WAITING_MAX = 16
_PERCENT_UNKNOWN = 255
_PERCENT = {
    Phase.TAKEOFF: 10,
    Phase.WAITING: 20,
    Phase.ABORT: 20,
    Phase.RETURN: 30,
    Phase.RALLY: 20,
    Phase.CHASE: 40,
    Phase.ALIGN: 60,
    Phase.DESCEND: 80,
    Phase.TOUCHDOWN: 95,
}
"""How far a landing is, by its phases: how long each takes, nobody knows before."""
_OPERATORS = {one.name for one in (Reason.OPERATOR_ABORTS, Reason.OPERATOR_HOLDS, Reason.BROKEN_OFF)}


class _Asked(NamedTuple):
    """A command, None for a cancelled start, and who gave it."""

    system: int
    component: int
    number: int | None

    def acknowledge(self, result: int, percent: int = _PERCENT_UNKNOWN) -> Message:
        number = _START if self.number is None else self.number
        return mavlink.MAVLink_command_ack_message(number, result, percent, 0, self.system, self.component)


class StationCommands:
    """The commands under way."""

    def __init__(self) -> None:
        self._waiting: deque[_Asked] = deque()
        self._asked: _Asked | None = None
        self._running: _Asked | None = None
        self._answered: dict[_Asked, tuple[int, int]] = {}
        self._frames: dict[_Asked, bytes] = {}
        self._obeyed_ns: dict[bytes, int] = {}
        self._progress = Timer(_PROGRESS_NS)
        self._told: Phase | None = None

    def take(self, message: Message, local_ns: int) -> list[Message]:
        """Take a COMMAND_LONG or COMMAND_INT of ours; return what is to be answered at once."""
        asked = _Asked(message.get_srcSystem(), message.get_srcComponent(), int(message.command))
        if asked.number not in COMMANDS:
            return [asked.acknowledge(mavlink.MAV_RESULT_UNSUPPORTED)]
        if asked == self._running:
            return [asked.acknowledge(mavlink.MAV_RESULT_IN_PROGRESS)]
        result, answered_ns = self._answered.get(asked, (0, local_ns - _REPEATED_NS))
        if getattr(message, "confirmation", 0) and local_ns - answered_ns < _REPEATED_NS:
            return [asked.acknowledge(result)]
        if asked.number not in _ENDS:
            frame = bytes(message.get_msgbuf())
            if local_ns - self._obeyed_ns.get(frame, local_ns - DELIVERED_AGAIN_NS) < DELIVERED_AGAIN_NS:
                return [asked.acknowledge(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)]
            waiting = {who: its for who, its in self._frames.items() if who in (*self._waiting, self._asked)}
            self._frames = waiting | {asked: frame}
        return self._wait(asked)

    def cancel(self, message: Message) -> list[Message]:
        """Take a COMMAND_CANCEL, which ends a start as an abort does."""
        if self._running is None or message.command != _START:
            return []
        return self._wait(_Asked(message.get_srcSystem(), message.get_srcComponent(), None))

    def next(self, *, only_ends: bool = False) -> Command | None:
        """Return the command for the step that is made now, None when nobody waits for one.

        Args:
            only_ends: nothing but what ends a landing or a sortie.
        """
        if not self._waiting or (only_ends and self._waiting[0].number not in _ENDS):
            return None
        self._asked = self._waiting.popleft()
        return Command.ABORT if self._asked.number is None else COMMANDS[self._asked.number]

    def refuse_beginnings(self) -> list[Message]:
        """Refuse what waits for a step and would begin something."""
        refused = [asked for asked in self._waiting if asked.number not in _ENDS]
        self._waiting = deque(asked for asked in self._waiting if asked.number in _ENDS)
        return [asked.acknowledge(mavlink.MAV_RESULT_TEMPORARILY_REJECTED) for asked in refused]

    def answer(self, reply: CommandReply, local_ns: int) -> list[Message]:
        """Take a step's reply to the command of `next`."""
        asked, self._asked = self._asked, None
        if asked is None or asked.number is None:
            return []
        if not reply.accepted:
            return [asked.acknowledge(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)]
        if asked in self._frames:
            lately = {frame: then for frame, then in self._obeyed_ns.items() if local_ns - then < DELIVERED_AGAIN_NS}
            self._obeyed_ns = lately | {self._frames.pop(asked): local_ns}
        if asked.number == _START:
            self._running, self._told = asked, None
            return []  # the first of its progress follows at once
        self._note(asked, mavlink.MAV_RESULT_ACCEPTED, local_ns)
        return [asked.acknowledge(mavlink.MAV_RESULT_ACCEPTED)]

    def follow(self, phase: Phase, status: LandingStatus, local_ns: int) -> list[Message]:
        """Tell who has started a landing how far it is, and how it has ended."""
        running = self._running
        if running is None:
            return []
        if phase in _PERCENT:
            if phase is not self._told:
                self._told = phase
                self._progress.restart()
            is_due = self._progress.is_due(local_ns)
            return [running.acknowledge(mavlink.MAV_RESULT_IN_PROGRESS, _PERCENT[phase])] if is_due else []
        self._running = None
        result = _result(phase, status)
        self._note(running, result, local_ns)
        return [running.acknowledge(result)]

    def _note(self, asked: _Asked, result: int, local_ns: int) -> None:
        """Keep an answer for as long as it may be asked for again."""
        lately = {who: then for who, then in self._answered.items() if local_ns - then[1] < _REPEATED_NS}
        self._answered = lately | {asked: (result, local_ns)}

    def _wait(self, asked: _Asked) -> list[Message]:
        """Let a command wait for a step; what is given twice waits once. What ends a flight goes first, and finds room.

        Else whoever floods the companion with starts would keep an abort from being heard.
        """
        if asked in self._waiting:
            return []
        ends = asked.number in _ENDS
        waiting = list(self._waiting)
        waiting.insert(sum(one.number in _ENDS for one in waiting) if ends else len(waiting), asked)
        self._waiting = deque(waiting[:_WAITING_MAX])
        return [one.acknowledge(mavlink.MAV_RESULT_TEMPORARILY_REJECTED) for one in waiting[_WAITING_MAX:]]


def _result(phase: Phase, status: LandingStatus) -> int:
    """Return the MAV_RESULT with which a landing has ended."""
    if phase is Phase.SECURED:
        return int(mavlink.MAV_RESULT_ACCEPTED)
    by_operator = status.reason_code in _OPERATORS
    return int(MAV_RESULT_CANCELLED if by_operator else mavlink.MAV_RESULT_FAILED)
