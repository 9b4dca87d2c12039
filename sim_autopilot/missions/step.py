"""Missions in the autopilot's step: their flight, and what is told about it."""

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory, with_flight
from sim_autopilot.missions.flight import Progress, Stage, Surroundings, fly_mission, resume, set_to

_NO_ITEMS = 65535
"""What MISSION_CURRENT tells as the total of no mission; its modes follow."""
_UNKNOWN, _ACTIVE, _SUSPENDED = 0, 1, 2

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def first_index(config: AutopilotConfig) -> int:
    """Return where a mission begins."""
    return 1 if config.firmware.missions.home_first else 0


def set_current(memory: AutopilotMemory, index: int) -> AutopilotMemory | None:
    """Return the memory with item `index` made current, None where there is no such item."""
    if not 0 <= index < len(memory.mission.items):
        return None
    return _with_progress(memory, set_to(memory.mission.progress, index))


def begin_mission(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory of a mission mode that begins: a finished mission from the start, another where it was."""
    progress = resume(memory.mission.progress)
    if progress.stage is Stage.FINISHED or progress.index < first_index(config):
        progress = Progress(index=first_index(config))
    return _with_progress(memory, progress)


def advance_mission(memory: AutopilotMemory, config: AutopilotConfig) -> Result:
    """Return the memory with the mission flown one step on, and what is told about it."""
    if memory.modes.mode is not Mode.MISSION or memory.armed_ns is None:
        return memory, ()
    around = Surroundings(
        datum=config.datum,
        home_enu_m=memory.places.home_enu_m,
        settings=memory.tuning.settings,
        now=memory.now,
        landed=memory.course.landing.landed,
        returns_itself=config.firmware.missions.returns_itself,
    )
    before = memory.mission.progress
    step = fly_mission(before, memory.mission.items, memory.course.flight, around)
    memory = _with_progress(with_flight(memory, step.flight), step.progress)
    messages = tuple(mavlink.MAVLink_mission_item_reached_message(index) for index in step.reached)
    messages = (*messages, *config.firmware.missions.describe(before, step, memory.mission.items))
    if (step.progress.index, step.progress.stage is Stage.FINISHED) != (before.index, before.stage is Stage.FINISHED):
        messages = (*messages, mission_current(memory, config))
    if _has_nothing_to_fly(memory, config):
        return change_mode(memory, Event.ASK_HOLD), messages
    if _ends_in_the_air(memory, before, config):
        memory = change_mode(memory, Event.ASK_HOLD)
        modes = memory.modes
        return replace(memory, modes=replace(modes, resting=modes.mode)), messages
    if step.returns:
        memory = change_mode(memory, Event.ASK_RTL)
    return memory, messages


def _has_nothing_to_fly(memory: AutopilotMemory, config: AutopilotConfig) -> bool:
    """Whether the mission was cleared under way, after which PX4 holds too."""
    return not memory.mission.items and config.firmware.missions.holds_at_the_end and not memory.course.landing.landed


def _ends_in_the_air(memory: AutopilotMemory, before: Progress, config: AutopilotConfig) -> bool:
    """Whether a mission has just ended in the air, after which PX4 holds."""
    ends = memory.mission.progress.stage is Stage.FINISHED and before.stage is not Stage.FINISHED
    last = memory.mission.items[memory.mission.progress.index] if ends else None
    stays = last is not None and last.command != mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH
    return stays and config.firmware.missions.holds_at_the_end and not memory.course.landing.landed


def mission_current(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return MISSION_CURRENT; where item 0 is home it does not count, and whether it is suspended is not told."""
    count, progress = len(memory.mission.items), memory.mission.progress
    mode = _ACTIVE if memory.modes.mode is Mode.MISSION else _SUSPENDED
    home_first = config.firmware.missions.home_first
    return mavlink.MAVLink_mission_current_message(
        progress.index,
        (max(count - 1, 0) if home_first else count) or _NO_ITEMS,
        _state(memory, count),
        _UNKNOWN if home_first else mode,
    )


def _state(memory: AutopilotMemory, count: int) -> int:
    progress = memory.mission.progress
    if count == 0:
        return int(mavlink.MISSION_STATE_NO_MISSION)
    if progress.stage is Stage.FINISHED:
        return int(mavlink.MISSION_STATE_COMPLETE)
    if not progress.started:
        return int(mavlink.MISSION_STATE_NOT_STARTED)
    flying = memory.modes.mode is Mode.MISSION and memory.armed_ns is not None
    return int(mavlink.MISSION_STATE_ACTIVE if flying else mavlink.MISSION_STATE_PAUSED)


def _with_progress(memory: AutopilotMemory, progress: Progress) -> AutopilotMemory:
    return replace(memory, mission=replace(memory.mission, progress=progress))
