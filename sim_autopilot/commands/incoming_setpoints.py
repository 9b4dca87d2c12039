"""What setpoints, the sighting of a landing target and the word of somebody to follow change."""

from math import isfinite

from link.frames.rotations import enu_from_ned
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.data import Reference
from sim_autopilot.flight.follow import with_word
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.flight.modes import Event, Mode
from sim_autopilot.flight.precision_landing import place_seen, with_sighting
from sim_autopilot.flight.repositioning import place_asked
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.requests import is_ours
from sim_autopilot.setpoints.attitude import attitude_from_message
from sim_autopilot.setpoints.global_frame import local_setpoint
from sim_autopilot.setpoints.guided import with_attitude, with_wish
from sim_autopilot.setpoints.guided_attitude import attitude_wish
from sim_autopilot.setpoints.guided_setpoint import STOP, wish_from_message
from sim_autopilot.setpoints.setpoints import reference_from_message, with_setpoint
from sim_autopilot.telemetry.motion import height_over_surface_m

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def take_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SET_POSITION_TARGET_LOCAL_NED."""
    if not is_ours(message, config):
        return memory, ()
    if config.firmware.guided:
        return _guided_setpoint(memory, message, config)
    reference = reference_from_message(message, config.firmware.setpoint_frames, memory.origin, memory.now)
    return _followed(memory, reference)


def _followed(memory: AutopilotMemory, reference: Reference | None) -> Result:
    if reference is None:
        return memory, ()
    now = memory.now
    setpoints = with_setpoint(memory.setpoints, reference, now.boot_ns, memory.settings.setpoint_loss_s)
    return change_mode(replace(memory, setpoints=setpoints), Event.SETPOINTS_BACK), ()


def take_global_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SET_POSITION_TARGET_GLOBAL_INT."""
    guided = config.firmware.guided
    local = local_setpoint(message, memory.origin, memory.home_enu_m, knows_terrain=guided)
    if local is not None:
        return take_setpoint(memory, local, config)
    if guided and memory.modes.mode is Mode.OFFBOARD and is_ours(message, config):
        return replace(memory, guided=with_wish(memory.guided, STOP, memory.now)), ()
    return memory, ()


def take_attitude_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SET_ATTITUDE_TARGET."""
    if not is_ours(message, config):
        return memory, ()
    if config.firmware.guided:
        return _guided_attitude(memory, message), ()
    return _followed(memory, attitude_from_message(message, memory.settings.hover_share))


def _guided_attitude(memory: AutopilotMemory, message: Message) -> AutopilotMemory:
    settings, guided, now = memory.settings, memory.guided, memory.now
    if memory.modes.mode is not Mode.OFFBOARD or settings.path is None:
        return memory
    attitude = attitude_wish(message, settings, settings.path)
    taken = with_wish(guided, STOP, now) if attitude is None else with_attitude(guided, attitude, now)
    return replace(memory, guided=taken)


def take_landing_target(memory: AutopilotMemory, message: Message, _config: AutopilotConfig) -> Result:
    """Take a LANDING_TARGET: only a flying LAND mode keeps to it; another forgets the way there."""
    settings, services, now = memory.settings.landing, memory.services, memory.now
    place = place_seen(message, now, height_over_surface_m(memory)) if settings.enabled else None
    if place is None:
        return memory, ()
    before = services.target
    if before is not None and memory.modes.mode is not Mode.LAND:
        before = replace(before, path=None)
    target = with_sighting(before, place, now.boot_ns, settings)
    return replace(memory, services=replace(services, target=target)), ()


def take_leader(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a FOLLOW_TARGET, which is for everybody."""
    velocity = enu_from_ned(message.vel)
    place = place_asked(
        memory, config.datum, int(mavlink.MAV_FRAME_GLOBAL), (message.lat * 1e-7, message.lon * 1e-7, message.alt)
    )
    if Mode.FOLLOW not in config.firmware.modes or place is None or not all(map(isfinite, (*velocity, message.alt))):
        return memory, ()
    services, smoothing = memory.services, memory.settings.follow.smoothing
    leader = with_word(services.leader, place, velocity, memory.now.boot_ns, smoothing)
    return replace(memory, services=replace(services, leader=leader)), ()


def _guided_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """A setpoint counts in GUIDED only; another mode forgets it at once."""
    if memory.modes.mode is not Mode.OFFBOARD:
        return memory, ()
    now = memory.now
    wish = wish_from_message(message, config.firmware.setpoint_frames, memory.origin, now)
    return (memory if wish is None else replace(memory, guided=with_wish(memory.guided, wish, now))), ()
