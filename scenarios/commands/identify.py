"""The command `identify`: how an autopilot follows setpoints, beside the stand-in that is to fly as it does."""

import json
import math
import sys
from typing import TYPE_CHECKING, Annotated

import typer

from link.errors import UserError
from link.program.cli import JsonOption, note

if TYPE_CHECKING:
    from scenarios.identify.fit import Law
    from scenarios.identify.pilot import Stage

    Column = tuple[str, dict[str, float], Law]


def register(app: typer.Typer) -> None:
    """Add the command to `app`."""
    app.command("identify")(identify_command)


def identify_command(
    mavlink: Annotated[
        str | None,
        typer.Option("--mavlink", metavar="DEVICE", help="Where an autopilot is met, simulated by its own firmware."),
    ] = None,
    *,
    firmware: Annotated[
        str | None,
        typer.Option("--firmware", metavar="px4|ardupilot", help="Of sim-autopilot [default: that of the autopilot]."),
    ] = None,
    parameter: Annotated[
        list[str] | None, typer.Option("--parameter", metavar="NAME=VALUE", help="Of sim-autopilot; may be repeated.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Fly steps, ramps, reversals and a circle with an autopilot and with sim-autopilot, and show both side by side.

    The autopilot takes off, flies for two minutes in real time within 50 m, 8 to 17 m up, and is left hovering: a
    simulation, or a drone in the open. Without --mavlink sim-autopilot flies alone, in lockstep.
    """
    from scenarios.identify.figures import figures
    from scenarios.identify.fit import fit_law
    from scenarios.identify.flying import check_stand_in, fly_endpoint, fly_stand_in

    parameters = _parse(parameter or [])
    check_stand_in(firmware, parameters)
    columns: list[Column] = []
    if mavlink is not None:
        flight = fly_endpoint(mavlink, _tell)
        if firmware not in (None, flight.autopilot):
            raise UserError(f"--firmware {firmware}: the autopilot at {mavlink} is {flight.autopilot}; leave it out")
        firmware = flight.autopilot
        columns.append((flight.autopilot, figures(flight), fit_law(flight)))
    if firmware is None:
        raise UserError("nothing to fly: give --mavlink DEVICE, or --firmware px4 or ardupilot for sim-autopilot alone")
    flight = fly_stand_in(firmware, parameters)
    columns.append(("stand-in", figures(flight), fit_law(flight)))
    if as_json:
        rows = {name: {"figures": found, "law": law.to_json()} for name, found, law in columns}
        sys.stdout.write(json.dumps(rows, indent=2, allow_nan=False) + "\n")
    else:
        _print(columns)


def _parse(given: list[str]) -> dict[str, float]:
    """Return parameters by name.

    Raises:
        UserError: one is not NAME=VALUE.
    """
    found = {}
    for one in given:
        name, _, value = one.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise UserError(f"--parameter {one}: write NAME=VALUE, such as MPC_XY_P=0.95") from None
        if not (name and math.isfinite(found[name])):
            raise UserError(f"--parameter {one}: write NAME=VALUE, such as MPC_XY_P=0.95")
    return found


def _tell(stage: "Stage") -> None:
    note(f"{stage.name.lower()}")


def _print(columns: "list[Column]") -> None:
    rows = [(name, [found[name] for _, found, _ in columns]) for name in columns[0][1]]
    rows += [(f"fitted {name}", [law.to_json()[name] for _, _, law in columns]) for name in columns[0][2].to_json()]
    width = max(len(name) for name, _ in rows)
    sys.stdout.write(f"{'':{width}}  {'  '.join(f'{name:>9}' for name, _, _ in columns)}\n")
    for name, values in rows:
        sys.stdout.write(f"{name:{width}}  {'  '.join(f'{value:9.2f}' for value in values)}\n")
