"""The `sim-autopilot` command."""

import signal
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from link.program.cli import SetOption, make_app
from link.program.exit_codes import EXIT_OK
from link.program.interrupts import interrupt
from link.zenoh.command_line import NameArguments, ZenohArguments

_EXAMPLES = {
    "": (
        "sim-autopilot",
        "sim-autopilot --firmware ardupilot --instance 1 --wind 5 --turbulence moderate",
        "sim-autopilot --mavlink udpout:127.0.0.1:14540 --mavlink tcpin:127.0.0.1:5760",
    ),
}
"""What the help of `sim-autopilot` shows as examples."""

app = make_app("Simulate a quadrotor under an autopilot that speaks MAVLink.", _EXAMPLES)

_MavlinkOption = Annotated[
    list[str] | None,
    typer.Option(
        "--mavlink",
        metavar="DEVICE",
        help="A link, and again for more: udpout:HOST:PORT[:OWN_PORT], udpin:HOST:PORT, tcp:HOST:PORT, "
        "tcpin:HOST:PORT or /dev/ttyX,BAUD [default: those of the firmware's own simulator].",
    ),
]
_FirmwareOption = Annotated[str | None, typer.Option("--firmware", metavar="px4|ardupilot", help="[default: px4].")]
_InstanceOption = Annotated[
    int | None, typer.Option("--instance", min=0, max=249, help="Number of the drone; system id - 1 [default: 0].")
]
_SpeedOption = Annotated[
    float, typer.Option("--speed", min=0.0, max=1000.0, help="Simulated seconds a second; 0: as fast as it can.")
]
_InstantOption = Annotated[bool | None, typer.Option("--instant", help="Be ready to arm at once.", show_default=False)]
_CoreOption = Annotated[
    bool | None,
    typer.Option("--core", help="Fly only: no files, logs, plans, calibration or shell.", show_default=False),
]
_DatumOption = Annotated[
    tuple[float, float, float] | None,
    typer.Option("--datum", metavar="LAT LON ALT", help="Origin of the world, degrees and metres."),
]
_WindOption = Annotated[float | None, typer.Option("--wind", metavar="MEAN_M_S", help="Mean wind [default: 0].")]
_TurbulenceOption = Annotated[
    str | None, typer.Option("--turbulence", metavar="SEVERITY", help="none, light, moderate or severe.")
]
_SeedOption = Annotated[int | None, typer.Option("--seed", min=0, help="Of the wind [default: 1].")]
_ConfigOption = Annotated[Path | None, typer.Option("--config", metavar="FILE", help="Configuration in TOML.")]
_PrintConfigOption = Annotated[bool, typer.Option("--print-config", help="Print the configuration and end.")]


@app.command()
def sim_autopilot(
    *,
    mavlink: _MavlinkOption = None,
    firmware: _FirmwareOption = None,
    instance: _InstanceOption = None,
    speed: _SpeedOption = 1.0,
    instant: _InstantOption = None,
    core: _CoreOption = None,
    datum: _DatumOption = None,
    wind: _WindOption = None,
    turbulence: _TurbulenceOption = None,
    seed: _SeedOption = None,
    config: _ConfigOption = None,
    changes: SetOption = None,
    print_config: _PrintConfigOption = False,
    names: NameArguments,
    endpoints: ZenohArguments,
) -> int:
    """Simulate a quadrotor under an autopilot that speaks MAVLink."""
    from link.program.settings import SIM_AUTOPILOT, load_settings
    from link.program.toml_config import dump_toml
    from sim_autopilot.runtime.build import autopilot_config, with_default_links
    from sim_autopilot.runtime.config import SimAutopilotConfig

    given = _given(firmware=firmware, instance=instance, instant=instant, core=core, seed=seed)
    if mavlink:
        given["links"] = [{"device": device} for device in mavlink]
    given |= {"wind": _given(mean_m_s=wind, turbulence=turbulence), "datum": _datum(datum)}
    settings = with_default_links(load_settings(config, SimAutopilotConfig, SIM_AUTOPILOT, changes, given))
    autopilot = autopilot_config(settings)
    if print_config:
        sys.stdout.write(dump_toml(settings))
        return EXIT_OK
    from sim_autopilot.runtime.run import RunOptions, run

    devices = tuple(link.device for link in settings.links)
    options = RunOptions(devices=devices, speed=speed, keys=names.keys(), zenoh=endpoints.options())
    signal.signal(signal.SIGTERM, interrupt)  # until the loop has its own, it ends as on Ctrl-C
    run(settings, autopilot, options)
    return EXIT_OK


def _given(**options: Any) -> dict[str, Any]:
    """What was given on the command line, which goes over the file."""
    return {name: value for name, value in options.items() if value is not None}


def _datum(datum: tuple[float, float, float] | None) -> dict[str, float]:
    if datum is None:
        return {}
    return dict(zip(("latitude_deg", "longitude_deg", "altitude_m"), datum, strict=True))
