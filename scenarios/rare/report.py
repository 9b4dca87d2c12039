"""A splitting as a table for programs and as text for people."""

from collections.abc import Mapping, Sequence
from typing import Any, TextIO

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from scenarios.campaigns.intervals import Interval
from scenarios.rare.estimate import Verdict, estimate
from scenarios.rare.splitting import Particle, Population, Settings

_PLAIN_WIDTH = 1000  # nothing is wrapped where a program may read it
_ERRORS_SHOWN = 5
_WORST_SHOWN = 10

_COLUMNS = {
    "margin": ".3g",
    "probability": ".3g",
    "survivors": "d",
    "angle_rad": ".3g",
    "taken": ".0%",
    "moved": ".0%",
}


def report(subject: str, settings: Settings, population: Population) -> dict[str, Any]:
    """Return the result as a table of plain values, only what the seed decides.

    Args:
        subject: what was landed on.
        settings: of the splitting.
        population: that it ended with.
    """
    found = estimate(population)
    worst = sorted(population.unsafe, key=lambda particle: particle.margin)[:_WORST_SHOWN]
    return {
        "subject": subject,
        "particles": settings.particles,
        "moves": settings.moves,
        "level": settings.least,
        "seed": settings.seed,
        "converged": found.verdict is Verdict.CONVERGED,
        "verdict": found.verdict.name.lower(),
        "why": found.verdict.value,
        "probability": None if found.probability is None else _interval(found.probability),
        "landings": population.flown,
        "unsafe": found.unsafe,
        "ancestors": found.ancestors,
        "levels": [
            {
                "margin": level.margin,
                "probability": level.probability,
                "survivors": level.survivors,
                "angle_rad": level.angle_rad,
                "taken": level.taken,
                "moved": level.moved,
            }
            for level in population.levels
        ],
        "worst": [_noise(particle) for particle in worst],
        "errors": population.errors,
    }


def _interval(interval: Interval) -> dict[str, float]:
    return {"value": interval.value, "low": interval.low, "high": interval.high}


def _noise(particle: Particle) -> dict[str, Any]:
    """Return what flies an unsafe landing again."""
    moves = [[move.seed, move.angle_rad] for move in particle.noise.moves]
    return {"margin": particle.margin, "seed": particle.noise.seed, "moves": moves}


def print_report(table: Mapping[str, Any], out: TextIO) -> None:
    """Print a result: its levels, then the probability, or why there is none."""
    console = Console(file=out, highlight=False, width=None if out.isatty() else _PLAIN_WIDTH, no_color=True)
    _print_levels(console, table["levels"])
    found = f"{table['unsafe']} of {table['particles']} unsafe in the end, of {table['ancestors']} ancestors"
    console.print(f"{table['landings']} landings, {len(table['levels'])} levels, {found}")
    for error in table["errors"][:_ERRORS_SHOWN]:
        console.print(f"error: {error}", markup=False)
    probability = table["probability"]
    if probability is None:
        console.print(f"not converged, so there is no probability: {table['why']}")
        return
    value, low, high = (f"{probability[name]:.3g}" for name in ("value", "low", "high"))
    console.print(f"probability of an unsafe landing: {value} (95 % interval {low} to {high})")


def _print_levels(console: Console, levels: Sequence[Mapping[str, Any]]) -> None:
    if not levels:
        return
    table = Table("level", *_COLUMNS, box=SIMPLE_HEAD)
    for number, level in enumerate(levels, start=1):
        table.add_row(str(number), *(format(level[name], form) for name, form in _COLUMNS.items()))
    console.print(table)


def level_line(population: Population) -> str:
    """Return, while a splitting goes on, how far it is."""
    particles = population.particles
    known = f"{len(population.unsafe)} of {len(particles)} unsafe, {population.flown} landings"
    if not population.levels:
        return f"first landings: {known}"
    level = population.levels[-1]
    return f"level {len(population.levels)}, margin {level.margin:.3g}: probability {level.probability:.3g}, {known}"
