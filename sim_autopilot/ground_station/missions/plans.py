"""Plans in the autopilot's step: uploads that change the mission and the fence, and transfers that time out."""

from math import degrees

from link.frames.geodesy import geodetic_from_enu
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.core.status_texts import status_text
from sim_autopilot.ground_station.memory import station_of, with_station
from sim_autopilot.ground_station.missions.library import Arrival
from sim_autopilot.ground_station.missions.rules import TransferRules
from sim_autopilot.ground_station.missions.transfer import take_mission_message, transfer_passes
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.missions.fence import fence_of
from sim_autopilot.missions.flight import NO_PROGRESS
from sim_autopilot.missions.items import FENCE, MISSION, Item
from sim_autopilot.missions.step import mission_current

_CLEAR = int(mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL)

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def take_plan(memory: AutopilotMemory, message: Message, config: AutopilotConfig, rules: TransferRules) -> Result:
    """Return the memory after a message of the mission protocol meant for this autopilot, and the answers."""
    station, mission = station_of(memory), memory.mission
    arrival = Arrival(
        message=message,
        boot_ns=memory.now.boot_ns,
        rules=rules,
        current=mission.progress.index,
        home=_home_item(memory, config) if config.firmware.missions.home_first else None,
    )
    library, answers = take_mission_message(station.library, arrival)
    plans, changed = library.plans, library.changed != station.library.changed
    progress = NO_PROGRESS if changed else mission.progress
    is_same_fence = plans[FENCE] is station.library.plans[FENCE]
    fence = mission.fence if is_same_fence else fence_of(plans[FENCE], config.datum)
    mission = replace(mission, items=plans[MISSION], progress=progress, fence=fence)
    memory = with_station(replace(memory, mission=mission), replace(station, library=library))
    if not changed:
        return memory, answers
    is_told = rules.received_text and message.get_msgId() != _CLEAR
    said = (status_text(mavlink.MAV_SEVERITY_INFO, rules.received_text),) if is_told else ()
    return memory, (*answers, mission_current(memory, config), *said)


def pass_transfer(memory: AutopilotMemory, rules: TransferRules) -> Result:
    """Return the memory now, with what a transfer under way asks for again or gives up."""
    station = station_of(memory)
    if station.library.transfer is None:
        return memory, ()
    library, messages = transfer_passes(station.library, memory.now.boot_ns, rules)
    if library is station.library:
        return memory, ()
    return with_station(memory, replace(station, library=library)), messages


def _home_item(memory: AutopilotMemory, config: AutopilotConfig) -> Item:
    """Return home as ArduCopter tells it: item 0 of every mission."""
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(config.datum, memory.places.home_enu_m)
    return Item(
        frame=int(mavlink.MAV_FRAME_GLOBAL),
        command=int(mavlink.MAV_CMD_NAV_WAYPOINT),
        autocontinue=1,
        parameters=(0.0, 0.0, 0.0, 0.0),
        x=round(degrees(latitude_rad) * 1e7),
        y=round(degrees(longitude_rad) * 1e7),
        z=altitude_m,
    )
