"""The `companion` command."""

import json
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.cli import (
    ConnectOption,
    DroneOption,
    ListenOption,
    ModeOption,
    MulticastOption,
    NamespaceOption,
    VehicleOption,
    ZenohConfigOption,
    make_app,
    run_app,
)
from link.errors import UserError

app = make_app("Land a drone on a moving vehicle: estimate, plan, and fly any MAVLink autopilot.")


@app.callback(invoke_without_command=True)
def companion(
    mavlink: Annotated[
        str,
        typer.Option(
            "--mavlink", metavar="DEVICE", help="udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT or /dev/ttyX,BAUD."
        ),
    ] = "udpin:127.0.0.1:14540",
    config: Annotated[Path | None, typer.Option("--config", metavar="FILE", help="Configuration in TOML.")] = None,
    print_config: Annotated[bool, typer.Option("--print-config", help="Print the configuration and end.")] = False,
    start: Annotated[
        bool, typer.Option("--start", help="Arm, take off and land without an operator's command.")
    ] = False,
    timeout: Annotated[
        float, typer.Option("--timeout", min=0.0, help="Seconds without an autopilot or vehicle; 0 waits for ever.")
    ] = 60.0,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Do everything but send setpoints and commands.")] = False,
    use_sim_time: Annotated[
        bool, typer.Option("--use-sim-time", help="Follow the simulation's clock on Zenoh.")
    ] = False,
    system_id: Annotated[
        int, typer.Option("--system-id", min=1, max=255, help="MAVLink system id of the vehicle.")
    ] = 1,
    tlog: Annotated[Path | None, typer.Option("--tlog", metavar="FILE", help="Record MAVLink into this file.")] = None,
    timing: Annotated[
        Path | None, typer.Option("--timing", metavar="FILE", help="Write step times here at the end.")
    ] = None,
    namespace: NamespaceOption = "decklander",
    vehicle: VehicleOption = "vehicle",
    drone: DroneOption = "drone",
    mode: ModeOption = None,
    connect: ConnectOption = None,
    listen: ListenOption = None,
    multicast: MulticastOption = None,
    zenoh_config: ZenohConfigOption = None,
) -> None:
    """Land a drone on a moving vehicle: estimate, plan, and fly any MAVLink autopilot."""
    from companion.config import CompanionConfig  # noqa: PLC0415 (numerics are slow to load, --help is quick)
    from link.toml_config import dump_toml, load_config  # noqa: PLC0415

    settings = load_config(config, CompanionConfig)
    if print_config:
        sys.stdout.write(dump_toml(settings))
        return
    from link.keys import Keys  # noqa: PLC0415
    from link.mavlink.device import parse_device  # noqa: PLC0415
    from link.zenoh_options import DEFAULT_ENDPOINT, ZenohOptions  # noqa: PLC0415

    keys = Keys(namespace, vehicle, drone)
    parse_device(mavlink)  # a mistake is told before the numerics are loaded
    if timing is not None:
        _check_writable(timing)
    nothing_said = not (connect or listen or zenoh_config or multicast)
    zenoh_options = ZenohOptions(
        mode=mode,
        connect=(DEFAULT_ENDPOINT,) if nothing_said else tuple(connect or ()),
        listen=tuple(listen or ()),
        multicast_scouting=multicast,
        config_file=zenoh_config,
    )
    from companion.build import build_node  # noqa: PLC0415
    from companion.loop import Links, LoopOptions, run  # noqa: PLC0415
    from link.mavlink.transports import open_transport  # noqa: PLC0415
    from link.zenoh_session import open_session  # noqa: PLC0415

    node = build_node(settings, keys, system_id=system_id, dry_run=dry_run, records_input=tlog is not None)
    options = LoopOptions(device=mavlink, timeout_s=timeout, start=start, use_sim_time=use_sim_time, tlog=tlog)
    with open_transport(mavlink) as transport, open_session(zenoh_options) as zenoh:
        timings = run(node, Links(keys=keys, transport=transport, zenoh=zenoh), options)
    if timing is not None:
        timing.write_text(json.dumps(timings.summary(), indent=2) + "\n", encoding="utf-8")


def _check_writable(path: Path) -> None:
    """Find out before the flight, not after it."""
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise UserError(f"{path}: cannot be written; choose another place")


def main() -> None:
    """Run the command."""
    sys.exit(run_app("companion", app))


if __name__ == "__main__":
    main()
