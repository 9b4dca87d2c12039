"""Bytes in and out of the process: one transport for each kind of device string.

Once open, a transport never raises for what the other end or the network does; it counts.
"""

from link.mavlink.device import SerialDevice, parse_device
from link.mavlink.serial_transport import SerialTransport
from link.mavlink.tcp_transport import TcpClientTransport, TcpServerTransport
from link.mavlink.transport import Transport
from link.mavlink.udp_transport import UdpBoundTransport, UdpInTransport, UdpOutTransport

__all__ = ["Transport", "open_transport"]


def open_transport(device: str) -> Transport:
    """Opens a device.

    Args:
        device: `udpin:HOST:PORT`, `udpout:HOST:PORT`, `udpout:HOST:PORT:OWN_PORT`, `tcp:HOST:PORT`, `tcpin:HOST:PORT`
            or `/dev/ttyX,BAUD`.

    Returns:
        The open transport; a TCP client may not be connected yet, and goes on trying.

    Raises:
        UserError: The form is wrong, the host unknown, the port in use, or the device missing.
    """
    parsed = parse_device(device)
    if isinstance(parsed, SerialDevice):
        return SerialTransport(parsed)
    if parsed.own_port is not None:
        return UdpBoundTransport(parsed)
    return _NETWORK_TRANSPORTS[parsed.kind](parsed)


_NETWORK_TRANSPORTS: dict[str, type[UdpInTransport | UdpOutTransport | TcpClientTransport | TcpServerTransport]] = {
    "udpin": UdpInTransport,
    "udpout": UdpOutTransport,
    "tcp": TcpClientTransport,
    "tcpin": TcpServerTransport,
}
