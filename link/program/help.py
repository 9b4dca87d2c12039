"""What every help says beside its options: examples, and what kind of value an option takes."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeVar

import typer

from link.program.option_groups import ungrouped

Examples = Mapping[str, Sequence[str]]
"""Command lines, by the command below the program, such as `check`; the program's own by the empty name."""

Command = TypeVar("Command", bound=Callable[..., Any])

NO_EXAMPLES: Examples = MappingProxyType({})

_KINDS = {"float": "NUMBER", "int": "N"}
"""How a kind of value is written, by typer's name of it."""


class App(typer.Typer):
    """A program's commands.

    Attributes:
        examples: end the helps of its commands.
    """

    examples: Examples = NO_EXAMPLES

    def command(self, name: str | None = None, **kwargs: Any) -> Callable[[Command], Command]:
        """Take a command, whose arguments may be groups of options."""
        return _ungrouping(super().command(name, **kwargs))

    def callback(self, **kwargs: Any) -> Callable[[Command], Command]:
        """Take what is done without a command, whose arguments may be groups of options."""
        return _ungrouping(super().callback(**kwargs))


def _ungrouping(register: Callable[[Any], Any]) -> Callable[[Command], Command]:
    def take(function: Command) -> Command:
        register(ungrouped(function))
        return function

    return take


def explain(command: Any, examples: Examples, below: str = "") -> None:  # of a class that is private to typer
    """Complete the helps of a command and of all below it.

    Args:
        command: of a program.
        examples: by command.
        below: the program, this command is called so; empty for the program itself.
    """
    lines = examples.get(below, ())
    if lines:
        command.epilog = "\n".join(("\b", "Examples:", *(f"  {line}" for line in lines)))
    for parameter in command.params:
        if parameter.metavar is None:
            parameter.metavar = _kind(parameter.type_descriptor)
    for name, part in getattr(command, "commands", {}).items():
        explain(part, examples, f"{below} {name}".strip())


def _kind(described: Any) -> str | None:
    """Return what is written for a value, None where typer's own word does."""
    if described.is_path:
        return "PATH"
    return _KINDS.get(described.ranged_type_name) if described.is_ranged else None
