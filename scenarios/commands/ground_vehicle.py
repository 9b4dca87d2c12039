"""The `ground-vehicle` command."""

from collections.abc import Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from link.errors import UserError
from link.program.cli import SetOption, make_app
from link.ros2.command_line import Ros2Arguments
from link.zenoh.command_line import NameArguments, ZenohArguments
from scenarios.commands.examples import GROUND_VEHICLE
from scenarios.commands.options import SeedOption

if TYPE_CHECKING:
    from collections.abc import Callable

    from link.messages import PadGeometry
    from link.zenoh.keys import Keys
    from link.zenoh.session import ZenohSession
    from scenarios.vehicle_sources.channel import OpenTransport
    from scenarios.vehicle_sources.receiver import Receiver

    OpenZenoh = Callable[[], ZenohSession]

_RECEIVER = "A real vehicle"
_PAD = "Its pad"

app = make_app("Publish a ground vehicle over Zenoh: its position, velocity, heading and pad.", GROUND_VEHICLE)

_ScenarioOption = Annotated[
    str | None, typer.Option("--scenario", metavar="NAME|FILE", help="Drive this scenario's vehicle.")
]
_GpsdOption = Annotated[
    str | None,
    typer.Option("--gpsd", metavar="HOST:PORT", help="Publish what this gpsd reports.", rich_help_panel=_RECEIVER),
]
_NmeaOption = Annotated[
    str | None,
    typer.Option(
        "--nmea",
        metavar="DEVICE",
        help="Publish what a receiver says in NMEA 0183: /dev/ttyX,BAUD, tcp://HOST:PORT, udpin:HOST:PORT or a file.",
        rich_help_panel=_RECEIVER,
    ),
]
_MavlinkOption = Annotated[
    str | None,
    typer.Option(
        "--mavlink",
        metavar="DEVICE",
        help="Publish what the receiver of an autopilot on the vehicle says: /dev/ttyX,BAUD, udpin:HOST:PORT.",
        rich_help_panel=_RECEIVER,
    ),
]
_PadOption = Annotated[
    Path | None,
    typer.Option(
        "--pad",
        metavar="FILE",
        help="The pad, in TOML: size_m, height_m, antenna_to_pad_m.",
        rich_help_panel=_PAD,
    ),
]
_PadSizeOption = Annotated[
    tuple[float, float] | None,
    typer.Option("--pad-size", metavar="LENGTH WIDTH", help="Along and across the vehicle, m.", rich_help_panel=_PAD),
]
_PadHeightOption = Annotated[
    float | None, typer.Option("--pad-height", metavar="M", help="Above the road.", rich_help_panel=_PAD)
]
_AntennaToPadOption = Annotated[
    tuple[float, float, float] | None,
    typer.Option(
        "--antenna-to-pad",
        metavar="X Y Z",
        help="From the antenna to the pad's middle: forward, left, up, m.",
        rich_help_panel=_PAD,
    ),
]
_UseSimTimeOption = Annotated[bool, typer.Option("--use-sim-time", help="Follow the simulation's clock on Zenoh.")]
_DepartAtOnceOption = Annotated[
    bool, typer.Option("--depart-at-once", help="Do not wait until the simulated drone hovers.")
]
_TimeoutOption = Annotated[
    float | None,
    typer.Option("--timeout", min=0.0, help="Seconds without a simulated clock; 0 waits for ever [default: 60]."),
]
_TIMEOUT_S = 60.0


@app.callback(invoke_without_command=True)
def ground_vehicle(
    *,
    scenario: _ScenarioOption = None,
    gpsd: _GpsdOption = None,
    nmea: _NmeaOption = None,
    mavlink: _MavlinkOption = None,
    pad: _PadOption = None,
    pad_size: _PadSizeOption = None,
    pad_height: _PadHeightOption = None,
    antenna_to_pad: _AntennaToPadOption = None,
    seed: SeedOption = None,
    changes: SetOption = None,
    use_sim_time: _UseSimTimeOption = False,
    depart_at_once: _DepartAtOnceOption = False,
    timeout: _TimeoutOption = None,
    names: NameArguments,
    endpoints: ZenohArguments,
    ros2: Ros2Arguments,
) -> None:
    """Publish a ground vehicle over Zenoh: its position, velocity, heading and pad."""
    if sum(one is not None for one in (scenario, gpsd, nmea, mavlink)) > 1:
        raise UserError("--scenario, --gpsd, --nmea and --mavlink are one vehicle each: give one of them")
    keys = names.keys()
    open_zenoh = _zenoh_opener(keys, endpoints, ros2)
    if scenario is not None:
        if any(one is not None for one in (pad, pad_size, pad_height, antenna_to_pad)):
            raise UserError(
                "--pad and what else describes a pad are for a real vehicle: leave them out with --scenario, whose "
                "file says pad_size_m, roof_height_m and antenna_flu_m of its [vehicle]"
            )
        timeout_s = _TIMEOUT_S if timeout is None else timeout
        _drive(_Simulation(scenario, changes, seed, depart_at_once, use_sim_time, timeout_s), keys, open_zenoh)
        return
    _check_real(changes, seed, timeout, use_sim_time=use_sim_time, depart_at_once=depart_at_once)
    source = _source(gpsd, nmea, mavlink)
    from scenarios.vehicle_sources.pad import pad_geometry

    geometry = pad_geometry(pad, size_m=pad_size, height_m=pad_height, antenna_to_pad_m=antenna_to_pad)
    _listen(source, geometry, keys, open_zenoh)


def _zenoh_opener(keys: "Keys", endpoints: ZenohArguments, ros2: Ros2Arguments) -> "OpenZenoh":
    """Return what opens the session that the options describe."""
    from link.ros2.layout import open_layout

    layout = ros2.options()
    # a ROS 2 graph has its router at the default endpoint; else the vehicle waits there for the others
    options = endpoints.options(listens=layout is None)
    return partial(open_layout, options, layout, keys, (f"/{keys.vehicle}", "ground_vehicle"))


def _check_real(
    changes: Sequence[str] | None,
    seed: int | None,
    timeout_s: float | None,
    *,
    use_sim_time: bool,
    depart_at_once: bool,
) -> None:
    """Find out what would change nothing.

    Raises:
        UserError: an option is of a scenario's vehicle only.
    """
    if changes:
        raise UserError("--set changes a scenario: leave it out with a real vehicle, whose pad has options of its own")
    simulated = {
        "--use-sim-time": use_sim_time,
        "--seed": seed is not None,
        "--depart-at-once": depart_at_once,
        "--timeout": timeout_s is not None,
    }
    given = [option for option, is_given in simulated.items() if is_given]
    if given:
        raise UserError(f"{' and '.join(given)}: only for the vehicle of --scenario; leave that out with a real one")


class _Simulation(NamedTuple):
    scenario: str
    changes: Sequence[str] | None
    seed: int | None
    departs_at_once: bool
    uses_sim_time: bool
    timeout_s: float


class _Source(NamedTuple):
    name: str
    receiver: "Receiver"
    open_transport: "OpenTransport"


def _source(gpsd: str | None, nmea: str | None, mavlink: str | None) -> _Source:
    """Return the receiver that the user named; only what it needs is imported."""
    from link.transports.opening import open_transport
    from scenarios.vehicle_sources.channel import device_opener, gpsd_address, nmea_opener

    if gpsd is not None:
        from scenarios.vehicle_sources.gpsd import GpsdReceiver

        address, device = gpsd_address(gpsd)
        return _Source(f"gpsd at {gpsd}", GpsdReceiver(device), lambda: open_transport(str(address)))
    if nmea is not None:
        from scenarios.vehicle_sources.nmea import NmeaReceiver

        return _Source(nmea, NmeaReceiver(), nmea_opener(nmea))
    if mavlink is not None:
        from scenarios.vehicle_sources.mavlink import MavlinkReceiver

        return _Source(mavlink, MavlinkReceiver(), device_opener(mavlink))
    raise UserError(
        "there is no vehicle: give --scenario NAME (`scenarios list` shows the names), or a receiver by "
        "--gpsd HOST:PORT, --nmea DEVICE or --mavlink DEVICE"
    )


def _listen(source: _Source, pad: "PadGeometry", keys: "Keys", open_zenoh: "OpenZenoh") -> None:
    """Publish a real vehicle."""
    from link.program.service import Service
    from link.recording.log import Log
    from scenarios.vehicle_sources.loop import ReceiverLoop

    with open_zenoh() as zenoh, closing(Log("ground-vehicle")) as log:
        ReceiverLoop(
            source.receiver,
            source.open_transport,
            source.name,
            keys=keys,
            zenoh=zenoh,
            pad=pad,
            service=Service(),
            log=log,
        ).run()


def _drive(simulation: _Simulation, keys: "Keys", open_zenoh: "OpenZenoh") -> None:
    """Publish a scenario's vehicle."""
    from scenarios.catalogue.catalogue import load_changed_scenario
    from scenarios.catalogue.world_names import run_seed
    from scenarios.simulation.vehicle_node import VehicleNode, departing_at_once
    from scenarios.wire.vehicle_loop import VehicleLoop

    driven = load_changed_scenario(simulation.scenario, simulation.changes)
    seed = run_seed(simulation.scenario, simulation.seed)
    driven = departing_at_once(driven) if simulation.departs_at_once else driven
    node = VehicleNode(driven, seed, keys, has_eyes=False)
    with open_zenoh() as zenoh:
        VehicleLoop(node, keys, zenoh, use_sim_time=simulation.uses_sim_time, timeout_s=simulation.timeout_s).run()
