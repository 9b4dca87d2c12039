"""The mission service in the autopilot's step: its messages, its time-outs and its flight."""

from dataclasses import replace
from math import degrees

from link.frames.geodesy import geodetic_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.flight.modes import Event, Mode
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.missions.fence import fence_of
from sim_autopilot.missions.flight import NO_PROGRESS, Progress, Stage, Surroundings, fly_mission, resumed, set_to
from sim_autopilot.missions.items import FENCE, MISSION, Item
from sim_autopilot.missions.library import Arrival
from sim_autopilot.missions.texts import passed, received
from sim_autopilot.missions.transfer import take_mission_message, transfer_passes

_NO_ITEMS = 65535
"""What MISSION_CURRENT tells as the total of no mission; its modes follow."""
_UNKNOWN, _ACTIVE, _SUSPENDED = 0, 1, 2

_CLEAR = int(mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL)

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def mission_items(memory: AutopilotMemory) -> tuple[Item, ...]:
    """Return the items of the mission that the autopilot holds."""
    return memory.services.library.plans[MISSION]


def take_plan(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after a message of the mission protocol meant for this autopilot, and the answers."""
    services = memory.services
    arrival = Arrival(
        message=message,
        boot_ns=memory.now.boot_ns,
        rules=config.firmware.missions,
        current=services.mission.index,
        home=home_item(memory, config) if config.firmware.missions.home_first else None,
    )
    library, answers = take_mission_message(services.library, arrival)
    changed = library.changed != services.library.changed
    progress = NO_PROGRESS if changed else services.mission
    fence = services.fence
    if library.plans[FENCE] is not services.library.plans[FENCE]:
        fence = fence_of(library.plans[FENCE], config.datum)
    memory = replace(memory, services=replace(services, library=library, mission=progress, fence=fence))
    if not changed:
        return memory, answers
    said = () if message.get_msgId() == _CLEAR else received(config)
    return memory, (*answers, mission_current(memory, config), *said)


def home_item(memory: AutopilotMemory, config: AutopilotConfig) -> Item:
    """Return home as ArduCopter tells it: item 0 of every mission."""
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(config.datum, memory.home_enu_m)
    return Item(
        frame=int(mavlink.MAV_FRAME_GLOBAL),
        command=int(mavlink.MAV_CMD_NAV_WAYPOINT),
        autocontinue=1,
        parameters=(0.0, 0.0, 0.0, 0.0),
        x=round(degrees(latitude_rad) * 1e7),
        y=round(degrees(longitude_rad) * 1e7),
        z=altitude_m,
    )


def first_index(config: AutopilotConfig) -> int:
    """Return where a mission begins."""
    return 1 if config.firmware.missions.home_first else 0


def set_current(memory: AutopilotMemory, index: int) -> AutopilotMemory | None:
    """Return the memory with item `index` made current, None where there is no such item."""
    if not 0 <= index < len(mission_items(memory)):
        return None
    return _with_progress(memory, set_to(memory.services.mission, index))


def pass_transfer(memory: AutopilotMemory, config: AutopilotConfig) -> Result:
    """Return the memory now, with what a transfer under way asks for again or gives up."""
    services = memory.services
    if services.library.transfer is None:
        return memory, ()
    library, messages = transfer_passes(services.library, memory.now.boot_ns, config.firmware.missions)
    if library is services.library:
        return memory, ()
    return replace(memory, services=replace(services, library=library)), messages


def begin_mission(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory of a mission mode that begins: a finished mission from the start, another where it was."""
    progress = resumed(memory.services.mission)
    if progress.stage is Stage.FINISHED or progress.index < first_index(config):
        progress = Progress(index=first_index(config))
    return _with_progress(memory, progress)


def advance_mission(memory: AutopilotMemory, config: AutopilotConfig) -> Result:
    """Return the memory with the mission flown one step on, and what is told about it."""
    if memory.modes.mode is not Mode.MISSION or memory.armed_ns is None:
        return memory, ()
    around = Surroundings(
        datum=config.datum,
        home_enu_m=memory.home_enu_m,
        settings=memory.settings,
        now=memory.now,
        landed=memory.landing.landed,
        returns_itself=config.firmware.missions.returns_itself,
    )
    before = memory.services.mission
    step = fly_mission(before, mission_items(memory), memory.flight, around)
    memory = _with_progress(replace(memory, flight=step.flight), step.progress)
    messages = tuple(mavlink.MAVLink_mission_item_reached_message(index) for index in step.reached)
    messages = (*messages, *passed(before, step, mission_items(memory), config))
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
    return not mission_items(memory) and config.firmware.missions.holds_at_the_end and not memory.landing.landed


def _ends_in_the_air(memory: AutopilotMemory, before: Progress, config: AutopilotConfig) -> bool:
    """Whether a mission has just ended in the air, after which PX4 holds."""
    ends = memory.services.mission.stage is Stage.FINISHED and before.stage is not Stage.FINISHED
    last = mission_items(memory)[memory.services.mission.index] if ends else None
    stays = last is not None and last.command != mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH
    return stays and config.firmware.missions.holds_at_the_end and not memory.landing.landed


def mission_current(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return MISSION_CURRENT; where item 0 is home it does not count, and whether it is suspended is not told."""
    count, progress = len(mission_items(memory)), memory.services.mission
    mode = _ACTIVE if memory.modes.mode is Mode.MISSION else _SUSPENDED
    home_first = config.firmware.missions.home_first
    return mavlink.MAVLink_mission_current_message(
        progress.index,
        (max(count - 1, 0) if home_first else count) or _NO_ITEMS,
        _state(memory, count),
        _UNKNOWN if home_first else mode,
    )


def _state(memory: AutopilotMemory, count: int) -> int:
    progress = memory.services.mission
    if count == 0:
        return int(mavlink.MISSION_STATE_NO_MISSION)
    if progress.stage is Stage.FINISHED:
        return int(mavlink.MISSION_STATE_COMPLETE)
    if not progress.started:
        return int(mavlink.MISSION_STATE_NOT_STARTED)
    flying = memory.modes.mode is Mode.MISSION and memory.armed_ns is not None
    return int(mavlink.MISSION_STATE_ACTIVE if flying else mavlink.MISSION_STATE_PAUSED)


def _with_progress(memory: AutopilotMemory, progress: Progress) -> AutopilotMemory:
    return replace(memory, services=replace(memory.services, mission=progress))
