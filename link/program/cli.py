"""What the commands share: common options, and errors as one line on stderr with exit code 2.

Kept light, so that `--help` is quick: no numerics and no Zenoh are imported here.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from typer.main import get_command

from link.errors import UserError
from link.program.printable import printable

EXIT_OK = 0
EXIT_USER_ERROR = 2
EXIT_INTERRUPTED = 130

_PANEL = "Zenoh"

NamespaceOption = Annotated[str, typer.Option("--ns", metavar="NAME", help="Namespace of all Zenoh keys.")]
VehicleOption = Annotated[str, typer.Option("--vehicle", metavar="ID", help="Name of the ground vehicle.")]
DroneOption = Annotated[str, typer.Option("--drone", metavar="ID", help="Name of the drone.")]

ModeOption = Annotated[
    str | None,
    typer.Option(
        "-m", "--mode", metavar="MODE", help="peer, client or router [default: peer].", rich_help_panel=_PANEL
    ),
]
ConnectOption = Annotated[
    list[str] | None,
    typer.Option(
        "-e",
        "--connect",
        metavar="ENDPOINT",
        help="Endpoint to connect to, such as tls/192.168.1.5:7447. May be repeated.",
        rich_help_panel=_PANEL,
    ),
]
ListenOption = Annotated[
    list[str] | None,
    typer.Option(
        "-l",
        "--listen",
        metavar="ENDPOINT",
        help="Endpoint to listen on, such as tls/0.0.0.0:7447. May be repeated.",
        rich_help_panel=_PANEL,
    ),
]
MulticastOption = Annotated[
    bool | None,
    typer.Option(
        "--multicast-scouting/--no-multicast-scouting",
        help="Look for others by multicast, or not [default: not].",
        show_default=False,
        rich_help_panel=_PANEL,
    ),
]
ZenohConfigOption = Annotated[
    Path | None,
    typer.Option(
        "--zenoh-config",
        metavar="FILE",
        help="Zenoh configuration (JSON5), for TLS and access control.",
        rich_help_panel=_PANEL,
    ),
]
InsecureOption = Annotated[
    bool,
    typer.Option(
        "--insecure",
        help="Meet others beyond this machine without certificates: anybody on that network can give orders.",
        rich_help_panel=_PANEL,
    ),
]


def make_app(description: str) -> typer.Typer:
    """Return an empty app whose help and errors are plain text; `description` heads its `--help`."""
    return typer.Typer(help=description, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


def run_app(name: str, app: typer.Typer, args: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit code.

    A mistake of the user is one line, `name: message`, on stderr.

    Args:
        name: the program's name.
        app: from `make_app`; its functions may return an exit code, or nothing for 0.
        args: the arguments, `sys.argv[1:]` by default.

    Returns:
        0, the function's own code, 2 after a mistake of the user, 130 after Ctrl-C.
    """
    command = get_command(app)
    try:
        result = command.main(args=list(sys.argv[1:] if args is None else args), prog_name=name, standalone_mode=False)
    except UserError as error:
        return _fail(name, str(error))
    except typer.TyperException as error:
        return _fail(name, error.format_message(), hint=f"(see {name} --help)")
    except (KeyboardInterrupt, typer.Abort):
        return EXIT_INTERRUPTED
    return result if isinstance(result, int) else EXIT_OK


def _fail(name: str, message: str, hint: str = "") -> int:
    line = printable(" ".join(f"{message} {hint}".split()))
    sys.stderr.write(f"{name}: {line}\n")
    return EXIT_USER_ERROR
