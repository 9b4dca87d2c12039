"""The report's tables: its outcomes and its step responses, published against measured."""

import statistics
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import closing
from typing import Any, TextIO

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import track
from rich.table import Table

from link.errors import UserError
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import firmware_text
from scenarios.processes.local_workers import LocalWorkers, core_count
from scenarios.processes.pool import run_tasks
from scenarios.source_report.cases import CASES, OVERSHOOT, SETTLING_S, PublishedCase
from scenarios.source_report.flight import ReportTask, fly_row
from scenarios.source_report.step_responses import step_rows

Row = dict[str, Any]
SYSTEMS = ("report", "report_unboosted", "default")
_PLAIN_WIDTH = 1000  # nothing is wrapped where a program may read it


def fly_report(seeds: int, workers: int | None) -> dict[str, Any]:
    """Fly every case with every system and the seeds 1 to `seeds`, and return the tables.

    Args:
        seeds: of each case.
        workers: number of processes, None for one a core.

    Raises:
        UserError: a task ends its process time and again.
    """
    tasks = [
        ReportTask(scenario=case.scenario, system=system, seed=seed)
        for seed in range(1, seeds + 1)
        for case in CASES
        for system in SYSTEMS
    ]
    console = Console(stderr=True)
    with closing(run_tasks(LocalWorkers(fly_row, workers or core_count()), tasks, lost=_refuse_lost)) as rows:
        flown = track(
            rows, "flights", total=len(tasks), console=console, transient=True, disable=not console.is_terminal
        )
        return report_table(list(flown))


def _refuse_lost(task: ReportTask, why: str) -> Row:
    raise UserError(f"{task.scenario} with {task.system}, seed {task.seed}: {why}")


def report_table(rows: Sequence[Row]) -> dict[str, Any]:
    """Return both tables: of the landings in `rows`, and of the step responses."""
    cells = [
        _cell(case, system, chosen)
        for case in CASES
        for system in SYSTEMS
        if (chosen := [row for row in rows if (row["scenario"], row["system"]) == (case.scenario, system)])
    ]
    return {"landings": cells, "step_responses": [row | _published_step(row) for row in step_rows()]}


def _published_step(row: Mapping[str, Any]) -> dict[str, float | None]:
    """Return the published settling time of a row's axis, where the row is of the report's regulator."""
    return {"published_settling_s": SETTLING_S[row["axis"]] if row["loop"].startswith("lqr,") else None}


def _cell(case: PublishedCase, system: str, rows: Sequence[Row]) -> dict[str, Any]:
    landing = case.landing
    scores = [row["score"] for row in rows if row["score"] is not None]
    return {
        "scenario": case.scenario,
        "firmware": load_scenario(case.scenario).firmware,
        "system": system,
        "seeds": len(rows),
        "published": {"outcome": case.outcome} | ({} if landing is None else landing.model_dump()),
        "road_end_s": rows[0]["road_end_s"],
        "noisy": _landings([row["noisy"] for row in rows]),
        "truth": _landings([row["truth"] for row in rows]),
        "closest_m": _spread([row["closest_m"] for row in rows if row["closest_m"] is not None]),
        "tiers": dict(sorted(Counter(score["tier"] for score in scores).items())) if scores else None,
    }


def _landings(places: Sequence[Mapping[str, float] | None]) -> dict[str, Any]:
    """Return how many landed, and when and where."""
    landed = [place for place in places if place is not None]
    return {"landed": len(landed)} | {
        name: _spread([place[name] for place in landed]) for name in ("t_s", "x_m", "y_m")
    }


def _spread(values: Sequence[float]) -> dict[str, float] | None:
    if not values:
        return None
    return {"median": statistics.median(values), "min": min(values), "max": max(values)}


_LANDING_HEADINGS = ("scenario", "published", "system", "by the noisy test", "at s", "x m", "y m", "on truth", "at s",
                     "closest m", "tiers")  # fmt: skip
_STEP_HEADINGS = ("loop", "airframe", "axis", "published s", "settling s", "overshoot %")


def print_report(table: Mapping[str, Any], out: TextIO) -> None:
    """Print both tables: framed on a terminal, plain columns elsewhere."""
    framed = out.isatty()
    console = Console(file=out, highlight=False, width=None if framed else _PLAIN_WIDTH, no_color=not framed)
    flown = firmware_text([cell["firmware"] for cell in table["landings"]])
    title = f"Landings within 0.7 m before the road ends, {flown}: median (smallest to largest) over the seeds"
    _print(console, title, _LANDING_HEADINGS, [_landing_cells(cell) for cell in table["landings"]])
    title = f"Unit steps: settling time to 2 % and overshoot (published overshoot: {OVERSHOOT})"
    _print(console, title, _STEP_HEADINGS, [_step_cells(row) for row in table["step_responses"]])


def write_markdown(table: Mapping[str, Any], out: TextIO) -> None:
    """Write both tables as Markdown has them, one after the other."""
    parts = (
        (_LANDING_HEADINGS, [_landing_cells(cell) for cell in table["landings"]]),
        (_STEP_HEADINGS, [_step_cells(row) for row in table["step_responses"]]),
    )
    lines = [
        "\n".join(f"| {' | '.join(cells)} |" for cells in (headings, ["---"] * len(headings), *rows))
        for headings, rows in parts
    ]
    out.write("\n\n".join(lines) + "\n")


def _print(console: Console, title: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    framed = console.is_terminal
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD if framed else None, pad_edge=framed)
    for heading in headings:
        table.add_column(heading, overflow="fold")
    for row in rows:
        table.add_row(*row)
    console.print(table)


def _landing_cells(cell: Mapping[str, Any]) -> list[str]:
    noisy, truth, tiers = cell["noisy"], cell["truth"], cell["tiers"]
    return [
        cell["scenario"],
        cell["published"]["outcome"],
        cell["system"],
        f"{noisy['landed']} of {cell['seeds']}",
        _spread_text(noisy["t_s"], 2),
        _spread_text(noisy["x_m"], 1),
        _spread_text(noisy["y_m"], 1),
        f"{truth['landed']} of {cell['seeds']}",
        _spread_text(truth["t_s"], 2),
        _spread_text(cell["closest_m"], 2),
        "" if tiers is None else ", ".join(f"{count} {tier}" for tier, count in tiers.items()),
    ]


def _spread_text(spread: Mapping[str, float] | None, digits: int) -> str:
    if spread is None:
        return "-"
    return f"{spread['median']:.{digits}f} ({spread['min']:.{digits}f} to {spread['max']:.{digits}f})"


def _step_cells(row: Mapping[str, Any]) -> list[str]:
    published_s = row["published_settling_s"]
    return [
        row["loop"],
        row["airframe"] or "linear model",
        row["axis"],
        "" if published_s is None else f"{published_s:.2f}",
        f"{row['settling_s']:.3f}",
        f"{100.0 * row['overshoot']:.1f}",
    ]
