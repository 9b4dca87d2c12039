"""What a check finds: one line each, with what to do about it; and the file that keeps the parameters from before."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from link.errors import UserError
from link.program.text import read_bounded
from link.program.whole_file import replace_file


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


def is_ready(findings: Sequence[Finding]) -> bool:
    """Return whether nothing failed."""
    return all(finding.level is not Level.FAIL for finding in findings)


def pass_line(name: str, found: str) -> Finding:
    """Return a line that asks for nothing."""
    return Finding(name=name, level=Level.PASS, found=found)


def pass_or(is_true: bool, otherwise: Level) -> Level:
    """Return a pass where something holds, `otherwise` where it does not."""
    return Level.PASS if is_true else otherwise


def make_finding(name: str, found: str, level: Level, advice: str, reason: str = "") -> Finding:
    """Return a line that asks for something only if it is no pass."""
    if level is Level.PASS:
        return pass_line(name, found)
    return Finding(name=name, level=level, found=found, advice=advice, reason=reason)


def advised_values(findings: Sequence[Finding]) -> dict[str, float]:
    """Return the parameters that have an advised value, by name."""
    return {one.name: one.set_to for one in findings if one.set_to is not None}


def keep(path: Path, before: Mapping[str, float]) -> None:
    """Write the values before a change; those that the file has from an earlier change are older and stay.

    Raises:
        UserError: the file cannot be written, or is another's.
    """
    earlier = read_kept(path) if path.exists() else {}
    try:
        replace_file(path, json.dumps({**before, **earlier}, indent=2).encode() + b"\n")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --keep FILE") from error


def read_kept(path: Path) -> dict[str, float]:
    """Return the parameters of a file that `keep` wrote.

    Raises:
        UserError: the file cannot be read, or holds something else.
    """
    try:
        values = json.loads(read_bounded(path))
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}); name the file that --write kept") from error
    except (ValueError, RecursionError) as error:
        raise UserError(f"{path}: is no file of parameters: {error}") from error
    is_numbers = isinstance(values, dict) and all(
        isinstance(value, int | float) and math.isfinite(value) for value in values.values()
    )
    if not is_numbers:
        raise UserError(f"{path}: is no file of parameters: it has to be one object of names and numbers")
    return {str(name): float(value) for name, value in values.items()}
