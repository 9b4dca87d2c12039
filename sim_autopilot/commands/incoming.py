"""What each received message changes, and what answers it at once."""

from collections.abc import Callable, Mapping
from math import hypot, radians
from types import MappingProxyType

from link.frames.geodesy import Datum, enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.addressees import is_for_us, is_ours
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
from sim_autopilot.commands.origin import move_origin
from sim_autopilot.commands.single_items import is_single_item, take_single_item
from sim_autopilot.commands.stream_groups import request_data_stream
from sim_autopilot.flight.manual import sticks_from_message
from sim_autopilot.interfaces import AutopilotConfig, has_passed
from sim_autopilot.memory import AutopilotMemory, with_link
from sim_autopilot.missions.step import mission_current, set_current
from sim_autopilot.safety.failsafes_step import update_watch

Result = tuple[AutopilotMemory, tuple[Message, ...]]
Handler = Callable[[AutopilotMemory, Message, AutopilotConfig], Result]

_ORIGIN_REACH_M = 1e5
"""An origin farther than this from the datum is a mistake: the flat frame would not serve."""


def take(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after `message` and the answers to it; most messages change nothing."""
    if config.firmware.texts.everybody and not memory.links.here.ground_station:
        memory = _with_station(memory)
    if is_single_item(message, config):
        return take_single_item(memory, message, config)
    served = config.services.handle(memory, message, config)
    if served is not None:
        return served
    handler = _HANDLERS.get(message.get_msgId())
    return (memory, ()) if handler is None else handler(memory, message, config)


def _with_station(memory: AutopilotMemory) -> AutopilotMemory:
    return with_link(memory, replace(memory.links.here, ground_station=True))


def _heartbeat(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    is_station, counted = message.type == mavlink.MAV_TYPE_GCS, memory.tuning.settings.failsafes.station_system
    if is_station and not memory.links.here.ground_station:
        memory = _with_station(memory)
    if is_station if counted is None else message.get_srcSystem() == counted:
        memory = update_watch(memory, replace(memory.safety.watch, station_ns=memory.now.boot_ns))
    if message.type == mavlink.MAV_TYPE_ONBOARD_CONTROLLER and message.get_srcSystem() == config.system_id:
        memory = update_watch(memory, replace(memory.safety.watch, companion_ns=memory.now.boot_ns))
    return memory, ()


def _command(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not is_for_us(message, config):
        return memory, ()
    return obey(memory, message, config)


def _sticks(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    manual = message.get_msgId() == mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL
    if (message.target if manual else message.target_system) not in {config.system_id, 0}:
        return memory, ()
    sticks = sticks_from_message(message, memory.now.boot_ns, memory.heard.sticks)
    return replace(memory, heard=replace(memory.heard, sticks=sticks)), ()


def _set_mode(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """The older way to ask for a mode."""
    wanted, modes = message.custom_mode, config.firmware.modes.codes
    mode = next((mode for mode, code in modes.items() if code.custom_mode == wanted), None)
    custom = message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    if message.target_system != config.system_id or not custom:
        return memory, ()
    result = config.firmware.commands.results.no_such_mode
    if mode is not None:
        memory, result = try_mode(memory, mode, config)
    answered_as = config.firmware.modes.set_mode_answered_as
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


def _set_origin(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Move the local frame under the drone, as PX4 does even in flight."""
    fixed = config.firmware.origin.stays and has_passed(config, memory, config.firmware.condition.readiness.position_s)
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


def _set_current(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    sent = set_current(memory, message.seq) if is_ours(message, config) else None
    return (memory, ()) if sent is None else (sent, (mission_current(sent, config),))


_HANDLERS: Mapping[int, Handler] = MappingProxyType(
    {
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
        mavlink.MAVLINK_MSG_ID_REQUEST_DATA_STREAM: request_data_stream,
        mavlink.MAVLINK_MSG_ID_MISSION_SET_CURRENT: _set_current,
    }
)

HANDLED = frozenset(_HANDLERS)
"""The ids of the messages that are obeyed or answered, besides those of the services."""
