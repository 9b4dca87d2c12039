"""The command `rare`: the probability of an unsafe outcome by adaptive multilevel splitting."""

import json
import sys
from typing import Annotated

import typer

from link.program.cli import JsonOption, note
from link.program.extras import require
from scenarios.commands.options import LANDINGS_MAX, WorkersOption

_PARTICLES, _STEPS, _LEVEL = 200, 4, 1e-6


def register(app: typer.Typer) -> None:
    """Add `rare` to `app`."""
    app.command("rare")(rare_command)


def rare_command(
    name: Annotated[
        str,
        typer.Argument(
            metavar="world[:SLICE]|CELL",
            help="The operational design domain, a slice of it, or a scenario, such as brake_10+link=degraded.",
        ),
    ],
    *,
    level: Annotated[
        float, typer.Option("--level", min=1e-12, max=0.1, help="No level goes below this probability.")
    ] = _LEVEL,
    particles: Annotated[
        int, typer.Option("--particles", min=20, max=LANDINGS_MAX, metavar="N", help="Landings of the population.")
    ] = _PARTICLES,
    steps: Annotated[
        int,
        typer.Option("--steps", min=2, metavar="N", help="Landings that each copy tries in order to be another one."),
    ] = _STEPS,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of everything random.")] = 1,
    workers: WorkersOption = None,
    firmware: Annotated[str | None, typer.Option("--firmware", metavar="px4|ardupilot", help="Of a cell.")] = None,
    as_json: JsonOption = False,
) -> int:
    """Estimate the probability of an unsafe outcome; exit code 1 when the splitting has not converged."""
    require("campaign", "scenarios rare")
    from link.program.settings import refuse_variables
    from scenarios.processes.local_workers import core_count
    from scenarios.rare.landing import flying, subject_of
    from scenarios.rare.report import level_line, print_report, report
    from scenarios.rare.splitting import Settings, split

    refuse_variables()
    subject = subject_of(name, firmware)
    settings = Settings(particles=particles, steps=steps, in_time=True, least=level, seed=seed)
    try:
        with flying(subject, core_count() if workers is None else workers) as fly:
            population = split(settings, fly, lambda population: note(level_line(population)))
    except KeyboardInterrupt:
        note("broken off: a splitting that is not over tells no probability, and nothing of it is kept")
        raise
    table = report(subject.name, settings, population)
    if as_json:
        sys.stdout.write(json.dumps(table, indent=2, allow_nan=False) + "\n")
    else:
        print_report(table, sys.stdout)
    return 0 if table["converged"] else 1
