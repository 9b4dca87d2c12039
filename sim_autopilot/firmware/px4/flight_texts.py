"""What PX4 says about a flight as it goes: motors, take-off, landing, mission, return, ground station.

Texts, names and arguments of events: PX4's source (commander, navigator, logger).
"""

import struct
from datetime import UTC, datetime
from math import ceil
from types import MappingProxyType

from sim_autopilot.core.modes import Mode
from sim_autopilot.core.status_texts import EventCode
from sim_autopilot.firmware.px4.events import (
    ARMED,
    COMPANION_BACK,
    COMPANION_LOST,
    DISARMED,
    DISARMED_IDLE,
    DISARMED_LANDED,
    INFO,
    LANDED,
    MISSION_BEGINS,
    MISSION_GONE,
    MISSION_LANDED,
    MISSION_LOITERS,
    RETURN_LANDS,
    STATION_BACK,
    STATION_LOST,
    TAKEN_OFF,
)
from sim_autopilot.flight.flight import Leg
from sim_autopilot.interfaces import AutopilotConfig, Said
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.missions.flight import Stage

LOG_PATH = "log/{0:%Y-%m-%d}/{0:%H_%M_%S}.ulg"
"""Of a flight's log, by when it began."""
_LOST, _BACK = "lost", "back"
_STATION_SAID = MappingProxyType({_LOST: STATION_LOST, _BACK: STATION_BACK})
_COMPANION_SAID = MappingProxyType({_LOST: COMPANION_LOST, _BACK: COMPANION_BACK})


def flight_texts(
    start: AutopilotMemory, obeyed: AutopilotMemory, memory: AutopilotMemory, config: AutopilotConfig
) -> list[Said]:
    """Return what is said about a step: `start` is before it, `obeyed` after its messages."""
    said: list[Said] = [(text, None) for text in (*_motors(start, obeyed, memory), *_station(start, memory))]
    if memory.armed_ns is None:
        return said
    told = [*said, *_way(start, memory, config)]
    if start.armed_ns is None:
        told.append(_log(memory))
    return told


def _motors(start: AutopilotMemory, obeyed: AutopilotMemory, memory: AutopilotMemory) -> list[str]:
    was_armed, is_armed = start.armed_ns is not None, memory.armed_ns is not None
    if is_armed and not was_armed:
        return [ARMED]
    if was_armed and not is_armed:
        if obeyed.armed_ns is None:
            return [DISARMED]
        if not obeyed.course.landing.landed:
            return []
        return [DISARMED_IDLE if obeyed.course.landing.landed_ns is None else DISARMED_LANDED]
    if is_armed and start.course.landing.landed is not memory.course.landing.landed:
        return [LANDED if memory.course.landing.landed else TAKEN_OFF]
    return []


def _station(start: AutopilotMemory, memory: AutopilotMemory) -> list[str]:
    """Ground station and companion, whose silence is noticed on the ground too."""
    was, watch = start.safety.watch, memory.safety.watch
    times_ns = (start.now.boot_ns, memory.now.boot_ns)
    station_s, companion_s = memory.tuning.settings.failsafes.station_lost_s, memory.tuning.values["COM_OBC_LOSS_T"]
    station = _silence((was.station_ns, watch.station_ns), times_ns, station_s)
    companion = _silence((was.companion_ns, watch.companion_ns), times_ns, companion_s)
    said = (_STATION_SAID.get(station), _COMPANION_SAID.get(companion))
    return [text for text in said if text is not None]


def _silence(heard_ns: tuple[int | None, int | None], times_ns: tuple[int, int], limit_s: float) -> str:
    """Return whether somebody is just lost, or back, by when it was heard last: before and after a step."""
    before_ns, after_ns = heard_ns
    if before_ns is None:
        return ""
    was_ns, is_ns = times_ns
    was_lost, is_lost = (was_ns - before_ns) * 1e-9 > limit_s, (is_ns - before_ns) * 1e-9 > limit_s
    if after_ns != before_ns:
        return _BACK if was_lost else ""
    return _LOST if is_lost and not was_lost else ""


def _way(start: AutopilotMemory, memory: AutopilotMemory, config: AutopilotConfig) -> list[Said]:
    mode, was = memory.modes.mode, start.modes.mode
    begins = mode is not was or start.armed_ns is None
    if begins and mode is Mode.TAKEOFF and memory.course.flight.leg is not Leg.CLIMB:
        height_m = memory.tuning.settings.takeoff.height_m
        event = EventCode(name="navigator_takeoff_default_alt", levels=INFO, arguments=struct.pack("<f", height_m))
        return [(f"Using default takeoff altitude: {height_m:.1f} m", event)]
    if begins and mode is Mode.RTL:
        return [_return(memory, config)]
    if mode is Mode.RTL and memory.course.flight.leg is Leg.DESCEND and start.course.flight.leg is not Leg.DESCEND:
        return [(RETURN_LANDS, None)]
    told = _mission(start, memory)
    return [] if told is None else [(told, None)]


def _mission(start: AutopilotMemory, memory: AutopilotMemory) -> str | None:
    mode, was = memory.modes.mode, start.modes.mode
    begins = mode is not was or start.armed_ns is None
    if begins and mode is Mode.MISSION:
        return MISSION_BEGINS
    if begins and was is Mode.MISSION and not memory.mission.items:
        return MISSION_GONE
    if Mode.MISSION not in {mode, was}:
        return None
    finished, had = (each.mission.progress.stage is Stage.FINISHED for each in (memory, start))
    if finished and not had:
        return MISSION_LANDED if memory.course.landing.landed else MISSION_LOITERS
    return None


def _return(memory: AutopilotMemory, config: AutopilotConfig) -> Said:
    place = memory.course.flight.anchor.position_enu_m
    up_m = memory.now.position_enu_m[2] if place is None else float(place[2])
    above_sea_m, above_home_m = ceil(config.datum.altitude_m + up_m), ceil(up_m - memory.places.home_enu_m[2])
    arguments = struct.pack("<ii", above_sea_m, above_home_m)
    text = f"RTL: start return at {above_sea_m} m ({above_home_m} m above destination)"
    return text, EventCode(name="vrtl_return_at", levels=INFO, arguments=arguments)


def _log(memory: AutopilotMemory) -> Said:
    began = datetime.fromtimestamp(memory.now.t_ns // 1_000_000_000, UTC)
    arguments = struct.pack("<HBBBBB", *began.timetuple()[:6])
    event = EventCode(name="logger_open_file_time", levels=INFO, arguments=arguments)
    return f"[logger] ./{LOG_PATH.format(began, 0)}", event
