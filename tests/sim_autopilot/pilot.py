"""A companion for tests: it talks to the autopilot in MAVLink bytes only."""

from collections.abc import Callable, Iterable
from math import nan, radians

import numpy as np

from link.frames.geodesy import Datum
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.data import Array, Deck
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.ground_station.px4.station import PX4_STATION
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.runtime.node import AutopilotNode

START_NS = 1_795_000_000_000_000_000
DATUM = Datum(latitude_rad=radians(52.4733), longitude_rad=radians(13.4017), altitude_m=89.0)
STILL_AIR = np.zeros(3)

OFFBOARD = 0x00060000
HOLD = 0x03040000
LAND = 0x06040000
RTL = 0x05040000
TAKEOFF = 0x02040000
POSITION = 0x00030000

POSITION_ONLY = 0b1001_1111_1000
POSITION_VELOCITY = 0b1001_1100_0000
VELOCITY_ONLY = 0b1001_1100_0111


PLUGGED_IN = {"firmware": PX4, "services": PX4_STATION, "datum": DATUM, "instant": True}


def px4(**changes: object) -> AutopilotConfig:
    """The autopilot that the tests fly, ready at once."""
    return AutopilotConfig(**(PLUGGED_IN | changes))  # type: ignore[arg-type]  # of any field


def command(number: int, *parameters: float, system: int = 1, component: int = 1) -> Message:
    """A COMMAND_LONG."""
    seven = (*parameters, *(0.0,) * (7 - len(parameters)))
    return mavlink.MAVLink_command_long_message(system, component, number, 0, *seven)


def set_mode(main: int, sub: int = 0) -> Message:
    """A DO_SET_MODE."""
    return command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, float(main), float(sub))


def arm(*, armed: bool = True, force: bool = False) -> Message:
    """An arming or disarming command."""
    return command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, float(armed), 21196.0 if force else 0.0)


def setpoint(
    position: Iterable[float] = (nan, nan, nan),
    velocity: Iterable[float] = (0.0, 0.0, 0.0),
    *,
    mask: int = POSITION_ONLY,
    frame: int = mavlink.MAV_FRAME_LOCAL_NED,
    yaw: float = 0.0,
    system: int = 1,
) -> Message:
    """A SET_POSITION_TARGET_LOCAL_NED, in NED."""
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, system, 1, frame, mask, *position, *velocity, 0.0, 0.0, 0.0, yaw, 0.0
    )


class Pilot:
    """A companion, and the autopilot that it talks to."""

    def __init__(self, config: AutopilotConfig | None = None, deck: Callable[[int], Deck] | None = None) -> None:
        self.node = AutopilotNode(config or px4(), START_NS)
        self.received: list[tuple[float, Message]] = []
        self._deck = deck
        self._codec = MavlinkCodec(1, 191)

    @property
    def t_s(self) -> float:
        """Seconds since boot."""
        return (self.node.state.t_ns - START_NS) * 1e-9

    @property
    def position(self) -> Array:
        """(3,) true, ENU."""
        return self.node.state.position_enu_m

    def is_armed(self) -> bool:
        """Whether the motors are on."""
        return self.node.memory.armed_ns is not None

    def step(self, *messages: Message) -> list[Message]:
        """Send `messages`, advance by 10 ms, and return what comes back."""
        data = b"".join(map(self._codec.encode, messages))
        t_ns = self.node.state.t_ns
        deck = None if self._deck is None else self._deck(t_ns)
        replies = self._codec.decode(b"".join(self.node.receive(data, t_ns) + self.node.step(deck, STILL_AIR)))
        self.received += [(self.t_s, reply) for reply in replies]
        return replies

    def run(self, duration_s: float, stream: Callable[[float], Message] | None = None) -> None:
        """Fly on, with `stream(t_s)` sent at 50 Hz."""
        for tick in range(round(duration_s * 100)):
            self.step(*([stream(self.t_s)] if stream is not None and tick % 2 == 0 else []))

    def run_until(
        self, done: Callable[[], bool], limit_s: float, stream: Callable[[float], Message] | None = None
    ) -> float:
        """Fly on until `done()` and return how long that took."""
        began_s = self.t_s
        while not done():
            assert self.t_s - began_s < limit_s, f"not done within {limit_s} s"
            self.run(0.02, stream)
        return self.t_s - began_s

    def acknowledged(self, *messages: Message) -> list[int]:
        """Send a command and return the results that come within 50 ms."""
        replies = self.step(*messages)
        for _ in range(4):
            replies += self.step()
        return [reply.result for reply in replies if reply.get_type() == "COMMAND_ACK"]

    def last(self, name: str) -> Message:
        """The newest message of that name."""
        return next(message for _, message in reversed(self.received) if message.get_type() == name)

    def all(self, name: str) -> list[Message]:
        """Every message of that name."""
        return [message for _, message in self.received if message.get_type() == name]

    def custom_mode(self) -> int:
        """The mode that the next heartbeat tells."""
        config = PX4.modes.codes[self.node.memory.modes.mode]
        return config.custom_mode

    def take_off(self, height_m: float = 5.0) -> None:
        """Fly by setpoints to `height_m` above the origin, and hover there."""

        def hover(_t_s: float) -> Message:
            return setpoint((0.0, 0.0, -height_m))

        self.run(0.5, hover)
        self.step(set_mode(6), arm())
        self.run_until(lambda: self.position[2] > height_m - 0.1, 20.0, hover)
        self.run(1.0, hover)
