"""Changing the mode: the table is asked, and a new mode begins where the drone is."""

from link.records import replace
from sim_autopilot.core.modes import Event, Mode, react
from sim_autopilot.flight.flight import begin
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.setpoints.guided import begin_guided


def change_mode(memory: AutopilotMemory, event: Event) -> AutopilotMemory:
    """Return the memory after `event`; a mode that goes on keeps what it remembers, unless a failsafe begins."""
    modes = react(memory.modes, event)
    if modes == memory.modes:
        return memory
    if modes.mode is memory.modes.mode and modes.latched is memory.modes.latched:
        return replace(memory, modes=modes)
    flight = begin(modes.mode, memory.now, memory.places.home_enu_m, memory.tuning.settings)
    guided = begin_guided(memory.now) if modes.mode is Mode.OFFBOARD else memory.course.guided
    return replace(memory, modes=modes, course=replace(memory.course, flight=flight, guided=guided))
