"""How a program meets others over Zenoh, and the checks that turn a mistyped endpoint into one clear line."""

import re
from dataclasses import dataclass
from pathlib import Path

from link.errors import UserError
from link.transports.device import is_this_machine

DEFAULT_ENDPOINT = "tcp/127.0.0.1:7447"

MODES = ("peer", "client", "router")

_INTERNET_PROTOCOLS = ("tcp", "udp", "tls", "quic", "ws")
_OTHER_PROTOCOLS = ("serial", "unixsock-stream", "unixpipe", "vsock")
_INTERNET_ADDRESS = re.compile(r"(?P<host>\[[0-9A-Fa-f:.%\w]+\]|[^\s:/\[\]]+):(?P<port>[0-9]{1,5})(?P<rest>[?#].*)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohOptions:
    """What a user may say about the Zenoh session.

    Attributes:
        mode: `peer`, `client` or `router`; None is the configuration file's, else peer.
        connect: endpoints to connect to, tried again for ever.
        listen: endpoints to listen on; empty is the configuration file's; without a file a free port on loopback.
        multicast_scouting: whether to look for others by multicast; None is the file's, else no.
        config_file: a Zenoh configuration in JSON5, for what has no option here (TLS, access control).
        insecure: whether strangers on a network may reach the session.
        message_max_bytes: of a message that is put together of fragments, where the configuration file says nothing;
            most of ours are a hundredth of the default, pictures are larger. A router passes on what others need.

    Raises:
        UserError: If the mode or an endpoint is not one.
    """

    mode: str | None = None
    connect: tuple[str, ...] = ()
    listen: tuple[str, ...] = ()
    multicast_scouting: bool | None = None
    config_file: Path | None = None
    insecure: bool = False
    message_max_bytes: int = 1 << 20

    def __post_init__(self) -> None:
        """Check the mode and the endpoints."""
        if self.mode is not None and self.mode not in MODES:
            raise UserError(f"--mode {self.mode!r} does not exist: choose {', '.join(MODES)}")
        for endpoint in self.connect:
            check_endpoint("--connect", endpoint, port_min=1)
        for endpoint in self.listen:
            check_endpoint("--listen", endpoint, port_min=0)


def check_endpoint(option: str, endpoint: str, *, port_min: int) -> None:
    """Find out whether what a user wrote is an endpoint.

    Args:
        option: by which it was given.
        endpoint: such as `tls/192.168.4.1:7447`.
        port_min: the least port; 0 is any free one.

    Raises:
        UserError: it is none.
    """
    protocol, slash, address = endpoint.partition("/")
    if protocol in _OTHER_PROTOCOLS and address:
        return
    if not slash or protocol not in _INTERNET_PROTOCOLS:
        raise UserError(f"{option} {endpoint!r} is no endpoint: write it as {_meant(endpoint)}")
    match = _INTERNET_ADDRESS.fullmatch(address)
    if match is None or not port_min <= int(match["port"]) <= 65535:
        raise UserError(
            f"{option} {endpoint!r} needs a host and a port from {port_min} to 65535: write it as {_meant(endpoint)}"
        )


def _meant(endpoint: str) -> str:
    """Return an endpoint with the host that was written, if that is one; beyond this machine it takes certificates."""
    found = re.fullmatch(r"(?:[a-z]+[/:])?/*(?P<host>[\w.-]+)(?::(?P<port>[0-9]{1,5}))?", endpoint)
    if found is None or is_this_machine(found["host"]):
        return DEFAULT_ENDPOINT
    port = found["port"] if found["port"] and int(found["port"]) <= 65535 else DEFAULT_ENDPOINT.rpartition(":")[2]
    return f"tls/{found['host']}:{port}"
