"""Asking a vehicle for its pad until it has answered with one that fits."""

from typing import Protocol

from link.messages import PadGeometry
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.zenoh.inbox import Inbox

_AGAIN_S = 1.0


class Asks(Protocol):
    """What a question is sent by, such as a Zenoh session."""

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Ask whoever serves `key` and at once return the inbox into which the answers come."""


class PadQuestion:
    """Asks every second; one answer is enough, until it is asked anew.

    Args:
        zenoh: to ask by.
        key: of the pad.

    Attributes:
        is_answered: whether a pad has come, since it was last asked anew.
        bad_answers: that were no description of a pad.
        refused_why: what was wrong with the last one of them, None while there was none.
    """

    def __init__(self, zenoh: Asks, key: str) -> None:
        self._zenoh = zenoh
        self._key = key
        self._answers: Inbox | None = None
        self._asked_s = float("-inf")
        self.is_answered = False
        self.bad_answers = 0
        self.refused_why: str | None = None

    def ask_anew(self) -> None:
        """Ask once more, although there was an answer: it may be another vehicle."""
        self.is_answered = False

    def poll(self, now_s: float, *, asks: bool = True) -> PadGeometry | None:
        """Take answers, ask when that is due, and return a pad that has come.

        Args:
            now_s: of a monotonic clock.
            asks: whether there is anybody to ask.
        """
        pad = self._take()
        if asks and not self.is_answered and now_s - self._asked_s >= _AGAIN_S:
            self._asked_s = now_s
            self._answers = self._zenoh.ask(self._key, b"", _AGAIN_S)
        return pad

    def _take(self) -> PadGeometry | None:
        pad: PadGeometry | None = None
        for sample in () if self._answers is None else self._answers.take():
            try:
                pad = json_messages.decode(PadGeometry, sample.payload)
                self.is_answered = True
            except PayloadError as error:
                self.bad_answers += 1
                self.refused_why = str(error)
        return pad
