"""`scenarios eyes`: how well the detector sees, over rendered frames."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.program.cli import JsonOption, note
from link.program.extras import require

_TOLD_EVERY = 100


def register(app: typer.Typer) -> None:
    """Add the command to `app`."""
    app.command("eyes")(eyes_command)


def eyes_command(
    *,
    frames: Annotated[int, typer.Option("--frames", min=1, help="Frames with the board.")] = 500,
    bare: Annotated[
        int, typer.Option("--bare", min=0, help="Frames without it, half of them with another board.")
    ] = 250,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of everything drawn.")] = 1,
    pictures: Annotated[
        Path | None, typer.Option("--examples", metavar="DIR", help="Only draw what it sees from 8, 2 and 0.2 m there.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Let the detector of the pad look at frames drawn over range, angle and light, and compare it with the truth."""
    require("camera", "scenarios eyes")
    from scenarios.eyes.pictures import write_pictures
    from scenarios.eyes.study import study
    from scenarios.eyes.tables import summary_of, text_lines

    if pictures is not None:
        write_pictures(pictures, seed)
        return

    def tell(done: int) -> None:
        if not as_json and done % _TOLD_EVERY == 0:
            note(f"{done} frames")

    looks = [
        *study(frames, seed, has_board=True, tell=tell),
        *study(bare, seed, has_board=False, tell=tell),
    ]
    table = summary_of(looks)
    sys.stdout.write((json.dumps(table, indent=2) if as_json else "\n".join(text_lines(table))) + "\n")
