"""STATUSTEXT for pilots: complete texts, with a severity, at a rate that can be read."""

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.mavlink.dialect import Message, mavlink
from link.messages import LandingStatus

_TEXT_SIZE = 50  # of a STATUSTEXT; longer ones are sent in pieces of one id
_IDS = 0xFFFF
_LASTS_NS = 1_000_000_000  # what holds a landing up for less is not told
_APART_NS = 5_000_000_000
_WARNED_OF = frozenset({Phase.ABORT, Phase.HOLD, Phase.PILOT, Phase.RALLY})
_TOLD_IN = frozenset({Phase.CHASE.value, Phase.ALIGN.value, Phase.DESCEND.value})
_PLAIN = frozenset({Reason.OVER_PAD.name, Reason.ALIGNED.name})


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
