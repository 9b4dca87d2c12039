"""The command `bench`."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.errors import UserError
from link.program.cli import JsonOption, note
from scenarios.commands.options import SeedOption

_PAIRS = 15


def register(app: typer.Typer) -> None:
    """Add `bench` to `app`."""
    app.command("bench")(bench_command)


def bench_command(
    name: Annotated[str, typer.Argument(metavar="NAME|FILE", help="Scenario to measure on.")] = "straight_5",
    *,
    seed: SeedOption = None,
    against: Annotated[
        Path | None,
        typer.Option("--against", metavar="FOLDER", help="Only fly in turn with another checkout: which is faster?"),
    ] = None,
    pairs: Annotated[
        int | None, typer.Option("--pairs", help=f"Landings on each, with --against [default: {_PAIRS}].")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Measure step times, speed, memory and start-up against their budgets; takes about a minute."""
    from link.program.settings import refuse_variables
    from scenarios.catalogue.catalogue import load_scenario
    from scenarios.catalogue.world_names import run_seed

    refuse_variables()
    if against is None and pairs is not None:
        raise UserError(f"--pairs {pairs} counts landings on two checkouts: give --against FOLDER, or leave it out")
    if against is not None:
        _bench_against(against, name, _PAIRS if pairs is None else pairs, run_seed(name, seed), as_json=as_json)
        return
    from scenarios.bench.bench import bench, text_lines

    table = bench(load_scenario(name), run_seed(name, seed), lambda what: _announce(what, as_json=as_json))
    text = json.dumps(table, indent=2) if as_json else "\n".join(text_lines(table))
    sys.stdout.write(f"{text}\n")


def _bench_against(there: Path, name: str, pairs: int, first_seed: int, *, as_json: bool) -> None:
    from scenarios.bench.against import against_lines, against_table, check_pairs, fly_pairs
    from scenarios.catalogue.catalogue import load_scenario

    check_pairs(there, pairs)
    load_scenario(name)
    seeds = range(first_seed, first_seed + pairs)
    flown = fly_pairs(there, name, seeds, lambda what: _announce(what, as_json=as_json))
    table = against_table(there, name, flown)
    text = json.dumps(table, indent=2) if as_json else "\n".join(against_lines(table))
    sys.stdout.write(f"{text}\n")


def _announce(what: str, *, as_json: bool) -> None:
    if not as_json:
        note(f"measuring: {what}")
