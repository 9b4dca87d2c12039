"""The reference of the commands: what each of them says of itself with `--help`."""

from collections.abc import Iterator, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

from link.program.cli import command_of
from scenarios.manual.markdown import block, page

PROGRAMS: Mapping[str, str] = MappingProxyType(
    {
        "companion": "companion.app",
        "pad-detector": "companion.eyes.app",
        "ground-vehicle": "scenarios.commands.ground_vehicle",
        "sim-autopilot": "sim_autopilot.app",
        "scenarios": "scenarios.app",
    }
)
"""The programs, and the modules that their command lines are in."""

WIDTH = 100
TEXT = (
    "Exit code 0 is success and 2 a mistake of the user, told in one line; with `--json` the output is one JSON object."
)


def commands_page() -> str:
    """Return the page of all commands."""
    sections = (f"{'#' * min(name.count(' ') + 2, 3)} {name}\n\n{block(text)}" for name, text in helps())
    return page("Commands", TEXT, *sections)


def helps() -> Iterator[tuple[str, str]]:
    """Yield each command's name and help, a program before its commands."""
    for program, module in PROGRAMS.items():
        yield from _helps(command_of(import_module(module).app), program, None)


def _helps(command: Any, name: str, parent: Any) -> Iterator[tuple[str, str]]:
    word = name.rsplit(" ", 1)[-1]
    context = command.context_class(
        command, info_name=word, parent=parent, terminal_width=WIDTH, max_content_width=WIDTH
    )
    yield name, command.get_help(context)
    for below, part in getattr(command, "commands", {}).items():
        yield from _helps(part, f"{name} {below}", context)
