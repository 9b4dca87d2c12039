"""What the programs share: an app with plain help, errors as one line on stderr, a word where a start takes long.

Kept light, so that `--help` is quick: no numerics and no Zenoh are imported here.
"""

import errno
import os
import sys
import threading
from collections.abc import Sequence
from importlib.metadata import version
from types import TracebackType
from typing import Annotated, Any, Self

import typer
from typer.main import get_command

from link.errors import UserError
from link.program.clock import collect_rarely
from link.program.exit_codes import EXIT_INTERRUPTED, EXIT_OK, EXIT_USER_ERROR
from link.program.help import NO_EXAMPLES, App, Examples, explain
from link.program.option_mistakes import describe, meant_command
from link.program.text import printable

_COMPLETION = "--install-completion"

SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change one setting, by its dotted key; over the file and the environment. May be repeated.",
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
FoxgloveOption = Annotated[
    int | None,
    typer.Option(
        "--foxglove",
        metavar="[PORT]",
        min=0,
        max=65535,
        help="Show everything live in Foxglove, at ws://127.0.0.1:PORT [default: 8765].",
        show_default=False,
    ),
]


def make_app(description: str, examples: Examples = NO_EXAMPLES) -> App:
    """Return an empty app whose help and errors are plain text.

    Args:
        description: heads its `--help`.
        examples: end the helps.
    """
    app = App(
        help=description,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.examples = examples
    return app


def command_of(app: App) -> Any:  # of a class that is private to typer
    """Return an app from `make_app` as a command, with the options that all programs have."""
    command = get_command(app)
    versioned = typer.Typer(add_completion=False)
    versioned.command()(_with_version)
    command.params[:0] = get_command(versioned).params
    explain(command, app.examples)
    return command


def _print_version(context: typer.Context, *, wanted: bool) -> None:
    if wanted:
        sys.stdout.write(f"{context.info_name} {version('decklander')}\n")
        raise typer.Exit


def _with_version(
    *,
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, expose_value=False, help="Print the version and end."
        ),
    ] = False,
) -> None:
    """Hold the option `--version`."""


def run_app(name: str, app: App, args: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit code.

    A mistake of the user is one line, `name: message`, on stderr.

    Args:
        name: the program's name.
        app: from `make_app`; its functions may return an exit code, or nothing for 0. Alone, one that only has
            commands prints its help.
        args: the arguments, `sys.argv[1:]` by default.

    Returns:
        0, the function's own code, 2 after a mistake of the user, 130 after Ctrl-C.
    """
    collect_rarely()
    command = command_of(app)
    arguments: list[str] = []
    try:
        arguments = _with_defaults(sys.argv[1:] if args is None else args)
        if not arguments and getattr(command, "commands", None) and not command.invoke_without_command:
            arguments = ["--help"]
        result = command.main(args=arguments, prog_name=name, standalone_mode=False)
        sys.stdout.flush()
    except UserError as error:
        return _fail(name, str(error))
    except typer.TyperException as error:
        context = getattr(error, "ctx", None)
        where = " ".join((name, *meant_command(command, arguments)[1])) if context is None else context.command_path
        return _fail(name, describe(error, command, arguments), hint=f"(see {where} -h)")
    except OSError as error:
        told = _told_of(error, arguments)
        if not told:
            raise
        _end_output()
        return _fail(name, told)
    except (KeyboardInterrupt, typer.Abort):
        return EXIT_INTERRUPTED
    return result if isinstance(result, int) else EXIT_OK


def _told_of(error: OSError, arguments: Sequence[str]) -> str:
    """Return what is said where no more can be written; empty for all that is no mistake of the user."""
    if error.errno == errno.ENOSPC:
        return "no space is left where it writes to: free some, or write elsewhere"
    if _COMPLETION in arguments:
        return f"{_COMPLETION}: {error.filename} cannot be written ({error.strerror}); set HOME to a folder that can"
    return ""


def _end_output() -> None:
    """Write what is left of the output; where that finds no space, either, the interpreter is not to try it again."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _with_defaults(args: Sequence[str]) -> list[str]:
    """Return the arguments with the numbers that some options may leave out: typer has no optional values."""
    given = list(args)
    defaults = {"--ros2": os.environ.get("ROS_DOMAIN_ID") or "0", "--foxglove": "8765"}
    for option, default in defaults.items():
        if option in given:
            after = given.index(option) + 1
            if not "".join(given[after : after + 1]).isdigit():
                given.insert(after, default)
    return given


def _fail(name: str, message: str, hint: str = "") -> int:
    line = printable(" ".join(f"{message} {hint}".split()))
    sys.stderr.write(f"{name}: {line}\n")
    return EXIT_USER_ERROR


def note(text: str) -> None:
    """Write a line that is no part of the result."""
    sys.stderr.write(f"{text}\n")


_AFTER_S = 3.0


class Patience:
    """Says on stderr what a program does, when a block takes longer than some seconds.

    Args:
        program: its name.
        doing: what it does.
        after_s: from the beginning of the block.
    """

    def __init__(self, program: str, doing: str, after_s: float = _AFTER_S) -> None:
        self._timer = threading.Timer(after_s, lambda: sys.stderr.write(f"{program}: {doing}\n"))
        self._timer.daemon = True

    def __enter__(self) -> Self:
        self._timer.start()
        return self

    def end(self) -> None:
        """Say nothing from now on."""
        self._timer.cancel()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()
