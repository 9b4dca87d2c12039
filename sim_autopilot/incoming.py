"""What each received message changes, and what answers it at once."""

from collections.abc import Callable, Mapping
from math import hypot, radians
from types import MappingProxyType

from link.geodesy import Datum, enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.attitude_setpoints import attitude_from_message
from sim_autopilot.commands import obey
from sim_autopilot.data import Reference
from sim_autopilot.global_setpoints import local_setpoint
from sim_autopilot.guided import with_attitude, with_wish
from sim_autopilot.guided_attitude import attitude_wish
from sim_autopilot.guided_setpoint import STOP, wish_from_message
from sim_autopilot.manual import sticks_from_message
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, has_passed, limited
from sim_autopilot.mission_transfer import MESSAGE_IDS
from sim_autopilot.missions_step import mission_current, set_current, take_plan
from sim_autopilot.mode_change import change_mode
from sim_autopilot.mode_request import try_mode
from sim_autopilot.modes import Event, Mode
from sim_autopilot.origin import move_origin
from sim_autopilot.parameters import find_index, is_type_right, parameter_message, values_after_set
from sim_autopilot.precision_landing import place_seen, with_sighting
from sim_autopilot.requests import is_for_us, request_from_message
from sim_autopilot.setpoints import reference_from_message, with_setpoint
from sim_autopilot.streams import with_interval
from sim_autopilot.telemetry_motion import height_over_surface_m

Result = tuple[AutopilotMemory, tuple[Message, ...]]
Handler = Callable[[AutopilotMemory, Message, AutopilotConfig], Result]

_ORIGIN_REACH_M = 1e5
"""An origin farther than this from the datum is a mistake: the flat frame would not serve."""


def take(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after `message` and the answers to it; most messages change nothing."""
    if config.firmware.texts.everybody and not memory.ground_station:
        memory = replace(memory, ground_station=True)
    handler = _HANDLERS.get(message.get_msgId())
    return (memory, ()) if handler is None else handler(memory, message, config)


def _is_ours(message: Message, config: AutopilotConfig) -> bool:
    """Whether a message that is no command is meant for this autopilot; 0 is everybody."""
    components = (mavlink.MAV_COMP_ID_AUTOPILOT1, mavlink.MAV_COMP_ID_ALL)
    return message.target_system in (config.system_id, 0) and message.target_component in components


def _heartbeat(memory: AutopilotMemory, message: Message, _config: AutopilotConfig) -> Result:
    is_station, counted = message.type == mavlink.MAV_TYPE_GCS, memory.settings.failsafes.station_system
    if is_station and not memory.ground_station:
        memory = replace(memory, ground_station=True)
    if is_station if counted is None else message.get_srcSystem() == counted:
        services = memory.services
        watch = replace(services.watch, station_ns=memory.now.boot_ns)
        memory = replace(memory, services=replace(services, watch=watch))
    return memory, ()


def _command(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not is_for_us(message, config):
        return memory, ()
    return obey(memory, request_from_message(message), config)


def _setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not _is_ours(message, config):
        return memory, ()
    if config.firmware.guided:
        return _guided_setpoint(memory, message, config)
    now = memory.now
    origin = memory.origin.position_enu_m
    reference = reference_from_message(message, config.firmware.setpoint_frames, origin, now.yaw_rad)
    return _followed(memory, reference)


def _followed(memory: AutopilotMemory, reference: Reference | None) -> Result:
    if reference is None:
        return memory, ()
    now = memory.now
    setpoints = with_setpoint(memory.setpoints, reference, now.boot_ns, memory.settings.setpoint_loss_s)
    return change_mode(replace(memory, setpoints=setpoints), Event.SETPOINTS_BACK), ()


def _global_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    guided, origin = config.firmware.guided, memory.origin.position_enu_m
    local = local_setpoint(message, config.datum, origin, memory.home_enu_m, knows_terrain=guided)
    if local is not None:
        return _setpoint(memory, local, config)
    if guided and memory.modes.mode is Mode.OFFBOARD and _is_ours(message, config):
        return replace(memory, guided=with_wish(memory.guided, STOP, memory.now)), ()
    return memory, ()


def _attitude_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not _is_ours(message, config):
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


def _landing_target(memory: AutopilotMemory, message: Message, _config: AutopilotConfig) -> Result:
    """Only a flying LAND mode keeps to it; another forgets the way there."""
    settings, services, now = memory.settings.landing, memory.services, memory.now
    place = place_seen(message, now, height_over_surface_m(memory)) if settings.enabled else None
    if place is None:
        return memory, ()
    before = services.target
    if before is not None and memory.modes.mode is not Mode.LAND:
        before = replace(before, path=None)
    target = with_sighting(before, place, now.boot_ns, settings)
    return replace(memory, services=replace(services, target=target)), ()


def _sticks(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    manual = message.get_msgId() == mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL
    if (message.target if manual else message.target_system) not in {config.system_id, 0}:
        return memory, ()
    services = memory.services
    sticks = sticks_from_message(message, memory.now.boot_ns, services.sticks)
    return replace(memory, services=replace(services, sticks=sticks)), ()


def _guided_setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """A setpoint counts in GUIDED only; another mode forgets it at once."""
    if memory.modes.mode is not Mode.OFFBOARD:
        return memory, ()
    now = memory.now
    wish = wish_from_message(message, config.firmware.setpoint_frames, memory.origin.position_enu_m, now)
    return (memory if wish is None else replace(memory, guided=with_wish(memory.guided, wish, now))), ()


def _parameter_list(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    return (replace(memory, listing=0) if _is_ours(message, config) else memory), ()


def _parameter_read(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    parameters = config.firmware.parameters
    index = find_index(parameters, message.param_id, message.param_index)
    if index is None or not _is_ours(message, config):
        return memory, ()
    tells_index = config.firmware.tells_indices or message.param_index >= 0
    autopilot_id = config.firmware.autopilot_id
    return memory, (parameter_message(parameters, index, memory.values, autopilot_id, tells_index=tells_index),)


def _parameter_set(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    parameters, autopilot_id = config.firmware.parameters, config.firmware.autopilot_id
    index = find_index(parameters, message.param_id)
    if index is None or not _is_ours(message, config):
        return memory, ()
    lenient = config.firmware.lenient_parameters
    if not lenient and not is_type_right(parameters[index], message):
        return memory, ()
    values = values_after_set(parameters, index, memory.values, message, autopilot_id, lenient=lenient)
    settings = config.firmware.settings(values)
    memory = replace(memory, values=values, settings=settings, plant_config=limited(config.plant, settings))
    tells_index = config.firmware.tells_indices
    return memory, (parameter_message(parameters, index, values, autopilot_id, tells_index=tells_index),)


def _set_mode(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """The older way to ask for a mode."""
    wanted, modes = message.custom_mode, config.firmware.modes
    mode = next((mode for mode, code in modes.items() if code.custom_mode == wanted), None)
    custom = message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    if message.target_system != config.system_id or not custom:
        return memory, ()
    result = config.firmware.results.no_such_mode
    if mode is not None:
        memory, result = try_mode(memory, mode, config)
    answered_as = config.firmware.set_mode_answered_as
    if answered_as is None:
        return memory, ()
    told = mavlink.MAVLink_command_ack_message(
        answered_as,
        result,
        0,
        0,
        target_system=message.get_srcSystem(),
        target_component=message.get_srcComponent(),
    )
    return memory, (told,)


def _data_stream(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Start or stop the messages of an old stream group, at one rate."""
    group = config.firmware.stream_groups.get(message.req_stream_id)
    if group is None or not _is_ours(message, config):
        return memory, ()
    rate_hz = min(float(message.req_message_rate), config.firmware.stream_rate_max_hz)
    interval_ns = round(1e9 / rate_hz) if message.start_stop and rate_hz > 0.0 else None
    streams = memory.streams
    for message_id in group:
        streams = with_interval(streams, message_id, interval_ns, memory.now.boot_ns)
    return replace(memory, streams=streams), ()


def _set_origin(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Move the local frame under the drone, as PX4 does even in flight."""
    fixed = config.firmware.keeps_origin and has_passed(config, memory, config.firmware.readiness.position_s)
    if fixed or message.target_system not in (config.system_id, 0):
        return memory, ()
    latitude_rad, longitude_rad = radians(message.latitude * 1e-7), radians(message.longitude * 1e-7)
    try:
        datum = Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=message.altitude * 1e-3)
    except ValueError:
        return memory, ()
    position = enu_from_geodetic(config.datum, datum.latitude_rad, datum.longitude_rad, datum.altitude_m)
    if hypot(*position) > _ORIGIN_REACH_M:
        return memory, ()
    memory, told = move_origin(memory, datum, position, config)
    return memory, (told,)


def _plan(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    return take_plan(memory, message, config) if _is_ours(message, config) else (memory, ())


def _set_current(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    sent = set_current(memory, message.seq) if _is_ours(message, config) else None
    return (memory, ()) if sent is None else (sent, (mission_current(sent, config),))


_HANDLERS: Mapping[int, Handler] = MappingProxyType(
    dict.fromkeys(MESSAGE_IDS, _plan)
    | {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: _heartbeat,
        mavlink.MAVLINK_MSG_ID_COMMAND_LONG: _command,
        mavlink.MAVLINK_MSG_ID_COMMAND_INT: _command,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: _setpoint,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: _global_setpoint,
        mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: _attitude_setpoint,
        mavlink.MAVLINK_MSG_ID_LANDING_TARGET: _landing_target,
        mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL: _sticks,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: _sticks,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: _parameter_list,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ: _parameter_read,
        mavlink.MAVLINK_MSG_ID_PARAM_SET: _parameter_set,
        mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN: _set_origin,
        mavlink.MAVLINK_MSG_ID_SET_MODE: _set_mode,
        mavlink.MAVLINK_MSG_ID_REQUEST_DATA_STREAM: _data_stream,
        mavlink.MAVLINK_MSG_ID_MISSION_SET_CURRENT: _set_current,
    }
)

HANDLED = frozenset(_HANDLERS)
"""The ids of the messages that are obeyed or answered."""
