"""What setpoints, the sighting of a landing target and the word of somebody to follow change."""

from math import isfinite

from link.frames.rotations import enu_from_ned
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.addressees import is_ours
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.follow import with_word
from sim_autopilot.flight.precision_landing import Target, place_seen, place_told, with_sighting
from sim_autopilot.flight.repositioning import place_asked
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.range_finder import height_over_surface_m

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def take_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SET_POSITION_TARGET_LOCAL_NED."""
    ours = is_ours(message, config)
    return config.firmware.setpoints.take_local(memory, message) if ours else memory, ()


def take_global_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SET_POSITION_TARGET_GLOBAL_INT."""
    ours = is_ours(message, config)
    return config.firmware.setpoints.take_global(memory, message) if ours else memory, ()


def take_attitude_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SET_ATTITUDE_TARGET."""
    ours = is_ours(message, config)
    return config.firmware.setpoints.take_attitude(memory, message) if ours else memory, ()


def take_landing_target(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a LANDING_TARGET: only a flying LAND mode keeps to it; another forgets the way there.

    Where precision landing is a mode of its own, that takes the place as it is told.
    """
    if Mode.PRECISION_LAND in config.firmware.modes.codes:
        place = place_told(message, memory.places.origin)
        target = None if place is None else Target(seen_ns=memory.now.boot_ns, position_enu_m=place)
        return (memory if target is None else replace(memory, heard=replace(memory.heard, target=target))), ()
    settings, now = memory.tuning.settings.land.precision, memory.now
    place = place_seen(message, now, height_over_surface_m(memory)) if settings.enabled else None
    if place is None:
        return memory, ()
    before = memory.heard.target
    if before is not None and memory.modes.mode is not Mode.LAND:
        before = replace(before, path=None)
    target = with_sighting(before, place, now.boot_ns, settings)
    return replace(memory, heard=replace(memory.heard, target=target)), ()


def take_leader(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a FOLLOW_TARGET, which is for everybody."""
    velocity = enu_from_ned(message.vel)
    place = place_asked(
        memory, config.datum, int(mavlink.MAV_FRAME_GLOBAL), (message.lat * 1e-7, message.lon * 1e-7, message.alt)
    )
    if (
        Mode.FOLLOW not in config.firmware.modes.codes
        or place is None
        or not all(map(isfinite, (*velocity, message.alt)))
    ):
        return memory, ()
    smoothing = memory.tuning.settings.follow.smoothing
    leader = with_word(memory.heard.leader, place, velocity, memory.now.boot_ns, smoothing)
    return replace(memory, heard=replace(memory.heard, leader=leader)), ()
