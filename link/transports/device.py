"""Device strings, in pymavlink's forms, taken apart and checked; which hosts are this machine."""

import difflib
import ipaddress
import re
from dataclasses import dataclass

from link.errors import UserError


def is_this_machine(host: str) -> bool:
    """Return whether `host`, a name or an address without brackets, is loopback."""
    try:
        return ipaddress.ip_address(host.partition("%")[0]).is_loopback
    except ValueError:
        return host == "localhost"


FORMS = "udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT or /dev/ttyX,BAUD"
_NETWORK = re.compile(
    r"(?P<kind>[a-z]+):(?P<host>\[[^]]+]|[^:]*):(?P<port>[^:]*)(:(?P<own_port>[^:]*))?", re.IGNORECASE
)
_LISTENERS = ("udpin", "tcpin")
_KINDS = (*_LISTENERS, "udpout", "tcp")
_PORT_MAX = 65535
MAVLINK_PORT = 14540
"""PX4's, for a companion."""
_BAUD_DEFAULT = 57600  # the usual telemetry radio's, named in hints only
_BAUD_MAX = 12_000_000
_OTHER_NAMES = {"udp": "udpin", "udpserver": "udpin", "udpclient": "udpout", "tcpout": "tcp", "tcpclient": "tcp"}


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkDevice:
    """A socket: `kind` is one of udpin, udpout, tcp, tcpin.

    A udpout with `own_port` sends from that port and also hears and answers others who speak to it.
    """

    kind: str
    host: str
    port: int
    own_port: int | None = None

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        own_port = "" if self.own_port is None else f":{self.own_port}"
        return f"{self.kind}:{host}:{self.port}{own_port}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SerialDevice:
    """A serial port."""

    path: str
    baud: int

    def __str__(self) -> str:
        return f"{self.path},{self.baud}"


def parse_device(device: str, usual_port: int = MAVLINK_PORT) -> NetworkDevice | SerialDevice:
    """Takes a device string apart.

    Args:
        device: in one of `FORMS`; a listener's port may be 0, for one that the system chooses.
        usual_port: of what is spoken there, named in hints only.

    Returns:
        Its parts.

    Raises:
        UserError: It has none of these forms, or a port or baud rate that cannot be.
    """
    if device.startswith("/"):
        return _serial(device)
    match = _NETWORK.fullmatch(device)
    if match is None:
        raise UserError(f"device {device!r} has no known form; {_hint(device, usual_port)}")
    kind, host = match["kind"].lower(), match["host"].strip("[]")
    if kind not in _KINDS or not host:
        raise UserError(f"device {device!r} has no known form; {_hint(device, usual_port)}")
    own_port = match["own_port"]
    if own_port is not None and kind != "udpout":
        raise UserError(f"device {device!r} has no known form; only udpout takes a port of its own")
    return NetworkDevice(
        kind=kind,
        host=host,
        port=_port(device, kind, match["port"]),
        own_port=None if own_port is None else _port(device, "udpin", own_port),
    )


def opening_of(device: str, *, signs: bool) -> str | None:
    """Return by what a stranger could speak as the autopilot, None where only this machine or a cable is there.

    Args:
        device: in one of `FORMS`.
        signs: whether only signed frames are taken.
    """
    parts = parse_device(device)
    if signs or isinstance(parts, SerialDevice) or is_this_machine(parts.host):
        return None
    return f"MAVLink on {parts} is not signed"


def _serial(device: str) -> SerialDevice:
    path, comma, baud = device.partition(",")
    if not comma:
        raise UserError(f"device {device!r} has no baud rate; write {path},{_BAUD_DEFAULT}")
    if not (baud.isascii() and baud.isdigit() and 0 < int(baud) <= _BAUD_MAX):
        raise UserError(f"device {device!r}: {baud!r} is no baud rate; write one such as {path},{_BAUD_DEFAULT}")
    return SerialDevice(path=path, baud=int(baud))


def _port(device: str, kind: str, text: str) -> int:
    port_min = 0 if kind in _LISTENERS else 1
    if text.isascii() and text.isdigit() and port_min <= int(text) <= _PORT_MAX:
        return int(text)
    raise UserError(f"device {device!r}: {text!r} is no port; write a number from {max(port_min, 1)} to {_PORT_MAX}")


def _hint(device: str, usual_port: int) -> str:
    """The valid form that comes nearest."""
    kind, _, rest = device.partition(":")
    kind = kind.lower()
    near = [_OTHER_NAMES[kind]] if kind in _OTHER_NAMES else difflib.get_close_matches(kind, _KINDS, n=1)
    if not near:
        return f"write {FORMS}"
    host, colon, port = rest.rpartition(":")
    if not colon:
        host, port = ("127.0.0.1", rest) if rest.isdigit() else (rest, "")
    if ":" in host and not host.startswith("["):
        return f"an IPv6 address goes into brackets, as in {near[0]}:[::1]:{port or usual_port}"
    meant = f"{near[0]}:{host or '127.0.0.1'}:{port or usual_port}"
    return f"write {FORMS}" if meant == device else f"did you mean {meant}?"
