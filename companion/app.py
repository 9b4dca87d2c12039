"""The `companion` command."""

import sys
from typing import Annotated

import typer

from companion.check.command import check
from companion.config.autopilot import Guide
from companion.runtime.command_line import ConfigArguments, MavlinkArguments, RecordArguments, RunArguments
from companion.runtime.keys import keys
from companion.runtime.reasons import reasons
from link.errors import UserError
from link.program.cli import make_app
from link.ros2.command_line import Ros2Arguments
from link.zenoh.command_line import NameArguments, ZenohArguments

_EXAMPLES = {
    "": (
        "companion --mavlink /dev/ttyACM0,921600 --zenoh-config companion.json5 --vehicle car",
        "companion --mavlink udpin:127.0.0.1:14540 --start     # beside `scenarios world straight_5`",
        "companion --print-config > companion.toml",
    ),
    "check": (
        "companion check --mavlink /dev/ttyACM0,921600 --speed-max 8",
        "companion check --mavlink udpin:0.0.0.0:14540 --write",
        "companion check --mavlink udpin:0.0.0.0:14540 --restore parameters_before.json",
    ),
    "keys": ("companion keys keys --host 192.168.4.1",),
    "reasons": ("companion reasons OFFSET_UNKNOWN",),
}
"""What the help of `companion` shows as examples, by command."""

app = make_app("Land a drone on a moving vehicle: estimate, plan, and fly any MAVLink autopilot.", _EXAMPLES)
app.command("check")(check)
app.command("keys")(keys)
app.command("reasons")(reasons)

_PrintConfigOption = Annotated[bool, typer.Option("--print-config", help="Print the configuration and end.")]


@app.callback(invoke_without_command=True)
def companion(
    context: typer.Context,
    *,
    mavlink: MavlinkArguments,
    chosen: ConfigArguments,
    print_config: _PrintConfigOption = False,
    run: RunArguments,
    record: RecordArguments,
    names: NameArguments,
    endpoints: ZenohArguments,
    ros2: Ros2Arguments,
) -> None:
    """Land a drone on a moving vehicle: estimate, plan, and fly any MAVLink autopilot."""
    if context.invoked_subcommand is not None:
        return
    config = chosen.load()
    if run.start and config.autopilot.guide is Guide.PRECLAND:
        raise UserError("--start: with --guide precland the autopilot's own mode begins the landing; leave one out")
    if print_config:
        from link.program.toml_config import dump_toml

        sys.stdout.write(dump_toml(config))
        return
    from companion.runtime.program import Program, run_program

    run_program(
        Program(
            config=config,
            keys=names.keys(),
            mavlink=mavlink,
            zenoh=endpoints.options(),
            ros2=ros2.options(),
            run=run,
            record=record,
        )
    )
