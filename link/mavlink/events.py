"""What a MAVLink session tells its owner; `t_ns` is always the local time at which it became known."""

from typing import TypeAlias

from msgspec import Struct

from link.mavlink.dialect import Message


class MessageReceived(Struct, frozen=True, eq=False):
    """A message of the autopilot, for us or for everybody."""

    message: Message
    t_ns: int


class LinkFound(Struct, frozen=True, kw_only=True):
    """The first heartbeat of the autopilot; `autopilot` and `vehicle_type` are MAV_AUTOPILOT and MAV_TYPE."""

    t_ns: int
    system_id: int
    component_id: int
    autopilot: int
    vehicle_type: int


class LinkLost(Struct, frozen=True, kw_only=True):
    """Nothing was heard of the autopilot since `last_heard_ns`."""

    t_ns: int
    last_heard_ns: int


class LinkRegained(Struct, frozen=True, kw_only=True):
    """The autopilot is heard again after a silence."""

    t_ns: int
    silence_ns: int


class AutopilotRestarted(Struct, frozen=True, kw_only=True):
    """The autopilot's time since boot fell back; what it was told before is forgotten there."""

    t_ns: int
    boot_before_ns: int
    boot_now_ns: int


class CommandAcknowledged(Struct, frozen=True, kw_only=True):
    """An acknowledgement, every one of them: PX4 sends ACCEPTED first and the real answer after it.

    Attributes:
        command: MAV_CMD.
        result: MAV_RESULT.
        ticket: what `command` returned; None when we have not sent this command.
        is_repeat: the command had already been answered, or doubled on its way.
    """

    t_ns: int
    command: int
    result: int
    ticket: int | None
    is_repeat: bool


class CommandTimedOut(Struct, frozen=True, kw_only=True):
    """A command was not answered, or not finished, in time, or the autopilot restarted meanwhile."""

    t_ns: int
    command: int
    ticket: int
    attempts: int


class ParameterRead(Struct, frozen=True, kw_only=True):
    """A parameter that was asked for; an int for the integer types."""

    t_ns: int
    name: str
    value: int | float


class ParameterMissing(Struct, frozen=True, kw_only=True):
    """A parameter was asked for in vain: unknown to the autopilot (which does not say so), or the link is bad."""

    t_ns: int
    name: str


Event: TypeAlias = (
    MessageReceived
    | LinkFound
    | LinkLost
    | LinkRegained
    | AutopilotRestarted
    | CommandAcknowledged
    | CommandTimedOut
    | ParameterRead
    | ParameterMissing
)
