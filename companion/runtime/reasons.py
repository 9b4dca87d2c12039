"""`companion reasons`: what the companion means by a reason, and what to do about it."""

import difflib
import json
import re
import sys
import textwrap
from collections.abc import Mapping, Sequence
from typing import Annotated

import typer

from companion.config.companion import CompanionConfig
from companion.core.reason_help import ReasonHelp, reason_helps
from link.errors import UserError
from link.program.cli import JsonOption

_WIDTH = 78
_PLACE = re.compile(r"\{[^}]*\}")
_NUMBER = re.compile(r"-?\d+(\.\d+)?")

_NamesArgument = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="[NAME|WORDS]...",
        help="Such as OFFSET_UNKNOWN, or the words that the panel or the log shows; all reasons if none is given.",
    ),
]


def reasons(
    names: _NamesArgument = None,
    *,
    as_json: JsonOption = False,
) -> None:
    """Explain the reasons that the panel, the log and `landing/status` tell."""
    helps = {one.reason.name: one for one in reason_helps(CompanionConfig())}
    wanted = _named(names, helps) if names else list(helps)
    if as_json:
        told_of = [{"name": name, "sentence": helps[name].reason.value} | _words(helps[name]) for name in wanted]
        sys.stdout.write(json.dumps({"reasons": told_of}, indent=2) + "\n")
        return
    for name in wanted:
        one = helps[name]
        sys.stdout.write(f"{name}: {_PLACE.sub('...', one.reason.value)}\n")
        for text in (f"({one.group}) {one.meaning}", *([f"Look at, or do: {one.remedy}"] if one.remedy else [])):
            sys.stdout.write(textwrap.indent(textwrap.fill(text, _WIDTH), "  ") + "\n")


def _named(names: Sequence[str], helps: Mapping[str, ReasonHelp]) -> list[str]:
    """Return the reasons of these names, or those whose sentence has these words.

    Raises:
        UserError: there is none.
    """
    upper = [name.upper() for name in names]
    unknown = [name for name in upper if name not in helps]
    if not unknown:
        return upper
    shown = " ".join(names).casefold()
    found = [name for name, one in helps.items() if _tells(one.reason.value.casefold(), shown)]
    if found:
        return found
    near = difflib.get_close_matches(unknown[0], helps, cutoff=0.5)
    told = f"did you mean {', '.join(near)}?" if near else "`companion reasons` lists them all"
    raise UserError(f"no reason has the name or the words {' '.join(names)!r}; {told}")


def _tells(sentence: str, shown: str) -> bool:
    """Return whether a sentence with places for its values has the words, or is among what is shown."""
    whole = ".+".join(re.escape(part) for part in _PLACE.split(sentence))
    counted, told = _NUMBER.sub("#", _PLACE.sub("#", sentence)), _NUMBER.sub("#", shown)
    return told in counted or re.search(whole, shown) is not None


def _words(help_: ReasonHelp) -> dict[str, str]:
    return {"group": help_.group, "meaning": help_.meaning, "remedy": help_.remedy}
