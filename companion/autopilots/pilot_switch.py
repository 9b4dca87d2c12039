"""The switch on the pilot's transmitter that starts, holds and breaks off a landing, read from RC_CHANNELS.

Only a change of its position commands anything. A position counts once it has been seen for `_SETTLE_NS`. The first one
commands nothing, and after silence none starts: a switch that was left on, or is on when the receiver comes back, does
not. Both autopilots repeat the last pulses, or send none, while the transmitter is not heard; neither is a change.

Source: MAVLink common, message 65; ArduPilot's RC_Channel, whose switches settle for 200 ms; PX4's RC_CHANNELS.hpp.
"""

from enum import Enum

from msgspec import Struct

from companion.config.autopilot import PilotSwitchConfig
from link.mavlink.dialect import Message, mavlink
from link.messages import Command
from link.records import replace

_RATE_HZ = 10.0
_SETTLE_NS = 200_000_000
_SILENT_NS = 1_000_000_000
_PULSE_MIN_US, _PULSE_MAX_US = 800, 2200  # beyond them no receiver sends; 0 and 65535 say that there is no channel


class Position(Enum):
    """Of the switch; its value is what a change to it commands."""

    LOW = Command.ABORT
    MIDDLE = Command.HOLD
    HIGH = Command.START


class SwitchMemory(Struct, frozen=True, kw_only=True):
    """What has been seen of the switch.

    Attributes:
        position: that has settled last.
        seen: in the newest message.
        seen_since_ns: on the companion's own clock.
        heard_ns: when that message came.
        was_silent: before it, and no position has settled since.
    """

    position: Position | None = None
    seen: Position | None = None
    seen_since_ns: int = 0
    heard_ns: int | None = None
    was_silent: bool = False


def update_switch(
    memory: SwitchMemory, message: Message, local_ns: int, config: PilotSwitchConfig
) -> tuple[SwitchMemory, Command | None]:
    """Return the memory after an RC_CHANNELS, and what the switch commands by it.

    Args:
        memory: of the message before.
        message: of the autopilot.
        local_ns: when it came.
        config: which channel it is, and its thresholds.
    """
    seen = _position(message, config)
    if seen is None:
        return memory, None
    if memory.heard_ns is not None and local_ns - memory.heard_ns > _SILENT_NS:
        memory = replace(memory, seen=None, was_silent=True)
    memory = replace(memory, heard_ns=local_ns)
    if seen is not memory.seen:
        return replace(memory, seen=seen, seen_since_ns=local_ns), None
    if local_ns - memory.seen_since_ns < _SETTLE_NS:
        return memory, None
    settled = replace(memory, position=seen, was_silent=False)
    is_change = memory.position not in (None, seen)
    starts_by_itself = memory.was_silent and seen is Position.HIGH
    return settled, seen.value if is_change and not starts_by_itself else None


def _position(message: Message, config: PilotSwitchConfig) -> Position | None:
    """Return where the switch is, None where the message does not tell it."""
    pulse_us: int = getattr(message, f"chan{config.channel}_raw", 0)
    if not _PULSE_MIN_US <= pulse_us <= _PULSE_MAX_US:
        return None
    if pulse_us > config.start_above_us:
        return Position.HIGH
    return Position.LOW if pulse_us < config.abort_below_us else Position.MIDDLE


class PilotSwitch:
    """The switch of one transmitter.

    Args:
        config: without a channel nothing is heard.
    """

    def __init__(self, config: PilotSwitchConfig) -> None:
        self._config = config
        self._memory = SwitchMemory()
        self._command: Command | None = None

    @property
    def streams_hz(self) -> dict[int, float]:
        """Messages that it needs, by id."""
        return {} if self._config.channel is None else {mavlink.MAVLINK_MSG_ID_RC_CHANNELS: _RATE_HZ}

    def hear(self, message: Message, local_ns: int) -> None:
        """Take an RC_CHANNELS of the autopilot."""
        if self._config.channel is not None:
            self._memory, command = update_switch(self._memory, message, local_ns, self._config)
            self._command = command or self._command

    def take(self) -> Command | None:
        """Return what the switch has commanded, once; the newest counts."""
        taken, self._command = self._command, None
        return taken

    def forget(self) -> None:
        """Take the next position for the first one: the autopilot has started anew."""
        self._memory = SwitchMemory()
