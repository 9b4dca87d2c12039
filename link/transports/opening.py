"""Bytes in and out of the process: one transport for each kind of device string.

Once open, a transport never raises for what the other end or the network does; it counts.
"""

from link.transports.device import SerialDevice, parse_device
from link.transports.serial_transport import SerialTransport
from link.transports.tcp_transport import TcpClientTransport, TcpServerTransport
from link.transports.transport import Transport
from link.transports.udp_transport import UdpBoundTransport, UdpInTransport, UdpOutTransport

__all__ = ["Transport", "open_transport"]


def open_transport(device: str, *, is_patient: bool = False) -> Transport:
    """Opens a device.

    Args:
        device: `udpin:HOST:PORT`, `udpout:HOST:PORT`, `udpout:HOST:PORT:OWN_PORT`, `tcp:HOST:PORT`, `tcpin:HOST:PORT`
            or `/dev/ttyX,BAUD`.
        is_patient: stay connected over TCP to who does not read for a while. For telemetry, which may come late:
            a setpoint or command must not.

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
    if parsed.kind in _TCP_TRANSPORTS:
        return _TCP_TRANSPORTS[parsed.kind](parsed, is_patient=is_patient)
    return _UDP_TRANSPORTS[parsed.kind](parsed)


_UDP_TRANSPORTS: dict[str, type[UdpInTransport | UdpOutTransport]] = {
    "udpin": UdpInTransport,
    "udpout": UdpOutTransport,
}
_TCP_TRANSPORTS: dict[str, type[TcpClientTransport | TcpServerTransport]] = {
    "tcp": TcpClientTransport,
    "tcpin": TcpServerTransport,
}
