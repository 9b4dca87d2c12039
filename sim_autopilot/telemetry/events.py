"""PX4's events: what is also said as text to ground stations goes to everybody as EVENT.

Source: MAVLink events interface; names, levels and arguments: PX4's source.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, replace

from link.mavlink.dialect import Message, mavlink
from link.mavlink.event_ids import event_id
from sim_autopilot.firmware.firmware import EventCode
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.status_texts import status_texts
from sim_autopilot.telemetry.status import boot_ms

_EVENT = 410
_ARGUMENTS = 40
_EVERYBODY = 0
_SEQUENCES = (1 << 16) - 1
_EXTERNAL = 0x0F
_CRITICAL = 0x42
"""A warning inside, critical outside."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Telling:
    """Messages about something that happened, and the memory that has counted its event."""

    memory: AutopilotMemory
    messages: tuple[Message, ...]


def tell(
    memory: AutopilotMemory, text: str, severity: int, config: AutopilotConfig, code: EventCode | None = None
) -> Telling:
    """Return how `text` is said: as an event where the firmware has one for it, and as text where somebody reads it.

    A text that is an event as well ends in a tab, by which ground stations that show events know to leave it out; its
    severity is the event's. The event is `code`, or that of the firmware's table.
    """
    code = config.firmware.events.get(text, code)
    if code is None:
        said = status_texts(severity, text, memory.services.events + 1) if memory.ground_station else ()
        return Telling(memory=memory, messages=said)
    told = text if code.said is None else code.said
    heard = memory.ground_station and told
    said = status_texts(code.levels & _EXTERNAL, f"{told}\t", memory.services.events + 1) if heard else ()
    services = memory.services
    event = _event(code.name, code.levels, code.arguments, services.events, boot_ms(memory))
    counted = replace(memory, services=replace(services, events=(services.events + 1) % _SEQUENCES))
    return Telling(memory=counted, messages=(event, *said))


def failsafe_texts(
    before: AutopilotMemory, memory: AutopilotMemory, texts: Mapping[int, str], entered: str
) -> list[tuple[str, EventCode | None]]:
    """Return what is said about a battery that has become worse and about a failsafe that has begun."""
    level, armed = memory.services.watch.level, memory.armed_ns is not None
    said: list[tuple[str, EventCode | None]] = []
    if level > before.services.watch.level and level in texts:
        said.append((texts[level], None))
    if not (armed and memory.modes.failsafe and memory.modes.mode is not before.modes.mode and entered):
        return said
    hold_s = memory.settings.failsafes.hold_s
    if not memory.services.watch.waits or hold_s is None:
        return [*said, (entered, None)]
    arguments = struct.pack("<IBH", 0, 0, round(hold_s))
    event = EventCode(name="commander_failsafe_enter_generic_hold", levels=_CRITICAL, arguments=arguments)
    return [*said, (f"{entered}: entering Hold for {hold_s:.0f} seconds", event)]


def _event(name: str, levels: int, arguments: bytes, sequence: int, now_ms: int) -> Message:
    padded = list(arguments.ljust(_ARGUMENTS, b"\0"))
    kind = mavlink.mavlink_map[_EVENT]
    return kind(_EVERYBODY, _EVERYBODY, event_id(name), now_ms, sequence, levels, padded)
