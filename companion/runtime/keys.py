"""The command `companion keys`: certificates for all who meet over Zenoh, and a key for MAVLink's signatures."""

import secrets
import sys
from pathlib import Path
from typing import Annotated

import typer

from link.mavlink.signing import KEY_BYTES

NAMES = ("vehicle", "companion", "operator", "router")
"""Common names of the certificates, by which docs/zenoh's access control goes."""

MAVLINK_KEY = "mavlink.key"
_DAYS = 365
_FolderArgument = Annotated[Path, typer.Argument(metavar="DIR", help="Where to; what is there already is kept.")]
_HostOption = Annotated[
    list[str] | None,
    typer.Option("--host", metavar="HOST", help="Name or address at which vehicle and router are reached. Repeat it."),
]
_NameOption = Annotated[
    list[str] | None, typer.Option("--name", metavar="NAME", help="Make certificates of these names only. Repeat it.")
]
_DaysOption = Annotated[int, typer.Option("--days", min=1, max=36_500, help="For how long the certificates are valid.")]


def keys(
    folder: _FolderArgument,
    host: _HostOption = None,
    name: _NameOption = None,
    days: _DaysOption = _DAYS,
) -> None:
    """Make a private authority, certificates for vehicle, companion, operator and router, and a MAVLink signing key.

    Give each computer the file ca.pem and its own two files, and nobody ca.key.
    """
    from link.zenoh.certificates import Authority, check_host, write_secret

    for option, given in (("--host", host), ("--name", name)):
        for one in given or ():
            check_host(option, one)
    authority = Authority(folder, days)
    for one in name or NAMES:
        authority.issue(one, ("localhost", "127.0.0.1", *(host or ())))
        sys.stdout.write(f"{folder / one}.pem, {one}.key\n")
    if not (folder / MAVLINK_KEY).exists():
        write_secret(folder / MAVLINK_KEY, f"{secrets.token_hex(KEY_BYTES)}\n".encode())
        sys.stdout.write(f"{folder / MAVLINK_KEY}\n")
