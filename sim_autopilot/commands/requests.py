"""Commands as they travel: what COMMAND_LONG and COMMAND_INT ask for, and what an answer consists of."""

from math import isfinite, nan

from msgspec import Struct

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.memory import AutopilotMemory

ACCEPTED = int(mavlink.MAV_RESULT_ACCEPTED)
DENIED = int(mavlink.MAV_RESULT_DENIED)
UNSUPPORTED = int(mavlink.MAV_RESULT_UNSUPPORTED)
_NOWHERE = frozenset({2**31 - 1, -(2**31)})
"""What stands for no place in the integers of a COMMAND_INT: the largest, and what a client makes of no number."""


class Request(Struct, frozen=True, kw_only=True):
    """A command, who sent it, and its seven parameters; one that is not finite counts as not given."""

    command: int
    parameters: tuple[float, ...]
    system: int
    component: int
    frame: int = int(mavlink.MAV_FRAME_GLOBAL)
    scale: float = 1.0

    @property
    def place(self) -> tuple[float, float, float]:
        """Parameters 5 to 7 as latitude and longitude in degrees, and altitude."""
        x, y, z = self.parameters[4:]
        known = _NOWHERE.isdisjoint({x, y})
        return (x * self.scale, y * self.scale, z) if known else (nan, nan, z)

    def number(self, position: int) -> int | None:
        """Return parameter `position` (1 to 7) as a whole number, None where it is not finite."""
        value = self.parameters[position - 1]
        return round(value) if isfinite(value) else None


class Answer(Struct, frozen=True, kw_only=True):
    """What a command leads to: the result, None for no answer at all, and what is sent besides the acknowledgement."""

    memory: AutopilotMemory
    result: int | None
    messages: tuple[Message, ...] = ()
    text: str | None = None


def request_from_message(message: Message) -> Request:
    """Return what a COMMAND_LONG or COMMAND_INT asks."""
    whole = message.get_type() == "COMMAND_INT"
    last = (message.x, message.y, message.z) if whole else _long_tail(message)
    return Request(
        command=message.command,
        parameters=(message.param1, message.param2, message.param3, message.param4, *last),
        system=message.get_srcSystem(),
        component=message.get_srcComponent(),
        frame=message.frame if whole else int(mavlink.MAV_FRAME_GLOBAL),
        scale=1e-7 if whole else 1.0,
    )


def acknowledgement(request: Request, result: int, progress: int = 0) -> Message:
    """Return the COMMAND_ACK of a command."""
    return mavlink.MAVLink_command_ack_message(
        request.command, result, progress, 0, target_system=request.system, target_component=request.component
    )


def _long_tail(message: Message) -> tuple[float, float, float]:
    return (message.param5, message.param6, message.param7)
