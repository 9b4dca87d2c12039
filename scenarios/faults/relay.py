"""The autopilot's link over the wire, through a relay that sees what goes both ways."""

from types import TracebackType
from typing import Self

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.transports.opening import open_transport
from scenarios.config import FirmwareName
from scenarios.processes.programs import free_udp_port

_WAIT_S = 0.004
_FOLLOWING: dict[FirmwareName, int] = {"px4": 6 << 16, "ardupilot": 4}  # custom modes: OFFBOARD, GUIDED


class Relay:
    """Two UDP ports of loopback and what is passed on between them; use as a context manager.

    Args:
        firmware: of the autopilot.

    Attributes:
        setpoints: of the companion, that were passed on.
        follows_setpoints: whether the autopilot's newest heartbeat has the mode in which it flies setpoints.
    """

    def __init__(self, firmware: FirmwareName) -> None:
        world, companion = free_udp_port(), free_udp_port()
        self.world_device, self.companion_device = f"udpout:127.0.0.1:{world}", f"udpin:127.0.0.1:{companion}"
        self._to_world = open_transport(f"udpin:127.0.0.1:{world}")
        self._to_companion = open_transport(f"udpout:127.0.0.1:{companion}")
        self._up, self._down = MavlinkCodec(255, 1), MavlinkCodec(255, 2)
        self._following = _FOLLOWING[firmware]
        self.setpoints = 0
        self.follows_setpoints = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._to_world.close()
        self._to_companion.close()

    def turn(self) -> None:
        """Wait a little, and pass on what has come."""
        for _, data in self._to_world.receive_by_peer(_WAIT_S):
            self._to_companion.send(data)
            for message in self._down.decode(data, is_datagram=True):
                if message.get_msgId() == mavlink.MAVLINK_MSG_ID_HEARTBEAT and message.get_srcComponent() == 1:
                    self.follows_setpoints = message.custom_mode == self._following
        for _, data in self._to_companion.receive_by_peer(0.0):
            self._to_world.send(data)
            setpoint = mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED
            self.setpoints += sum(one.get_msgId() == setpoint for one in self._up.decode(data, is_datagram=True))
