"""docs/reasons.md, from the companion's own table of reasons; `python -m scenarios.manual.reasons` rewrites it."""

import re
from itertools import groupby
from pathlib import Path

from companion.config.companion import CompanionConfig
from companion.core.reason_help import ReasonHelp, reason_helps
from scenarios.manual.markdown import code, page, table

PATH = Path(__file__).parents[2] / "docs" / "reasons.md"
TEXT = """The companion tells why it does what it does: in the panel, in the log, to the ground station and in
`landing/status` (`reason` is the sentence, `reason_code` the name below). `companion reasons NAME` prints one of them
at the terminal. Figures are those of the default configuration.

**When a landing is waved off**: let the drone climb and try again by itself. If it hovers, read the last reasons in
the log, change what they name, and command `start`. Two aborts of one kind end the day's flying.
[Safety](safety.md) has the pilot's procedure."""
_PLACE = re.compile(r"\{[^}]*\}")


def reasons_page() -> str:
    """Return the page, as it stands in docs/reasons.md."""
    parts = [TEXT]
    for (group, note), helps in groupby(reason_helps(CompanionConfig()), lambda one: (one.group, one.note)):
        parts += [f"## {group}", *([note] if note else [])]
        parts += [table(("told", "it means", "look at, or do"), map(_row, helps))]
    return page("Reasons, and what to do", *parts)


def _row(one: ReasonHelp) -> tuple[str, str, str]:
    return f"{_PLACE.sub('...', one.reason.value)} {code(one.reason.name)}", one.meaning, one.remedy


if __name__ == "__main__":
    PATH.write_text(reasons_page(), encoding="utf-8")
