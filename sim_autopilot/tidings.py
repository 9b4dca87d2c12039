"""What the autopilot tells unasked, once, when something happens: texts, and where home and the origin are."""

from link.mavlink.dialect import Message
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.telemetry_motion import gps_global_origin, home_position
from sim_autopilot.telemetry_status import status_text


def announcement(memory: AutopilotMemory, config: AutopilotConfig, *, with_home: bool) -> list[Message]:
    """Return GPS_GLOBAL_ORIGIN, and HOME_POSITION where it is asked for."""
    origin = [gps_global_origin(memory, config)]
    return [*origin, home_position(memory, config)] if with_home else origin


def changes_told(memory: AutopilotMemory, config: AutopilotConfig, *, was_ns: int, was_armed: bool) -> list[Message]:
    """Return what is said about a step that began at `was_ns` since boot, with the motors on or off."""
    told: list[Message] = []
    texts, is_armed = config.firmware.texts, memory.armed_ns is not None
    if is_armed and not was_armed and config.firmware.announces_home:
        told += announcement(memory, config, with_home=True)
    if not memory.ground_station:
        return told
    change = None if is_armed is was_armed else texts.armed if is_armed else texts.disarmed
    said = [] if change is None else [change]
    if not config.instant:
        said += [text for at_s, text in texts.boot if was_ns < round(at_s * 1e9) <= memory.now.boot_ns]
    return told + [status_text(text.severity, text.text) for text in said]
