"""The command `attack`."""

import json
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.program.cli import JsonOption
from link.zenoh.command_line import NameArguments, ZenohArguments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from scenarios.attack.attempt import Attempt

_WIDTHS = {"by": 26, "what": 70, "seen": 50}


def register(app: typer.Typer) -> None:
    """Add `attack` to `app`."""
    app.command("attack")(attack_command)


def attack_command(
    *,
    mavlink: Annotated[
        str | None,
        typer.Option("--mavlink", metavar="DEVICE", help="Of a companion that runs: where it listens, as a udpout."),
    ] = None,
    stranger: Annotated[
        str | None,
        typer.Option("--stranger", metavar="ENDPOINT", help="Where somebody without a certificate tries to get in."),
    ] = None,
    as_json: JsonOption = False,
    names: NameArguments,
    endpoints: ZenohArguments,
) -> int:
    """Try what attackers try, on a companion on the bench if one is given; exit code 1 when an attempt works.

    Without --mavlink, --stranger, -e and --zenoh-config it tries only what needs no companion.
    """
    is_live = bool(mavlink or stranger or endpoints.connect or endpoints.zenoh_config)
    tried = _live(mavlink, stranger, names, endpoints) if is_live else _inside()
    rows: list[dict[str, Any]] = []
    for one in tried:
        row = {"by": one.by, "what": one.what, "expected": one.expected, "seen": one.seen, "right": one.is_right}
        rows.append(row)
        if not as_json:
            sys.stdout.write(_line(row))
            sys.stdout.flush()
    right = sum(row["right"] for row in rows)
    sys.stdout.write(json.dumps({"attempts": rows}, indent=2) if as_json else f"{right} of {len(rows)} are right")
    sys.stdout.write("\n")
    return 0 if right == len(rows) else 1


def _live(
    mavlink: str | None, stranger: str | None, names: NameArguments, endpoints: ZenohArguments
) -> "Iterator[Attempt]":
    from scenarios.attack import live

    return live.attempts(endpoints.options(), names.keys(), device=mavlink, stranger=stranger)


def _inside() -> "Iterator[Attempt]":
    from link.program.settings import refuse_variables
    from scenarios.attack import crafted, spoofs

    refuse_variables()
    yield from spoofs.attempts()
    yield from crafted.attempts()


def _line(row: dict[str, Any]) -> str:
    told = "".join(f"{row[name]:{width}}" for name, width in _WIDTHS.items())
    return f"{told}{'right' if row['right'] else 'WRONG: ' + row['expected'] + ' was expected'}\n"
