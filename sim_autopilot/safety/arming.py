"""Motors on and off: who may when, and by itself after a landing or an idle wait."""

from link.records import replace
from sim_autopilot.core.modes import Mode, rest
from sim_autopilot.flight.flight import Leg, begin, climb_to
from sim_autopilot.flight.land_detector import Landing
from sim_autopilot.flight.manual import MANUAL_MODES, sticks_in_effect
from sim_autopilot.interfaces import AutopilotConfig, has_passed
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.missions.flight import Stage

_LANDING_MODES = frozenset({Mode.LAND, Mode.PRECISION_LAND, Mode.RTL, Mode.SMART_RTL})


def arming_obstacle(memory: AutopilotMemory, config: AutopilotConfig) -> str | None:
    """Return why it does not arm, in the firmware's words; None where it does."""
    texts, mode = config.firmware.texts, memory.modes.intended
    for until_s, text in texts.not_ready:
        if not has_passed(config, memory, until_s):
            return text
    if mode in config.firmware.modes.unarmable or (mode is Mode.MISSION and not memory.mission.items):
        return texts.unarmable.format(config.firmware.modes.codes[mode].name)
    if mode in MANUAL_MODES and not _has_sticks(memory):
        return texts.unarmable.format(config.firmware.modes.codes[mode].name)
    if mode is Mode.OFFBOARD and not config.firmware.setpoints.may_begin(memory):
        return texts.no_setpoints
    return None


def _has_sticks(memory: AutopilotMemory) -> bool:
    feel = memory.tuning.settings.sticks
    return sticks_in_effect(memory.heard.sticks, memory.now.boot_ns, feel) is not None


def arm(memory: AutopilotMemory) -> AutopilotMemory:
    """Return the memory with the motors on, and home here; a take-off asked for before keeps its height."""
    if memory.armed_ns is not None:
        return memory
    now = memory.now
    flight = begin(memory.modes.mode, now, now.position_enu_m, memory.tuning.settings)
    asked = memory.course.flight
    if memory.modes.mode is Mode.TAKEOFF and asked.leg is Leg.CLIMB and asked.anchor.position_enu_m is not None:
        flight = climb_to(flight, float(asked.anchor.position_enu_m[2]), now)
    course = replace(memory.course, flight=flight, climb=None, landing=Landing())
    places = replace(memory.places, home_enu_m=now.position_enu_m)
    return replace(memory, armed_ns=now.boot_ns, course=course, places=places)


def disarm(memory: AutopilotMemory) -> AutopilotMemory:
    """Return the memory with the motors off; the drone counts as landed from then on, wherever it is."""
    if memory.armed_ns is None:
        return memory
    modes = rest(memory.modes)
    flight = begin(modes.mode, memory.now, memory.places.home_enu_m, memory.tuning.settings)
    course = replace(memory.course, flight=flight, climb=None, landing=Landing(), following=None)
    return replace(memory, armed_ns=None, modes=modes, course=course)


def should_disarm(memory: AutopilotMemory) -> bool:
    """Return whether it is time to stop the motors unasked."""
    armed_ns, landing, settings = memory.armed_ns, memory.course.landing, memory.tuning.settings
    if armed_ns is None or not landing.landed or memory.course.climb is not None:
        return False
    if landing.landed_ns is not None:
        ended = memory.modes.mode is Mode.MISSION and memory.mission.progress.stage is Stage.FINISHED
        by_mode = memory.modes.mode in _LANDING_MODES or ended
        limit_s = settings.disarm.after_landing_mode_s if by_mode else settings.disarm.landed_s
        since_ns = landing.landed_ns
    else:
        limit_s, since_ns = settings.disarm.idle_s, armed_ns + round(settings.takeoff.spool_up_s * 1e9)
    return limit_s is not None and (memory.now.boot_ns - since_ns) * 1e-9 >= limit_s
