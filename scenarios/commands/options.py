"""The options that several of the subcommands have."""

from pathlib import Path
from typing import Annotated

import typer

LANDINGS_MAX = 1_000_000
"""Of each kind in one command: worlds have as many seeds, and all are listed before the first is flown."""

WorkersOption = Annotated[
    int | None, typer.Option("--workers", min=1, metavar="N", help="Local processes [default: one a core].")
]
SeedOption = Annotated[
    int | None, typer.Option("--seed", min=0, help="Of everything random [default: 1, or the world's own].")
]
FirstSeedOption = Annotated[int, typer.Option("--first-seed", min=0, metavar="N", help="The others follow.")]
OneFirmwareOption = Annotated[
    str | None, typer.Option("--firmware", metavar="px4|ardupilot", help="Only this one [default: both].")
]
RunsOption = Annotated[Path, typer.Option("--out", metavar="DIR", help="Where the run's folder is made.")]
NoRecordOption = Annotated[
    bool, typer.Option("--no-record", help="Record neither the companion nor the truth; else both are, as MCAP.")
]
