"""The command `bench`."""

import json
import sys
from typing import Annotated

import typer

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]


def register(app: typer.Typer) -> None:
    """Add `bench` to `app`."""
    app.command("bench")(bench_command)


def bench_command(
    name: Annotated[str, typer.Argument(metavar="NAME|FILE", help="Scenario to measure on.")] = "straight_5",
    *,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Of everything random [default: 1, or the world's own].")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Measure step times, speed, memory and start-up against their budgets; takes about a minute."""
    from scenarios.bench.bench import bench, text_lines
    from scenarios.catalogue.catalogue import load_scenario
    from scenarios.catalogue.world_names import run_seed

    table = bench(load_scenario(name), run_seed(name, seed), lambda what: _announce(what, as_json=as_json))
    text = json.dumps(table, indent=2) if as_json else "\n".join(text_lines(table))
    sys.stdout.write(f"{text}\n")


def _announce(what: str, *, as_json: bool) -> None:
    if not as_json:
        sys.stderr.write(f"measuring: {what}\n")
