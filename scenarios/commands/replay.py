"""The command about recordings: `replay`."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.program.cli import JsonOption


def register(app: typer.Typer) -> None:
    """Add the commands to `app`."""
    app.command("replay")(replay_command)


def replay_command(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders with a companion's recording.")],
    *,
    config: Annotated[
        Path | None, typer.Option("--config", metavar="FILE", help="Replay with this configuration instead.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Give a recording's inputs to the companion again and compare every output; exit code 1 when one differs."""
    from companion.config.companion import CompanionConfig
    from link.program.toml_config import load_config
    from scenarios.recordings.replay import read_flights, replay, text_lines

    settings = None if config is None else load_config(config, CompanionConfig)
    results = [(name, replay(flight, settings)) for run in runs for name, flight in read_flights(run)]
    if as_json:
        rows = [{"run": name, **result.to_json()} for name, result in results]
        sys.stdout.write(json.dumps({"replays": rows}, indent=2, allow_nan=False) + "\n")
    else:
        sys.stdout.write("\n".join(text_lines(results)) + "\n")
    return 1 if any(result.differences for _, result in results) else 0
