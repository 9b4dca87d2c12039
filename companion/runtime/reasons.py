"""`companion reasons`: what the companion means by a reason, and what to do about it."""

import difflib
import json
import re
import sys
import textwrap
from typing import Annotated

import typer

from companion.config.companion import CompanionConfig
from companion.core.reason_help import ReasonHelp, reason_helps
from link.errors import UserError
from link.program.cli import JsonOption

_WIDTH = 78
_PLACE = re.compile(r"\{[^}]*\}")

_NamesArgument = Annotated[
    list[str] | None, typer.Argument(metavar="[NAME]...", help="Such as OFFSET_UNKNOWN; all of them if none is given.")
]


def reasons(
    names: _NamesArgument = None,
    *,
    as_json: JsonOption = False,
) -> None:
    """Explain the reasons that the panel, the log and `landing/status` tell."""
    helps = {one.reason.name: one for one in reason_helps(CompanionConfig())}
    wanted = [name.upper() for name in names or helps]
    unknown = [name for name in wanted if name not in helps]
    if unknown:
        near = difflib.get_close_matches(unknown[0], helps, cutoff=0.5)
        told = f"; did you mean {', '.join(near)}?" if near else "; `companion reasons` lists them all"
        raise UserError(f"no reason is called {unknown[0]}{told}")
    if as_json:
        told_of = [{"name": name, "sentence": helps[name].reason.value} | _words(helps[name]) for name in wanted]
        sys.stdout.write(json.dumps({"reasons": told_of}, indent=2) + "\n")
        return
    for name in wanted:
        one = helps[name]
        sys.stdout.write(f"{name}: {_PLACE.sub('...', one.reason.value)}\n")
        for text in (f"({one.group}) {one.meaning}", one.remedy):
            sys.stdout.write(textwrap.indent(textwrap.fill(text, _WIDTH), "  ") + ("\n" if text else ""))


def _words(help_: ReasonHelp) -> dict[str, str]:
    return {"group": help_.group, "meaning": help_.meaning, "remedy": help_.remedy}
