"""The `scenarios` command."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from link.errors import UserError
from link.program.cli import JsonOption, SetOption, make_app
from link.zenoh.command_line import DroneOption, NameArguments, NamespaceOption, ZenohArguments
from scenarios.commands import (
    attack,
    bench,
    camera,
    campaign,
    eyes,
    falsify,
    faults,
    fly,
    fuzz,
    identify,
    rare,
    report,
    retries,
    ros2,
    sortie,
)
from scenarios.commands import view as view_command
from scenarios.commands.examples import SCENARIOS
from scenarios.commands.options import NoRecordOption, RunsOption, SeedOption

app = make_app("Experiments: run landings, score them on ground truth, and report.", SCENARIOS)

NameArgument = Annotated[
    str, typer.Argument(metavar="NAME|FILE", help="Scenario; `scenarios list` shows them. Or a world: world:urban@1.")
]

FirmwareOption = Annotated[
    str | None, typer.Option("--firmware", metavar="px4|ardupilot", help="In place of the scenario's.")
]


@app.command("list")
def list_command(*, as_json: JsonOption = False) -> None:
    """List the scenarios, the presets that go behind their names, and the worlds."""
    import json

    from scenarios.catalogue.catalogue import list_presets, list_scenarios
    from scenarios.worlds.odd import slices

    entries, presets = list_scenarios(), list_presets()
    if as_json:
        rows = [{"name": entry.name, "description": entry.description} for entry in entries]
        sys.stdout.write(json.dumps({"scenarios": rows, "presets": presets, "worlds": slices()}, indent=2) + "\n")
        return
    width = max(len(entry.name) for entry in entries)
    for entry in entries:
        sys.stdout.write(f"{entry.name:{width}}  {entry.description}\n")
    sys.stdout.write("\nPresets, the first of each line unless told; such as circle_5+wind=gust+link=nominal:\n")
    for section, names in presets.items():
        sys.stdout.write(f"  {section:{width - 2}}  {', '.join(names)}\n")
    sys.stdout.write(f"\nWorlds, drawn by their seed; such as {slices()[-1]}@1:\n  {', '.join(slices())}\n")


@app.command("run")
def run_command(
    name: NameArgument,
    *,
    seed: SeedOption = None,
    speed: Annotated[
        float | None, typer.Option("--speed", min=0.1, max=50.0, help="Simulated seconds a second [default: 1].")
    ] = None,
    lockstep: Annotated[bool, typer.Option("--lockstep", help="In one process on a simulated clock.")] = False,
    firmware: FirmwareOption = None,
    changes: SetOption = None,
    out: RunsOption = Path("runs"),
    no_record: NoRecordOption = False,
    view: Annotated[bool, typer.Option("--view", help="Show the landing in the browser.")] = False,
    as_json: JsonOption = False,
) -> int:
    """Run a landing and score it on ground truth; exit code 1 when it does not land."""
    from link.program.settings import SCENARIO, refuse_variables
    from scenarios.catalogue.catalogue import load_changed_scenario
    from scenarios.catalogue.firmware_option import with_firmware
    from scenarios.catalogue.world_names import run_seed
    from scenarios.commands.run_lines import Reporter
    from scenarios.lockstep.run import run_in_lockstep
    from scenarios.recordings.run_folder import RunOptions, run_folder
    from scenarios.wire.run import run_over_wire

    refuse_variables(apart_from=SCENARIO)
    scenario = load_changed_scenario(name if firmware is None else with_firmware(name, firmware), changes)
    if lockstep and speed is not None:
        raise UserError("--lockstep flies as fast as it can: leave out --speed")
    view_port = view_command.port_of_run(lockstep=lockstep, as_json=as_json) if view else None
    folder = run_folder(out, scenario.name)
    options = RunOptions(
        seed=run_seed(name, seed), speed=speed or 1.0, folder=folder, record=not no_record, view_port=view_port
    )
    run = run_in_lockstep if lockstep else run_over_wire
    with Reporter(scenario, folder, as_json=as_json) as reporter:
        try:
            outcome = run(scenario, options, reporter.progress)
        except UserError as error:
            raise UserError(f"{error} (what was written: {folder})") from error
    return reporter.conclude(outcome)


@app.command("world")
def world_command(
    name: NameArgument,
    *,
    seed: SeedOption = None,
    speed: Annotated[float, typer.Option("--speed", min=0.1, max=50.0, help="Simulated seconds a second.")] = 1.0,
    mavlink: Annotated[
        str, typer.Option("--mavlink", metavar="DEVICE", help="Where the companion listens.")
    ] = "udpout:127.0.0.1:14540",
    firmware: FirmwareOption = None,
    changes: SetOption = None,
    names: NameArguments,
    endpoints: ZenohArguments,
) -> None:
    """Run the simulated side of a scenario, the autopilot with the vehicle in it, in one process."""
    from link.transports.opening import open_transport
    from link.zenoh.session import open_session
    from scenarios.catalogue.catalogue import load_changed_scenario
    from scenarios.catalogue.firmware_option import with_firmware
    from scenarios.catalogue.world_names import run_seed
    from scenarios.wire.world import WorldLoop

    scenario = load_changed_scenario(name if firmware is None else with_firmware(name, firmware), changes)
    keys = names.keys()
    options = endpoints.options(listens=True)
    with open_transport(mavlink, is_patient=True) as transport, open_session(options) as zenoh:
        WorldLoop(scenario, run_seed(name, seed), keys, transport, zenoh, speed=speed).run()


@app.command("command")
def command_command(
    command: Annotated[
        str,
        typer.Argument(
            metavar="start|abort|hold|launch|follow|return|start_anyway", help="What the companion is asked for."
        ),
    ],
    *,
    offset: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y Z", help="Of a follow: metres ahead, left and up of the pad's centre."),
    ] = None,
    frame: Annotated[
        str | None, typer.Option(metavar="vehicle|course|north", help="Of a follow: which way is ahead.")
    ] = None,
    as_json: JsonOption = False,
    namespace: NamespaceOption = "decklander",
    drone: DroneOption = "drone",
    endpoints: ZenohArguments,
) -> int:
    """Send a command to the companion; exit code 1 when it is refused."""
    import json

    from link.program.text import printable
    from link.zenoh.keys import Keys
    from scenarios.commands.operator import order_of, send_order

    reply = send_order(order_of(command, offset, frame), Keys(namespace, "vehicle", drone), endpoints.options())
    told = printable(str(reply))
    sys.stdout.write((json.dumps({"accepted": reply.accepted, "reason": reply.reason}) if as_json else told) + "\n")
    return 0 if reply.accepted else 1


for command in (
    campaign,
    sortie,
    falsify,
    rare,
    bench,
    fuzz,
    identify,
    attack,
    faults,
    retries,
    report,
    fly,
    view_command,
    ros2,
    camera,
    eyes,
):
    command.register(app)
