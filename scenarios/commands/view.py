"""The command `view`: a landing or a recording in the browser."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from link.errors import UserError
from link.program.cli import FoxgloveOption
from link.program.extras import require
from link.zenoh.command_line import NameArguments, ZenohArguments

if TYPE_CHECKING:
    from link.zenoh.keys import Keys
    from scenarios.view.live import LiveSource
    from scenarios.view.recorded import RecordedSource, Road

DEFAULT_PORT = 8080


def register(app: typer.Typer) -> None:
    """Add the command to `app`."""
    app.command("view")(view_command)


def port_of_run(*, lockstep: bool, as_json: bool) -> int:
    """Return the port of the page of a run, and tell it.

    Raises:
        UserError: there is nothing to see, or nothing to show it with.
    """
    from scenarios.processes.programs import reserve_tcp_port

    if lockstep:
        raise UserError("--lockstep is over at once: leave out --view, and give the run's folder to `scenarios view`")
    require("view", "--view")
    port = reserve_tcp_port(DEFAULT_PORT)
    (sys.stderr if as_json else sys.stdout).write(f"view: http://127.0.0.1:{port} (it opens in some seconds)\n")
    return port


def view_command(
    recording: Annotated[
        Path | None, typer.Argument(metavar="[RUN|FILE.mcap]", help="A recording; without one, what is on Zenoh.")
    ] = None,
    *,
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Of the page, on this machine only; 0 is any free one.")
    ] = DEFAULT_PORT,
    road: Annotated[
        str | None, typer.Option("--road", metavar="NAME|FILE", help="Draw the road of this scenario.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Of that scenario [default: 1, or the world's own].")
    ] = None,
    foxglove: FoxgloveOption = None,
    foxglove_layout: Annotated[
        Path | None, typer.Option("--foxglove-layout", metavar="FILE", help="Write a layout for Foxglove, and end.")
    ] = None,
    names: NameArguments,
    endpoints: ZenohArguments,
) -> None:
    """Show a landing in the browser as it goes on, or play a recording.

    From another machine: ssh -L 8080:127.0.0.1:8080 THIS_MACHINE, and http://127.0.0.1:8080 there.
    """
    keys = names.keys()
    if seed is not None and road is None:
        raise UserError("--seed is that of the scenario of --road: give --road, or leave it out")
    if road is not None and recording is not None:
        raise UserError(f"{recording} tells its own road: leave out --road")
    if foxglove_layout is not None:
        _write_layout(foxglove_layout, keys)
        return
    if foxglove is None:
        require("view", "scenarios view")
    else:
        require("foxglove", "scenarios view --foxglove")
    if recording is not None:
        from scenarios.view.recorded import RecordedSource

        source = RecordedSource(recording)
        _show(source, source.road, port, keys, foxglove)
        return
    from link.zenoh.session import open_session
    from scenarios.view.live import LiveSource

    drawn = None if road is None else _road_of(road, seed)
    with open_session(endpoints.options()) as zenoh:
        _show(LiveSource(zenoh, keys), drawn, port, keys, foxglove)


def _write_layout(path: Path, keys: "Keys") -> None:
    from scenarios.view.foxglove_layout import layout_json

    try:
        path.write_text(layout_json(keys) + "\n", encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); choose another --foxglove-layout") from error


def _road_of(name: str, seed: int | None) -> "Road":
    """Return the road of a scenario or a world."""
    from scenarios.catalogue.catalogue import load_scenario
    from scenarios.catalogue.world_names import run_seed
    from scenarios.view.recorded import Road

    return Road(scenario=load_scenario(name), seed=run_seed(name, seed))


def _show(
    source: "LiveSource | RecordedSource", road: "Road | None", port: int, keys: "Keys", foxglove_port: int | None
) -> None:
    """Serve the page, or Foxglove, until a signal comes."""
    if foxglove_port is not None:
        from companion.config.companion import CompanionConfig
        from link.recording.foxglove_server import FoxgloveServer
        from scenarios.view.foxglove import FoxgloveView

        descent = CompanionConfig().descent if road is None else road.scenario.system.companion.descent
        FoxgloveView(source, descent, keys, FoxgloveServer(foxglove_port)).run()
        return
    from scenarios.processes.programs import free_tcp_port
    from scenarios.view.page import Page

    with Page(source, road, free_tcp_port(port)) as page:
        page.run()
