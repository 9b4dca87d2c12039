"""The messages of the parameter protocol, and what answers them.

Source: https://mavlink.io/en/services/parameter.html.
"""

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.boot import tune
from sim_autopilot.commands.addressees import is_ours
from sim_autopilot.core.links import Later
from sim_autopilot.core.parameters import find_index, is_type_right, parameter_message, values_after_set
from sim_autopilot.core.status_texts import status_text
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory, with_later, with_link

Result = tuple[AutopilotMemory, tuple[Message, ...]]


def list_parameters(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Begin to send all parameters on the link at hand."""
    if not is_ours(message, config):
        return memory, ()
    return with_link(memory, replace(memory.links.here, listing=0)), banner(config)


def banner(config: AutopilotConfig) -> tuple[Message, ...]:
    """Return the texts about the build, for whoever asked on his link."""
    return tuple(status_text(mavlink.MAV_SEVERITY_INFO, text) for text in config.firmware.parameters.banner)


def read_parameter(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Send one parameter."""
    parameters = config.firmware.parameters.table
    index = find_index(parameters, message.param_id, message.param_index)
    if index is None or not is_ours(message, config):
        return memory, ()
    tells_index = config.firmware.parameters.tells_indices or message.param_index >= 0
    autopilot_id = config.firmware.identity.autopilot_id
    return memory, (parameter_message(parameters, index, memory.tuning.values, autopilot_id, tells_index=tells_index),)


def with_value(memory: AutopilotMemory, name: str, value: float, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory with one parameter changed."""
    values = {**memory.tuning.values, name: value}
    return replace(memory, tuning=tune(config, values))


def set_parameter(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Set a parameter, and tell its value on every link."""
    parameters, autopilot_id = config.firmware.parameters.table, config.firmware.identity.autopilot_id
    index = find_index(parameters, message.param_id)
    if index is None or not is_ours(message, config):
        return memory, ()
    lenient = config.firmware.parameters.lenient
    if not lenient and not is_type_right(parameters[index], message):
        return memory, ()
    values = values_after_set(parameters, index, memory.tuning.values, message, autopilot_id, lenient=lenient)
    memory = replace(memory, tuning=tune(config, values))
    tells_index = config.firmware.parameters.tells_indices
    told = parameter_message(parameters, index, values, autopilot_id, tells_index=tells_index)
    return with_later(memory, Later(boot_ns=memory.now.boot_ns, message=told)), ()
