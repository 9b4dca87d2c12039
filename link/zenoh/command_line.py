"""The options of every program that meets others over Zenoh: who is who, and how they are met."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from link.program.option_groups import OptionGroup
from link.zenoh.keys import Keys
from link.zenoh.options import DEFAULT_ENDPOINT, ZenohOptions

_PANEL = "Zenoh"

NamespaceOption = Annotated[str, typer.Option("--ns", metavar="NAME", help="Namespace of all Zenoh keys.")]
DroneOption = Annotated[str, typer.Option("--drone", metavar="ID", help="Name of the drone.")]
_VehicleOption = Annotated[str, typer.Option("--vehicle", metavar="ID", help="Name of the ground vehicle.")]

_ModeOption = Annotated[
    str | None,
    typer.Option(
        "-m", "--mode", metavar="MODE", help="peer, client or router [default: peer].", rich_help_panel=_PANEL
    ),
]
_ConnectOption = Annotated[
    list[str] | None,
    typer.Option(
        "-e",
        "--connect",
        metavar="ENDPOINT",
        help="Endpoint to connect to, such as tls/192.168.1.5:7447. May be repeated.",
        rich_help_panel=_PANEL,
    ),
]
_ListenOption = Annotated[
    list[str] | None,
    typer.Option(
        "-l",
        "--listen",
        metavar="ENDPOINT",
        help="Endpoint to listen on, such as tls/0.0.0.0:7447. May be repeated.",
        rich_help_panel=_PANEL,
    ),
]
_MulticastOption = Annotated[
    bool | None,
    typer.Option(
        "--multicast-scouting/--no-multicast-scouting",
        help="Look for others by multicast, or not [default: not].",
        show_default=False,
        rich_help_panel=_PANEL,
    ),
]
_ZenohConfigOption = Annotated[
    Path | None,
    typer.Option(
        "--zenoh-config",
        metavar="FILE",
        help="Zenoh configuration (JSON5), for TLS and access control.",
        rich_help_panel=_PANEL,
    ),
]
_InsecureOption = Annotated[
    bool,
    typer.Option(
        "--insecure",
        help="Meet others beyond this machine without certificates: anybody on that network can give orders.",
        rich_help_panel=_PANEL,
    ),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class NameArguments(OptionGroup):
    """Who is who on Zenoh."""

    namespace: NamespaceOption = "decklander"
    vehicle: _VehicleOption = "vehicle"
    drone: DroneOption = "drone"

    def keys(self) -> Keys:
        """Return the keys of these names.

        Raises:
            UserError: one of them is no name.
        """
        return Keys(self.namespace, self.vehicle, self.drone)


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohArguments(OptionGroup):
    """How others are met over Zenoh."""

    mode: _ModeOption = None
    connect: _ConnectOption = None
    listen: _ListenOption = None
    multicast: _MulticastOption = None
    zenoh_config: _ZenohConfigOption = None
    insecure: _InsecureOption = False

    @property
    def are_given(self) -> bool:
        """Whether they say where others are, so that silence is a fault."""
        return bool(self.connect or self.listen or self.zenoh_config or self.multicast)

    def options(self, *, listens: bool = False) -> ZenohOptions:
        """Return what they say; nothing connects to the default endpoint.

        With `listens` it waits there for the others instead, unless it is a client, which cannot.

        Raises:
            UserError: the mode or an endpoint is not one.
        """
        connect, listen = tuple(self.connect or ()), tuple(self.listen or ())
        if not self.are_given:
            here = () if self.mode == "client" else (DEFAULT_ENDPOINT,)
            connect, listen = ((), here) if listens else ((DEFAULT_ENDPOINT,), ())
        return ZenohOptions(
            mode=self.mode,
            connect=connect,
            listen=listen,
            multicast_scouting=self.multicast,
            config_file=self.zenoh_config,
            insecure=self.insecure,
        )
