"""What each received message changes, and what answers it at once."""

from collections.abc import Callable, Mapping
from math import hypot, radians
from types import MappingProxyType

from link.frames.geodesy import Datum, enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.commands import obey
from sim_autopilot.commands.incoming_parameters import list_parameters, read_parameter, set_parameter
from sim_autopilot.commands.incoming_setpoints import (
    take_attitude_setpoint,
    take_global_setpoint,
    take_landing_target,
    take_leader,
    take_setpoint,
)
from sim_autopilot.commands.mode_request import try_mode
from sim_autopilot.commands.shell import take_typed
from sim_autopilot.files_step import LOG_IDS, take_ftp, take_log_request
from sim_autopilot.flight.manual import sticks_from_message
from sim_autopilot.log_stream_step import take_logging_ack
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, has_passed
from sim_autopilot.missions.step import mission_current, set_current, take_plan
from sim_autopilot.missions.transfer import MESSAGE_IDS
from sim_autopilot.origin import move_origin
from sim_autopilot.requests import is_for_us, is_ours, request_from_message
from sim_autopilot.streams import with_interval

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


def _heartbeat(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    is_station, counted = message.type == mavlink.MAV_TYPE_GCS, memory.settings.failsafes.station_system
    if is_station and not memory.ground_station:
        memory = replace(memory, ground_station=True)
    if is_station if counted is None else message.get_srcSystem() == counted:
        services = memory.services
        watch = replace(services.watch, station_ns=memory.now.boot_ns)
        memory = replace(memory, services=replace(services, watch=watch))
    if message.type == mavlink.MAV_TYPE_ONBOARD_CONTROLLER and message.get_srcSystem() == config.system_id:
        services = memory.services
        watch = replace(services.watch, companion_ns=memory.now.boot_ns)
        memory = replace(memory, services=replace(services, watch=watch))
    return memory, ()


def _command(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not is_for_us(message, config):
        return memory, ()
    return obey(memory, request_from_message(message), config)


def _sticks(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    manual = message.get_msgId() == mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL
    if (message.target if manual else message.target_system) not in {config.system_id, 0}:
        return memory, ()
    services = memory.services
    sticks = sticks_from_message(message, memory.now.boot_ns, services.sticks)
    return replace(memory, services=replace(services, sticks=sticks)), ()


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
    if group is None or not is_ours(message, config):
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
    return take_plan(memory, message, config) if is_ours(message, config) else (memory, ())


def _set_current(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    sent = set_current(memory, message.seq) if is_ours(message, config) else None
    return (memory, ()) if sent is None else (sent, (mission_current(sent, config),))


def _files(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    return take_ftp(memory, message, config) if is_ours(message, config) else (memory, ())


def _logs(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    return take_log_request(memory, message, config) if is_ours(message, config) else (memory, ())


_HANDLERS: Mapping[int, Handler] = MappingProxyType(
    dict.fromkeys(MESSAGE_IDS, _plan)
    | dict.fromkeys(LOG_IDS, _logs)
    | {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: _heartbeat,
        mavlink.MAVLINK_MSG_ID_COMMAND_LONG: _command,
        mavlink.MAVLINK_MSG_ID_COMMAND_INT: _command,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: take_setpoint,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: take_global_setpoint,
        mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: take_attitude_setpoint,
        mavlink.MAVLINK_MSG_ID_LANDING_TARGET: take_landing_target,
        mavlink.MAVLINK_MSG_ID_FOLLOW_TARGET: take_leader,
        mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL: _sticks,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: _sticks,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: list_parameters,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ: read_parameter,
        mavlink.MAVLINK_MSG_ID_PARAM_SET: set_parameter,
        mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN: _set_origin,
        mavlink.MAVLINK_MSG_ID_SET_MODE: _set_mode,
        mavlink.MAVLINK_MSG_ID_REQUEST_DATA_STREAM: _data_stream,
        mavlink.MAVLINK_MSG_ID_MISSION_SET_CURRENT: _set_current,
        mavlink.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: _files,
        mavlink.MAVLINK_MSG_ID_LOGGING_ACK: take_logging_ack,
        mavlink.MAVLINK_MSG_ID_SERIAL_CONTROL: take_typed,
    }
)

HANDLED = frozenset(_HANDLERS)
"""The ids of the messages that are obeyed or answered."""
