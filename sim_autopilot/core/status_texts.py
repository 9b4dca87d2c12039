"""What the autopilot says in words: STATUSTEXT, the events behind it, and a firmware's texts for what happens."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Mode

_TEXT_BYTES = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class Text:
    """What a STATUSTEXT says."""

    severity: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EventCode:
    """An EVENT: its name, its log levels (internal in the upper four bits) and its packed arguments.

    `said` is what ground stations get as a text: empty is nothing, None what it says itself.
    """

    name: str
    levels: int
    arguments: bytes = b""
    said: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class FailsafeTexts:
    """What is said of a failsafe: by the level that the battery has come to (1 is low), and that one has begun."""

    battery: Mapping[int, str] = field(default_factory=dict)
    entered: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Texts:
    """What is said when.

    Attributes:
        everybody: whether they go to whoever speaks, or only to ground stations.
        severity: of refusals.
        boot: (seconds since boot, text) of the start-up.
        not_ready: (until so many seconds since boot, text) of an arming refused.
        unarmable: the mode's name goes in for `{}`.
        no_setpoints: arming in OFFBOARD without setpoints.
        disarm_refused: in the air; None says nothing.
        neither_arms_nor_disarms: to the command with another number, which goes in for `{}`; None refuses it instead.
        armed, disarmed: None says nothing.
        failsafes: empty says nothing.
        obeyed: to the command that asks for a mode.
        high_enough: a take-off to where the drone is already, or lower.
        no_such_mode: the number goes in for `{}`; empty says nothing.
        no_mission: MISSION_START without a mission; None says nothing.
    """

    everybody: bool
    severity: int
    boot: tuple[tuple[float, Text], ...]
    not_ready: tuple[tuple[float, str], ...]
    unarmable: str
    no_setpoints: str
    disarm_refused: str | None
    neither_arms_nor_disarms: str | None
    armed: Text | None
    disarmed: Text | None
    failsafes: FailsafeTexts = field(default_factory=FailsafeTexts)
    obeyed: Mapping[Mode, str] = field(default_factory=dict)
    high_enough: str | None = None
    no_such_mode: str = ""
    no_mission: str | None = None


def status_text(severity: int, text: str) -> Message:
    """Return a STATUSTEXT; what is longer than 50 bytes is cut off."""
    return mavlink.MAVLink_statustext_message(severity, text.encode()[:_TEXT_BYTES])


def status_texts(severity: int, text: str, number: int) -> tuple[Message, ...]:
    """Return the STATUSTEXTs of a text; a long one comes in pieces that `number`, not 0, holds together."""
    encoded = text.encode()
    if len(encoded) <= _TEXT_BYTES:
        return (status_text(severity, text),)
    pieces = range(0, len(encoded), _TEXT_BYTES)
    return tuple(
        mavlink.MAVLink_statustext_message(severity, encoded[begin : begin + _TEXT_BYTES], number, place)
        for place, begin in enumerate(pieces)
    )
