"""The failsafes in the autopilot's step: what they see of it, and the mode changes they lead to."""

from link.records import replace
from sim_autopilot.core.modes import Event
from sim_autopilot.flight.manual import MANUAL_MODES
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.safety.arming import disarm
from sim_autopilot.safety.failsafes import Watch, watch_battery, watch_fence, watch_station


def charge_of(memory: AutopilotMemory, config: AutopilotConfig) -> float:
    """Return the battery's remaining share: running motors empty it evenly, and it is full again when they stop.

    So does PX4's own simulation, and one that flies all day stays of use.
    """
    if memory.safety.failures.battery:
        return 0.0
    ran_s = 0.0 if memory.armed_ns is None else (memory.now.boot_ns - memory.armed_ns) * 1e-9
    return max(0.0, 1.0 - ran_s / config.endurance_s)


def keep_watch(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory of a flying drone after battery, fence and ground station were looked at."""
    if memory.armed_ns is None or memory.course.landing.landed:
        return memory
    before, settings, now = memory.safety.watch, memory.tuning.settings.failsafes, memory.now
    watch, low = watch_battery(before, charge_of(memory, config), settings)
    watch, left = watch_fence(watch, memory.mission.fence, now.position_enu_m, memory.places.home_enu_m, settings)
    watch, lost = watch_station(watch, now.boot_ns, settings)
    if memory.modes.mode in settings.station_spares:
        lost = None
    if watch is not before:
        memory = update_watch(memory, watch)
    for event in (left, lost, low):
        memory = react_to_failsafe(memory, event)
    return memory


def mind_lost_sticks(memory: AutopilotMemory, *, held: bool) -> AutopilotMemory:
    """Return the memory of an armed drone after its sticks were looked at: a manual mode without any holds for a while.

    Sticks that come back do not end that; a mode that is asked for does.
    """
    settings, boot_ns = memory.tuning.settings, memory.now.boot_ns
    watch, hold_s = memory.safety.watch, settings.failsafes.hold_s
    if (
        memory.modes.mode in MANUAL_MODES
        and not held
        and settings.takeover.lost_event is not None
        and hold_s is not None
    ):
        watch = replace(watch, sticks_lost_ns=boot_ns)
        return react_to_failsafe(update_watch(memory, watch), Event.FAILSAFE_HOLD)
    if watch.sticks_lost_ns is None:
        return memory
    if not memory.modes.latched:
        return update_watch(memory, replace(watch, sticks_lost_ns=None))
    if hold_s is None or (boot_ns - watch.sticks_lost_ns) * 1e-9 < hold_s:
        return memory
    return react_to_failsafe(update_watch(memory, replace(watch, sticks_lost_ns=None)), settings.takeover.lost_event)


def update_watch(memory: AutopilotMemory, watch: Watch) -> AutopilotMemory:
    """Return the memory with what the failsafes have noticed."""
    return replace(memory, safety=replace(memory.safety, watch=watch))


def react_to_failsafe(memory: AutopilotMemory, event: Event | None) -> AutopilotMemory:
    """Return the memory after a failsafe's event, None for one that only warns."""
    if event is None:
        return memory
    return disarm(memory) if event is Event.FAILSAFE_TERMINATE else change_mode(memory, event)
