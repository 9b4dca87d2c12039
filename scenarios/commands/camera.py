"""`scenarios camera`: the simulated camera as a program, for the real detector."""

from pathlib import Path
from typing import Annotated

import typer

from link.errors import UserError
from link.program.extras import require
from link.zenoh.command_line import NameArguments, ZenohArguments
from scenarios.commands.options import SeedOption


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("camera")(camera_command)


def camera_command(
    name: Annotated[str, typer.Argument(metavar="NAME|FILE", help="A scenario with a camera: straight_5+camera=day.")],
    *,
    seed: SeedOption = None,
    files: Annotated[
        Path | None,
        typer.Option("--files", metavar="DIR", help="Only write camera.yaml, mounting.toml and board.toml here."),
    ] = None,
    names: NameArguments,
    endpoints: ZenohArguments,
) -> None:
    """Publish what the camera on the simulated drone sees, for `pad-detector run --source zenoh`."""
    require("camera", "scenarios camera")
    from link.zenoh.session import open_session
    from scenarios.catalogue.catalogue import load_scenario
    from scenarios.catalogue.world_names import run_seed
    from scenarios.simulation.camera_scene import write_camera_files
    from scenarios.wire.camera_loop import CameraLoop

    scenario = load_scenario(name)
    if not scenario.has_camera:
        raise UserError(f"{name} has no camera: add +camera=day")
    drawn = run_seed(name, seed)
    if files is not None:
        write_camera_files(scenario, drawn, files)
        return
    keys = names.keys()
    with open_session(endpoints.options()) as zenoh:
        CameraLoop(scenario, drawn, keys, zenoh).run()
