"""One thing that an attacker tries: what should come of it, and what came."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """What was tried.

    Attributes:
        by: which way.
        what: in words.
        expected: what should come of it.
        seen: what came of it.
    """

    by: str
    what: str
    expected: str
    seen: str

    @property
    def is_right(self) -> bool:
        """Whether it is what is expected."""
        return self.seen == self.expected
