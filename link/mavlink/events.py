"""What a MAVLink session tells its owner; `t_ns` is always the local time at which it became known."""

from dataclasses import dataclass
from typing import TypeAlias

from link.mavlink.dialect import Message


@dataclass(frozen=True, slots=True, eq=False)
class MessageReceived:
    """A message of the autopilot, for us or for everybody."""

    message: Message
    t_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkFound:
    """The first heartbeat of the autopilot; `autopilot` and `vehicle_type` are MAV_AUTOPILOT and MAV_TYPE."""

    t_ns: int
    system_id: int
    component_id: int
    autopilot: int
    vehicle_type: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkLost:
    """Nothing was heard of the autopilot since `last_heard_ns`."""

    t_ns: int
    last_heard_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkRegained:
    """The autopilot is heard again after a silence."""

    t_ns: int
    silence_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class AutopilotRestarted:
    """The autopilot's time since boot fell back; what it was told before is forgotten there."""

    t_ns: int
    boot_before_ns: int
    boot_now_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandAcknowledged:
    """An acknowledgement, every one of them: PX4 sends ACCEPTED first and the real answer after it.

    Attributes:
        command: MAV_CMD.
        result: MAV_RESULT.
        progress: percent while in progress, 255 when not said.
        result_param2: further detail, by command.
        ticket: what `command` returned; None when we have not sent this command.
        is_repeat: the command had already been answered, or doubled on its way.
    """

    t_ns: int
    command: int
    result: int
    progress: int
    result_param2: int
    ticket: int | None
    is_repeat: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandTimedOut:
    """A command was not answered, or not finished, in time, or the autopilot restarted meanwhile."""

    t_ns: int
    command: int
    ticket: int
    attempts: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRead:
    """A parameter that was asked for; an int for the integer types."""

    t_ns: int
    name: str
    value: int | float


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterMissing:
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
