"""What the autopilot tells unasked, once, when something happens: texts, and where home and the origin are."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.status_texts import status_text
from sim_autopilot.telemetry.events import tell
from sim_autopilot.telemetry.flight_texts import flight_texts
from sim_autopilot.telemetry.motion import gps_global_origin, home_position


def announcement(memory: AutopilotMemory, config: AutopilotConfig, *, with_home: bool) -> list[Message]:
    """Return GPS_GLOBAL_ORIGIN, and HOME_POSITION where it is asked for."""
    origin = [gps_global_origin(memory, config)]
    return [*origin, home_position(memory, config)] if with_home else origin


def changes_told(
    start: AutopilotMemory, obeyed: AutopilotMemory, memory: AutopilotMemory, config: AutopilotConfig
) -> tuple[AutopilotMemory, list[Message]]:
    """Return what is said about a step: `start` is before it, `obeyed` after its messages, `memory` at its end."""
    told: list[Message] = []
    texts, is_armed, was_armed = config.firmware.texts, memory.armed_ns is not None, start.armed_ns is not None
    if is_armed and not was_armed and config.firmware.announces_home:
        told += announcement(memory, config, with_home=True)
    if config.firmware.tells_flights:
        for text, code in flight_texts(start, obeyed, memory, config):
            telling = tell(memory, text, mavlink.MAV_SEVERITY_INFO, config, code)
            memory, told = telling.memory, [*told, *telling.messages]
    if not memory.ground_station:
        return memory, told
    change = None if is_armed is was_armed else texts.armed if is_armed else texts.disarmed
    said = [] if change is None else [change]
    if not config.instant:
        was_ns, now_ns = start.now.boot_ns, memory.now.boot_ns
        said += [text for at_s, text in texts.boot if was_ns < round(at_s * 1e9) <= now_ns]
    return memory, told + [status_text(text.severity, text.text) for text in said]
