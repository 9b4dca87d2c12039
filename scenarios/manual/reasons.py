"""The page of reasons, from the companion's own table of them."""

import re
from itertools import groupby

from companion.config.companion import CompanionConfig
from companion.core.reason_help import ReasonHelp, reason_helps
from scenarios.manual.markdown import code, page, table

TEXT = """The panel, the log, the ground station and `landing/status` (`reason_code`) tell these reasons.
`companion reasons NAME` prints one at the terminal, and all of them without a name. Left out here are those that ask
for nothing, and those whose message itself says what to do. Figures are those of the default configuration.

**When a landing is waved off**, let the drone climb and try again by itself. If it hovers, read the last reasons in
the log, change what they name, and command `start`. [Safety](safety.md) has the pilot's procedure."""
_SENTENCE_MAX = 70  # longer ones end with what to do
_PLACE = re.compile(r"\{[^}]*\}")


def reasons_page() -> str:
    """Return the page, a table a group of reasons."""
    parts = [TEXT]
    wanting = (one for one in reason_helps(CompanionConfig()) if one.remedy and len(one.reason.value) <= _SENTENCE_MAX)
    for (group, note), helps in groupby(wanting, lambda one: (one.group, one.note)):
        parts += [f"## {group}", *([note] if note else [])]
        parts += [table(("told", "why", "look at, or do"), map(_row, helps))]
    return page("Reasons, and what to do", *parts)


def _row(one: ReasonHelp) -> tuple[str, str, str]:
    return f"{_PLACE.sub('...', one.reason.value)} {code(one.reason.name)}", one.meaning, one.remedy
