"""What is wrong in a command line, in one line: the option, the value that was given, and what is allowed.

typer tells it in the words of the library that checks values for it. A value that is checked so is its mistake's cause.
"""

import sys
from collections.abc import Sequence
from typing import Any, get_args

import typer

from link.errors import own_words

_NUMBERS = (int, float)


def describe(error: typer.TyperException, command: Any, arguments: Sequence[str]) -> str:
    """Return the mistake in one sentence.

    Args:
        error: typer's.
        command: of the program, of a class that is private to typer.
        arguments: that the user gave.
    """
    return (
        _wrong_number(error)
        or _wrong_count(error, meant_command(command, arguments)[0], arguments)
        or _with_commands(error, own_words(error.format_message()))
    )


def meant_command(command: Any, arguments: Sequence[str]) -> tuple[Any, list[str]]:
    """Return the command that was meant, and its words below the program: some mistakes do not tell."""
    words: list[str] = []
    for word in arguments:
        below = getattr(command, "commands", {}).get(word)
        if below is None:
            break
        command = below
        words.append(word)
    return command, words


def _wrong_number(error: typer.TyperException) -> str:
    """Return what is said of a value that is no number, or not one in its range; empty for other mistakes."""
    parameter, pydantic = getattr(error, "param", None), sys.modules.get("pydantic")
    if parameter is None or pydantic is None or not isinstance(error.__cause__, pydantic.ValidationError):
        return ""
    value, allowed = error.__cause__.errors()[0]["input"], _allowed(parameter)
    return f"{_name(parameter)} {value}: must be {allowed}" if allowed else ""


def _allowed(parameter: Any) -> str:
    """Return the numbers that an option takes in words; empty if it takes none."""
    described = parameter.type_descriptor
    if parameter.nargs > 1 and set(get_args(described.annotation)) <= {*_NUMBERS}:
        return f"{parameter.nargs} numbers, {parameter.metavar}"
    each = get_args(described.annotation)[0] if parameter.multiple else described.annotation
    if each not in _NUMBERS:
        return ""
    kind = "a whole number" if each is int else "a number"
    low, high = described.parameter_info.min, described.parameter_info.max
    if low is None and high is None:
        return kind
    if high is None:
        return f"{kind}, {low:.15g} or more"
    return f"{kind}, {high:.15g} or less" if low is None else f"{kind} from {low:.15g} to {high:.15g}"


def _name(parameter: Any) -> str:
    """Return an option as it is written, the longest way; an argument as the help has it."""
    return max(parameter.opts, key=len) if parameter.param_type_name == "option" else str(parameter.make_metavar(None))


def _wrong_count(error: typer.TyperException, command: Any, arguments: Sequence[str]) -> str:
    """Return what is said of an option of several numbers that has fewer or one more; empty for other mistakes."""
    if getattr(error, "param", None) is not None:
        return ""
    for parameter in command.params:
        for option in {*parameter.opts} & {*arguments} if parameter.nargs > 1 else ():
            given = arguments[arguments.index(option) + 1 :]
            takes = f"{option}: takes {parameter.nargs} values, {parameter.metavar}; "
            if len(given) < parameter.nargs:
                return f"{takes}{' '.join(given) or 'none'} is too few"
            if _is_number("".join(given[parameter.nargs :][:1])):
                return f"{takes}{given[parameter.nargs]} is one too many"
    return ""


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _with_commands(error: typer.TyperException, told: str) -> str:
    """Return the message; of a command that there is not, with all that there are, if none is near."""
    commands = getattr(getattr(getattr(error, "ctx", None), "command", None), "commands", {})
    if not told.startswith("No such command") or "Did you mean" in told or not commands:
        return told
    return f"{told} There are {', '.join(commands)}."
