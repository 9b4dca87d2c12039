"""`scenarios fly`: a landing with an autopilot's own simulation."""

from pathlib import Path
from typing import Annotated

import typer

from link.program.cli import JsonOption, SetOption
from scenarios.commands.options import NoRecordOption, RunsOption

_NAME = "Scenario whose track, sensors and companion are used; `scenarios list` shows them."


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("fly")(fly_command)


def fly_command(
    name: Annotated[str, typer.Argument(metavar="NAME|FILE", help=_NAME)],
    *,
    mavlink: Annotated[
        str, typer.Option("--mavlink", metavar="DEVICE", help="Where the autopilot meets the companion.")
    ] = "udpin:127.0.0.1:14540",
    watch: Annotated[
        str, typer.Option("--watch", metavar="DEVICE", help="A second link, on which the simulation tells its truth.")
    ] = "udpin:127.0.0.1:14550",
    ship: Annotated[
        float | None,
        typer.Option(
            "--ship", min=0.1, max=50.0, metavar="M_S", help="Land on ArduPilot's simulated ship at this speed."
        ),
    ] = None,
    sortie: Annotated[
        bool, typer.Option("--sortie", help="Launch from the vehicle, follow at three stations, come home and land.")
    ] = False,
    seed: Annotated[
        int | None, typer.Option("--seed", min=0, help="Of the vehicle's sensors [default: 1, or the world's own].")
    ] = None,
    no_record: NoRecordOption = False,
    changes: SetOption = None,
    out: RunsOption = Path("runs"),
    as_json: JsonOption = False,
) -> int:
    """Fly with PX4's or ArduPilot's own simulation, which runs already; exit code 1 when it does not land.

    The vehicle drives by the place where the simulated drone stands, its pad at the height of the ground. In a sortie
    the drone launches from it; exit code 1 also when it touches anything between lift-off and landing.
    """
    from link.program.settings import SCENARIO, refuse_variables
    from link.transports.device import parse_device
    from scenarios.catalogue.catalogue import load_changed_scenario
    from scenarios.catalogue.world_names import run_seed
    from scenarios.commands.run_lines import Reporter
    from scenarios.firmware.fly import fly
    from scenarios.firmware.options import FlyOptions
    from scenarios.recordings.run_folder import run_folder

    refuse_variables(apart_from=SCENARIO)
    for device in (mavlink, watch):
        parse_device(device)  # a mistake is told before there is a folder, and before anybody is waited for
    scenario = load_changed_scenario(name, changes)
    folder = run_folder(out, scenario.name)
    options = FlyOptions(
        mavlink=mavlink,
        watch=watch,
        ship_speed_m_s=ship,
        seed=run_seed(name, seed),
        folder=folder,
        sortie=sortie,
        record=not no_record,
    )
    with Reporter(scenario, folder, as_json=as_json, flies="the autopilot that answers") as reporter:
        outcome = fly(scenario, options, reporter.progress)
    code = reporter.conclude(outcome)
    return 1 if sortie and outcome.result["sortie"]["contacts"] else code
