"""What the autopilot tells once, when something happens: as text to ground stations, and as EVENT to everybody.

Source: MAVLink events interface; names, levels and arguments: PX4's source.
"""

import struct
from dataclasses import dataclass

from link.mavlink.dialect import Message, event_id, mavlink
from link.records import replace
from sim_autopilot.core.status_texts import EventCode, FailsafeTexts, status_text, status_texts
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.motion import gps_global_origin, home_position
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
        said = status_texts(severity, text, memory.outbox.events + 1) if memory.links.texted else ()
        return Telling(memory=memory, messages=said)
    told = text if code.said is None else code.said
    heard = memory.links.texted and told
    said = status_texts(code.levels & _EXTERNAL, f"{told}\t", memory.outbox.events + 1) if heard else ()
    outbox = memory.outbox
    event = _event(code.name, code.levels, code.arguments, outbox.events, boot_ms(memory))
    counted = replace(memory, outbox=replace(outbox, events=(outbox.events + 1) % _SEQUENCES))
    return Telling(memory=counted, messages=(event, *said))


def failsafe_texts(
    before: AutopilotMemory, memory: AutopilotMemory, texts: FailsafeTexts
) -> list[tuple[str, EventCode | None]]:
    """Return what is said about a battery that has become worse and about a failsafe that has begun."""
    level, armed = memory.safety.watch.level, memory.armed_ns is not None
    said: list[tuple[str, EventCode | None]] = []
    if level > before.safety.watch.level and level in texts.battery:
        said.append((texts.battery[level], None))
    if not (armed and memory.modes.failsafe and memory.modes.mode is not before.modes.mode and texts.entered):
        return said
    hold_s = memory.tuning.settings.failsafes.hold_s
    if not memory.safety.watch.waits or hold_s is None:
        return [*said, (texts.entered, None)]
    arguments = struct.pack("<IBH", 0, 0, round(hold_s))
    event = EventCode(name="commander_failsafe_enter_generic_hold", levels=_CRITICAL, arguments=arguments)
    return [*said, (f"{texts.entered}: entering Hold for {hold_s:.0f} seconds", event)]


def announce_origin(memory: AutopilotMemory, config: AutopilotConfig, *, with_home: bool) -> list[Message]:
    """Return GPS_GLOBAL_ORIGIN, and HOME_POSITION where it is asked for."""
    origin = [gps_global_origin(memory, config)]
    return [*origin, home_position(memory, config)] if with_home else origin


def describe_step(
    start: AutopilotMemory, obeyed: AutopilotMemory, memory: AutopilotMemory, config: AutopilotConfig
) -> tuple[AutopilotMemory, list[Message]]:
    """Return what is said about a step: `start` is before it, `obeyed` after its messages, `memory` at its end."""
    told: list[Message] = []
    texts, is_armed, was_armed = config.firmware.texts, memory.armed_ns is not None, start.armed_ns is not None
    if is_armed and not was_armed and config.firmware.origin.announces_home:
        told += announce_origin(memory, config, with_home=True)
    if config.firmware.describe_flight is not None:
        for text, code in config.firmware.describe_flight(start, obeyed, memory, config):
            telling = tell(memory, text, mavlink.MAV_SEVERITY_INFO, config, code)
            memory, told = telling.memory, [*told, *telling.messages]
    if not memory.links.here.ground_station:
        return memory, told
    change = None if is_armed is was_armed else texts.armed if is_armed else texts.disarmed
    said = [] if change is None else [change]
    if not config.instant:
        was_ns, now_ns = start.now.boot_ns, memory.now.boot_ns
        said += [text for at_s, text in texts.boot if was_ns < round(at_s * 1e9) <= now_ns]
    return memory, told + [status_text(text.severity, text.text) for text in said]


def _event(name: str, levels: int, arguments: bytes, sequence: int, now_ms: int) -> Message:
    padded = list(arguments.ljust(_ARGUMENTS, b"\0"))
    kind = mavlink.mavlink_map[_EVENT]
    return kind(_EVERYBODY, _EVERYBODY, event_id(name), now_ms, sequence, levels, padded)
