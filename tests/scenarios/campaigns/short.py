"""Short campaigns for the tests: cells of seconds, and a program with the campaign commands."""

import json
import sys
from pathlib import Path
from typing import Any

from link.program.cli import make_app, run_app
from scenarios.commands import campaign as campaign_commands
from scenarios.commands import report as report_commands

app = make_app("Campaigns.")
campaign_commands.register(app)
report_commands.register(app)

_SHORT = 'base = "straight_5"\nsensors = "nominal"\nwind = "moderate"\n'


def short_cell(folder: Path, name: str = "short", *, time_limit_s: float = 0.5, text: str = "") -> str:
    """Write a cell and return its file's name; called off on the ground, as by default, it ends at once."""
    file = folder / f"{name}.toml"
    file.write_text(f"{_SHORT}run.time_limit_s = {time_limit_s}\n{text}", encoding="utf-8")
    return str(file)


def failing_cell(folder: Path) -> str:
    """Write a cell whose drone starts on a roof that is higher than one may start, and return its file's name."""
    return short_cell(folder, "failing", text='run.place = "deck"\nvehicle.roof_height_m = 1e4\n')


def scenarios(*args: object) -> int:
    """Run the program and return its exit code."""
    return run_app("scenarios", app, [str(arg) for arg in args])


def journal_of(folder: Path) -> list[dict[str, Any]]:
    """Return the lines of a campaign's journal."""
    return [json.loads(line) for line in (folder / "landings.jsonl").read_text(encoding="utf-8").splitlines()]


if __name__ == "__main__":
    sys.exit(scenarios(*sys.argv[1:]))
