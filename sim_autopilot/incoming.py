"""What each received message changes, and what answers it at once."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import hypot, radians
from types import MappingProxyType

from link.geodesy import Datum, enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.commands import is_for_us, obey, request_from_message
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, limited
from sim_autopilot.mode_change import change_mode
from sim_autopilot.modes import Event
from sim_autopilot.parameters import find_index, parameter_message, values_after_set
from sim_autopilot.setpoints import reference_from_message, with_setpoint
from sim_autopilot.telemetry_motion import gps_global_origin

Result = tuple[AutopilotMemory, tuple[Message, ...]]
Handler = Callable[[AutopilotMemory, Message, AutopilotConfig], Result]

_ORIGIN_REACH_M = 1e5
"""An origin farther than this from the datum is a mistake: the flat frame would not serve."""


def take(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Return the memory after `message` and the answers to it; most messages change nothing."""
    handler = _HANDLERS.get(message.get_msgId())
    return (memory, ()) if handler is None else handler(memory, message, config)


def _is_ours(message: Message, config: AutopilotConfig) -> bool:
    """Whether a message that is no command is meant for this autopilot; 0 is everybody."""
    components = (mavlink.MAV_COMP_ID_AUTOPILOT1, mavlink.MAV_COMP_ID_ALL)
    return message.target_system in (config.system_id, 0) and message.target_component in components


def _heartbeat(memory: AutopilotMemory, message: Message, _config: AutopilotConfig) -> Result:
    if message.type == mavlink.MAV_TYPE_GCS and not memory.ground_station:
        memory = replace(memory, ground_station=True)
    return memory, ()


def _command(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not is_for_us(message, config):
        return memory, ()
    return obey(memory, request_from_message(message), config)


def _setpoint(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    if not _is_ours(message, config):
        return memory, ()
    now = memory.now
    origin = memory.origin.position_enu_m
    reference = reference_from_message(message, config.firmware.setpoint_frames, origin, now.yaw_rad)
    if reference is None:
        return memory, ()
    setpoints = with_setpoint(memory.setpoints, reference, now.boot_ns, memory.settings.setpoint_loss_s)
    return change_mode(replace(memory, setpoints=setpoints), Event.SETPOINTS_BACK), ()


def _parameter_list(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    return (replace(memory, listing=0) if _is_ours(message, config) else memory), ()


def _parameter_read(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    parameters = config.firmware.parameters
    index = find_index(parameters, message.param_id, message.param_index)
    if index is None or not _is_ours(message, config):
        return memory, ()
    return memory, (parameter_message(parameters, index, memory.values, config.firmware.autopilot_id),)


def _parameter_set(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    parameters, autopilot_id = config.firmware.parameters, config.firmware.autopilot_id
    index = find_index(parameters, message.param_id)
    if index is None or not _is_ours(message, config):
        return memory, ()
    values = values_after_set(parameters, index, memory.values, message, autopilot_id)
    settings = config.firmware.settings(values)
    memory = replace(memory, values=values, settings=settings, plant_config=limited(config.plant, settings))
    return memory, (parameter_message(parameters, index, values, autopilot_id),)


def _set_origin(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Move the local frame under the drone, as PX4 does even in flight."""
    if message.target_system not in (config.system_id, 0):
        return memory, ()
    latitude_rad, longitude_rad = radians(message.latitude * 1e-7), radians(message.longitude * 1e-7)
    try:
        datum = Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=message.altitude * 1e-3)
    except ValueError:
        return memory, ()
    position = enu_from_geodetic(config.datum, datum.latitude_rad, datum.longitude_rad, datum.altitude_m)
    if hypot(*position) > _ORIGIN_REACH_M:
        return memory, ()
    origin = replace(memory.origin, datum=datum, position_enu_m=position, resets=memory.origin.resets + 1)
    memory = replace(memory, origin=origin)
    return memory, (gps_global_origin(memory, config),)


_HANDLERS: Mapping[int, Handler] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: _heartbeat,
        mavlink.MAVLINK_MSG_ID_COMMAND_LONG: _command,
        mavlink.MAVLINK_MSG_ID_COMMAND_INT: _command,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: _setpoint,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: _parameter_list,
        mavlink.MAVLINK_MSG_ID_PARAM_REQUEST_READ: _parameter_read,
        mavlink.MAVLINK_MSG_ID_PARAM_SET: _parameter_set,
        mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN: _set_origin,
    }
)
