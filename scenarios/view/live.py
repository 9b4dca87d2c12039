"""A landing as it goes on, off Zenoh; it only listens, and passes an operator's commands on."""

from link.messages import Command, CommandReply, Order
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.view.history import ROWS_MAX, History
from scenarios.view.state import StateReader, ViewState

_ANSWER_S = 3.0
_ASK_PAD_S = 1.0


class LiveSource:
    """What is heard on Zenoh.

    Args:
        zenoh: an open session.
        keys: of the Zenoh contract.

    Attributes:
        state: the newest.
        history: of the states.
        bad_payloads: messages that could not be read.
    """

    def __init__(self, zenoh: ZenohSession, keys: Keys) -> None:
        self.state = ViewState()
        self.history = History(rows_max=ROWS_MAX)
        self.bad_payloads = 0
        self._zenoh = zenoh
        self._keys = keys
        self._reader = StateReader(keys)
        unpublished = {keys.pad, keys.record("plan"), keys.record("step"), keys.camera_compressed}
        self._inboxes: list[Inbox] = [zenoh.subscribe(topic) for topic in self._reader.topics - unpublished]
        self._companions = zenoh.watch_alive(keys.companion_alive("*"))
        self._pads: Inbox | None = None
        self._asked_s = -_ASK_PAD_S

    @property
    def shown(self) -> int:
        """How many rows of the history are in the past."""
        return len(self.history.times_s)

    def advance(self, now_s: float) -> ViewState:
        """Take what has come; only the newest message of each topic is read."""
        self._ask_for_pad(now_s)
        for inbox in (*self._inboxes, *(() if self._pads is None else (self._pads,))):
            samples = inbox.take()
            if samples:
                self._take(samples[-1].key, samples[-1].payload)
        self.history.add(self.state)
        return self.state

    def send(self, command: Command) -> CommandReply:
        """Ask the companion and return its answer; one that is silent refuses."""
        answers = self._zenoh.query(self._keys.landing_command, json_messages.encode(Order(command=command)), _ANSWER_S)
        if not answers:
            return CommandReply(accepted=False, reason="no companion answers")
        if not self._companions.alive:
            return CommandReply(accepted=False, reason="no companion runs, but somebody answers")
        try:
            replies = [json_messages.decode(CommandReply, answer) for answer in answers]
        except PayloadError as error:
            return CommandReply(accepted=False, reason=f"its answer cannot be read: {error}")
        if len(replies) > 1:
            said = "; ".join(sorted(map(str, replies)))
            return CommandReply(accepted=False, reason=f"{len(replies)} programs answer: end all but one ({said})")
        return replies[0]

    def _take(self, topic: str, payload: bytes) -> None:
        try:
            self.state = self._reader.taken(self.state, topic, payload)
        except PayloadError:
            self.bad_payloads += 1

    def _ask_for_pad(self, now_s: float) -> None:
        if self.state.pad is None and now_s - self._asked_s >= _ASK_PAD_S:
            self._asked_s = now_s
            self._pads = self._zenoh.ask(self._keys.pad, b"", _ASK_PAD_S)
