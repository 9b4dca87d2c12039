"""What each reason means and what to do about it, from `reasons.toml` beside this file."""

import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.resources import files

from companion.core.reasons import Reason

_FILE = "reasons.toml"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReasonHelp:
    """One reason as a pilot reads it.

    Attributes:
        reason: which.
        group: what it does to the landing; reasons of one group follow each other.
        note: what holds for its whole group.
        meaning: one or two sentences, with the configuration's values.
        remedy: what to look at or to do; empty where there is nothing to do.
    """

    reason: Reason
    group: str
    note: str
    meaning: str
    remedy: str


def reason_helps(values: Iterable[tuple[str, object]]) -> Iterator[ReasonHelp]:
    """Yield the help of every reason, group by group.

    Args:
        values: the names and values that the texts tell, such as those of a `CompanionConfig`.

    Raises:
        ValueError: the file has a name that no reason has, or lacks one.
    """
    groups = tomllib.loads(files(__package__).joinpath(_FILE).read_text(encoding="utf-8"))
    missing = {one.name for one in Reason}.difference(*groups.values())
    if missing:
        raise ValueError(f"{_FILE} lacks {', '.join(sorted(missing))}")
    named = dict(values)
    for group, texts in groups.items():
        note = texts.pop("note", "").format(**named)
        for name, (meaning, remedy) in texts.items():
            if name not in Reason.__members__:
                raise ValueError(f"{_FILE} explains {name}, which is no reason")
            yield ReasonHelp(
                reason=Reason[name],
                group=group,
                note=note,
                meaning=meaning.format(**named),
                remedy=remedy.format(**named),
            )
