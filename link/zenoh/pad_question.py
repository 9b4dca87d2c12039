"""Asking a vehicle for its pad until it has answered with one that fits.

Anybody on Zenoh may answer. So all that answer have to agree, and a pad that is flown to is never replaced by another.
"""

from typing import Protocol

from link.messages import PadGeometry
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.zenoh.inbox import Inbox

_AGAIN_S = 1.0
_GATHER_S = 0.5  # for the answers of all who answer; the links of a landing are ten times as quick
_CHANGED = "another pad than before, while it is flown to; it counts after this flight"


class Asks(Protocol):
    """What a question is sent by, such as a Zenoh session."""

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Ask whoever serves `key` and at once return the inbox into which the answers come."""


class PadQuestion:
    """Asks every second; one answer is enough, until it is asked again.

    Args:
        zenoh: to ask by.
        key: of the pad.

    Attributes:
        pad: that came last, None before one has come.
        is_answered: whether a pad has come, since it was last asked again.
        is_contradicted: the newest answers have another pad instead of `pad`, which is not believed yet.
        bad_answers: that were no description of a pad, or not to be believed.
        refused_why: what was wrong with the last one of them, None while there was none.
    """

    def __init__(self, zenoh: Asks, key: str) -> None:
        self._zenoh = zenoh
        self._key = key
        self._answers: Inbox | None = None
        self._gathered: list[PadGeometry] = []
        self.pad: PadGeometry | None = None
        self._asked_s = float("-inf")
        self.is_answered = False
        self.is_contradicted = False
        self.bad_answers = 0
        self.refused_why: str | None = None

    def ask_anew(self) -> None:
        """Ask once more, although there was an answer: it may be another vehicle."""
        self.is_answered = False

    def poll(self, now_s: float, *, asks: bool = True, may_change: bool = True) -> PadGeometry | None:
        """Take answers, ask when that is due, and return a pad that has come.

        Args:
            now_s: of a monotonic clock.
            asks: whether there is anybody to ask.
            may_change: whether another pad than that of before is believed.
        """
        self._take()
        pad = self._decide(may_change=may_change) if self._gathered and now_s - self._asked_s >= _GATHER_S else None
        if asks and not self.is_answered and now_s - self._asked_s >= _AGAIN_S:
            self._asked_s = now_s
            self._gathered.clear()
            self._answers = self._zenoh.ask(self._key, b"", _AGAIN_S)
        return pad

    def _take(self) -> None:
        for sample in () if self._answers is None else self._answers.take():
            try:
                self._gathered.append(json_messages.decode(PadGeometry, sample.payload))
            except PayloadError as error:
                self._refuse(str(error))

    def _decide(self, *, may_change: bool) -> PadGeometry | None:
        """Return what all answers say, None when they do not agree or say what is not to be believed."""
        first, *others = self._gathered
        self._gathered = []
        self.is_contradicted = not may_change and self.pad is not None and self.pad not in {first, *others}
        if any(other != first for other in others):
            self._refuse(f"{len(others) + 1} answers that differ: two answer on {self._key}")
            return None
        if self.is_contradicted:
            self._refuse(_CHANGED)
            return None
        self.pad, self.is_answered = first, True
        return first

    def _refuse(self, why: str) -> None:
        self.bad_answers += 1
        self.refused_why = why
