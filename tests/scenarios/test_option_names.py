"""One spelling for one thing, over all programs' own tables of options."""

from collections import defaultdict
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import pytest

from link.program.cli import command_of
from scenarios.manual.commands import PROGRAMS

KINDS = {
    "--out": {"DIR", "FILE"},  # what a command writes is a folder or one file
    "--firmware": {"px4|ardupilot", "px4|ardupilot|both"},  # a campaign flies both
}
"""Options that take several kinds of values, which they have a reason for."""

SAME = (
    ("--autopilot", "--firmware"),
    ("--seconds", "--duration"),
    ("--count", "--seeds"),
    ("--output", "--out"),
    ("--namespace", "--ns"),
    ("--format", "--json"),
    ("--device", "--mavlink"),
    ("--zenoh", "--zenoh-config"),
    ("--record/--no-record", "--no-record"),
)
"""Other words, and the one that is used."""

PRINT_NO_RESULT = {
    "companion", "companion keys", "pad-detector run", "pad-detector print", "ground-vehicle", "sim-autopilot",
    "scenarios world", "scenarios figures", "scenarios report", "scenarios view", "scenarios camera",
}  # fmt: skip
"""They run until they are ended, or write files."""


def commands(command: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield a command and all below it, by their names."""
    yield name, command
    for below, part in getattr(command, "commands", {}).items():
        yield from commands(part, f"{name} {below}")


ALL = [
    pair for program, module in PROGRAMS.items() for pair in commands(command_of(import_module(module).app), program)
]


def options(command: Any) -> Iterator[Any]:
    """Yield the options of a command."""
    return (one for one in command.params if any(word.startswith("-") for word in (*one.opts, *one.secondary_opts)))


def kind_of(option: Any) -> str:
    """Return what is written behind an option, empty for a flag."""
    return "" if option.is_flag else str(option.metavar or option.type_descriptor.ranged_type_name)


def test_an_option_takes_the_same_kind_of_value_wherever_it_is() -> None:
    found: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for name, command in ALL:
        for option in options(command):
            for word in (*option.opts, *option.secondary_opts):
                found[word][kind_of(option)].append(name)
    differing = {
        word: dict(kinds) for word, kinds in found.items() if not set(kinds) <= KINDS.get(word, {next(iter(kinds))})
    }
    assert not differing


@pytest.mark.parametrize(("other", "used"), SAME)
def test_one_thing_has_one_word(other: str, used: str) -> None:
    words = {word for _, command in ALL for one in options(command) for word in (*one.opts, *one.secondary_opts)}
    assert other not in words
    assert used in words


def test_every_program_has_version_help_and_completion() -> None:
    for program in PROGRAMS:
        command = dict(ALL)[program]
        words = {word for one in options(command) for word in one.opts}
        assert {"--version", "--install-completion"} <= words, program
        assert {"-h", "--help"} <= set(command.context_settings["help_option_names"]), program


def test_every_command_that_prints_a_result_prints_it_as_json_too() -> None:
    for name, command in ALL:
        words = {word for one in options(command) for word in one.opts}
        groups_only = bool(getattr(command, "commands", None)) and not command.invoke_without_command
        assert ("--json" in words) == (name not in PRINT_NO_RESULT and not groups_only), name
