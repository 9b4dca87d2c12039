"""Counts refused data of the vehicle by kind and reason, and says so in words."""

from dataclasses import dataclass

from link.program.text import printable

_RECENT_NS = 5_000_000_000
_AGAIN_NS = 10_000_000_000
_WORDS_MAX = 90  # of the reason of one refusal, which quotes what a peer sent


@dataclass(slots=True)
class _Kind:
    """One kind of refusal: how many, the words of the last one, when that came and when it was logged."""

    count: int
    words: str
    newest_ns: int
    told_count: int = 0
    told_ns: int | None = None

    def sentence(self, what: str) -> str:
        return f"{what}: {self.count} refused, {self.words}"


class Refusals:
    """Counts refused data. Times are of a clock that is never set.

    Attributes:
        total: of all of them.
    """

    def __init__(self) -> None:
        self.total = 0
        self._kinds: dict[tuple[str, str], _Kind] = {}

    def count(self, what: str, why: str, words: str, now_ns: int) -> None:
        """Count one.

        Args:
            what: came, such as `fix`.
            why: it is refused, the same for all refusals of its kind.
            words: for people, with this one's numbers.
            now_ns: monotonic.
        """
        self.total += 1
        kind = self._kinds.setdefault((what, why), _Kind(0, "", now_ns))
        kind.count, kind.words, kind.newest_ns = kind.count + 1, printable(words)[:_WORDS_MAX], now_ns

    def recent(self, now_ns: int) -> str:
        """Return what has been refused most in the last seconds, empty if nothing has."""
        found = [
            (kind.count, -len(what), kind.sentence(what))
            for (what, _), kind in self._kinds.items()
            if _is_recent(kind, now_ns)
        ]
        return max(found)[-1] if found else ""

    def news(self, now_ns: int) -> list[str]:
        """Return what is to be logged now: each kind at its first refusal, and again while its count rises."""
        lines: list[str] = []
        for (what, _), kind in self._kinds.items():
            is_due = kind.told_ns is None or now_ns - kind.told_ns >= _AGAIN_NS
            if is_due and kind.count > kind.told_count:
                kind.told_ns, kind.told_count = now_ns, kind.count
                lines.append(kind.sentence(what))
        return lines


def _is_recent(kind: _Kind, now_ns: int) -> bool:
    return now_ns - kind.newest_ns <= _RECENT_NS
