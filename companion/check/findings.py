"""What a check finds: one line each, with what to do about it."""

from dataclasses import dataclass
from enum import Enum


class Level(Enum):
    """How grave a finding is."""

    PASS = "pass"  # noqa: S105 (no password)
    WARN = "warn"  # a landing is possible, with less margin or a worse outcome when something fails
    FAIL = "fail"  # a landing as asked for cannot succeed, or is not safe


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One line of the table.

    Attributes:
        name: what was looked at.
        level: how grave it is.
        found: what was found, with its unit.
        advice: what to do, empty for a pass.
        reason: why it matters.
        set_to: the parameter's advised value in the autopilot's own unit, None where none would help.
    """

    name: str
    level: Level
    found: str
    advice: str = ""
    reason: str = ""
    set_to: float | None = None


def passed(name: str, found: str) -> Finding:
    """Return a line that asks for nothing."""
    return Finding(name=name, level=Level.PASS, found=found)
