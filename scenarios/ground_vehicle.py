"""The `ground-vehicle` command."""

import sys
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

app = make_app("Publish a ground vehicle over Zenoh: its position, velocity, heading and pad.")


@app.callback(invoke_without_command=True)
def ground_vehicle(
    *,
    scenario: Annotated[
        str | None, typer.Option("--scenario", metavar="NAME|FILE", help="Drive this scenario's vehicle.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of everything random.")] = 1,
    use_sim_time: Annotated[
        bool, typer.Option("--use-sim-time", help="Follow the simulation's clock on Zenoh.")
    ] = False,
    depart_at_once: Annotated[
        bool, typer.Option("--depart-at-once", help="Do not wait until the simulated drone hovers.")
    ] = False,
    timeout: Annotated[
        float, typer.Option("--timeout", min=0.0, help="Seconds without a simulated clock; 0 waits for ever.")
    ] = 60.0,
    namespace: NamespaceOption = "decklander",
    vehicle: VehicleOption = "vehicle",
    drone: DroneOption = "drone",
    mode: ModeOption = None,
    connect: ConnectOption = None,
    listen: ListenOption = None,
    multicast: MulticastOption = None,
    zenoh_config: ZenohConfigOption = None,
) -> None:
    """Publish a ground vehicle over Zenoh: its position, velocity, heading and pad."""
    from link.keys import Keys  # noqa: PLC0415 (Zenoh and numerics are slow to load, --help is quick)
    from link.zenoh_session import DEFAULT_ENDPOINT, ZenohOptions, open_session  # noqa: PLC0415
    from scenarios.catalogue import load_scenario  # noqa: PLC0415
    from scenarios.vehicle_loop import VehicleLoop  # noqa: PLC0415
    from scenarios.vehicle_node import VehicleNode, departing_at_once  # noqa: PLC0415

    if scenario is None:
        raise UserError("there is no vehicle: give --scenario NAME; `scenarios list` shows the names")
    driven = load_scenario(scenario)
    keys = Keys(namespace, vehicle, drone)
    nothing_said = mode != "client" and not (connect or listen or zenoh_config or multicast)
    options = ZenohOptions(
        mode=mode,
        connect=tuple(connect or ()),
        listen=(DEFAULT_ENDPOINT,) if nothing_said else tuple(listen or ()),
        multicast_scouting=multicast,
        config_file=zenoh_config,
    )
    node = VehicleNode(departing_at_once(driven) if depart_at_once else driven, seed, keys)
    with open_session(options) as zenoh:
        VehicleLoop(node, keys, zenoh, use_sim_time=use_sim_time, timeout_s=timeout).run()


def main() -> None:
    """Run the command."""
    sys.exit(run_app("ground-vehicle", app))


if __name__ == "__main__":
    main()
