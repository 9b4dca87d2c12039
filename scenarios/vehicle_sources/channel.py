"""From what the user wrote to an open transport: gpsd's address, a serial port, a TCP server, a recorded file."""

from collections.abc import Callable
from pathlib import Path

from link.errors import UserError
from link.transports.device import MAVLINK_PORT, NetworkDevice, parse_device
from link.transports.opening import open_transport
from link.transports.transport import Transport

GPSD_PORT = 2947  # registered
_NMEA_PORT = 10110  # registered
_NMEA_BAUD = 9600  # receivers' most frequent setting; NMEA 0183's own is 4800
_CHUNK_BYTES = 4096

OpenTransport = Callable[[], Transport]


class FileTransport(Transport):
    """A recording that is read from its beginning to its end.

    Args:
        path: of the file.

    Raises:
        UserError: it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        try:
            self._file = path.open("rb")
        except OSError as error:
            raise UserError(f"--nmea {path}: cannot be read ({error.strerror})") from None
        self.is_at_end = False

    def receive(self, timeout_s: float) -> bytes:  # noqa: ARG002 (a file has no time)
        """Return the next bytes, empty at the end."""
        data = self._file.read(_CHUNK_BYTES)
        self.is_at_end = not data
        return data

    def send(self, data: bytes) -> None:
        """Do nothing: nobody listens."""

    def fileno(self) -> int:
        """Return the file's descriptor."""
        return -1 if self._file.closed else self._file.fileno()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def gpsd_address(text: str) -> tuple[NetworkDevice, str | None]:
    """Return address and receiver of `HOST[:PORT[:DEVICE]]`, as gpsd's own clients take it.

    Raises:
        UserError: it is none.
    """
    host, _, rest = text.partition(":")
    port, _, device = rest.partition(":")
    if (
        not host
        or "/" in host
        or not (port or str(GPSD_PORT)).isdigit()
        or int(port or GPSD_PORT) not in range(1, 65536)
    ):
        raise UserError(f"--gpsd {text!r} is no address: write HOST:PORT, such as 127.0.0.1:{GPSD_PORT}")
    return NetworkDevice(kind="tcp", host=host, port=int(port or GPSD_PORT)), device or None


def nmea_opener(text: str) -> OpenTransport:
    """Return what opens `/dev/ttyX[,BAUD]`, `tcp://HOST:PORT`, a device as of `--mavlink`, or a file.

    Raises:
        UserError: there is no such file.
    """
    if text.startswith("tcp://"):
        return device_opener("tcp:" + text.removeprefix("tcp://"), _NMEA_PORT)
    path = Path(text)
    if text.startswith("/dev/") or "," in text or (path.exists() and path.is_char_device()):
        return device_opener(text if "," in text else f"{text},{_NMEA_BAUD}")
    if path.exists():
        return lambda: FileTransport(path)
    if ":" in text:
        return device_opener(text, _NMEA_PORT)
    raise UserError(f"--nmea {text!r}: there is no such file; write /dev/ttyX,BAUD, tcp://HOST:PORT or a file's name")


def device_opener(text: str, usual_port: int = MAVLINK_PORT) -> OpenTransport:
    """Return what opens a device as of `--mavlink`.

    Args:
        text: as the user wrote it.
        usual_port: of what is spoken there, named in hints only.

    Raises:
        UserError: it has no known form.
    """
    device = str(parse_device(text, usual_port))
    return lambda: open_transport(device)
