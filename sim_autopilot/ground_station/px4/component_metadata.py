"""PX4's component metadata: files about parameters, events and actuators, as ground stations read them over FTP.

Source: https://mavlink.io/en/services/component_information.html. Names, types and defaults of all parameters;
ranges of those that the flight obeys, the events that are sent, the four motors of the simulated quadrotor, and the
sixteen outputs of its simulation.
"""

import json
import lzma
from functools import cache, partial

from link.ftp.handlers import checksum
from link.ftp.store import Shown
from link.mavlink.dialect import COMPONENT_METADATA_ID, Message, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.parameters import Parameter, Values
from sim_autopilot.firmware.px4.modes import MODES
from sim_autopilot.firmware.px4.parameters import OBEYED
from sim_autopilot.ground_station.px4.event_metadata import EVENTS_PATH, events_description
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.status import boot_ms

ACTUATORS_PATH = "etc/extras/actuators.json.xz"
_MOTORS, _OUTPUTS = 4, 16
_FIRST_MOTOR, _LAST_MOTOR = 101, 112
"""The numbers of the functions that are motors; 0 is none."""
GENERAL_PATH = "etc/extras/component_general.json.xz"
PARAMETERS_PATH = "etc/extras/parameters.json.xz"
_PARAMETER_METADATA, _EVENTS_METADATA, _ACTUATORS_METADATA = 1, 4, 5
"""COMP_METADATA_TYPE."""
_TYPES = {
    int(mavlink.MAV_PARAM_TYPE_INT8): "Int8",
    int(mavlink.MAV_PARAM_TYPE_INT16): "Int16",
    int(mavlink.MAV_PARAM_TYPE_INT32): "Int32",
    int(mavlink.MAV_PARAM_TYPE_REAL32): "Float",
}

CustomModes = tuple[tuple[Mode, int], ...]
"""Each mode's number in the heartbeat."""
_OBEYED = frozenset(parameter.name for parameter in OBEYED)
_CUSTOM_MODES = tuple((mode, code.custom_mode) for mode, code in MODES.codes.items())


def shown_files(parameters: tuple[Parameter, ...], _values: Values) -> Shown:
    """Return PX4's own files."""
    return {
        GENERAL_PATH: partial(general_file, parameters, _OBEYED, _CUSTOM_MODES),
        ACTUATORS_PATH: actuators_file,
        EVENTS_PATH: partial(events_file, _CUSTOM_MODES),
        PARAMETERS_PATH: partial(parameters_file, parameters, _OBEYED),
    }


def component_metadata(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return COMPONENT_METADATA: where the list of the files is."""
    general = general_file(config.firmware.parameters.table, _OBEYED, _CUSTOM_MODES)
    uri = f"mftp://{GENERAL_PATH}".encode()
    return mavlink.mavlink_map[COMPONENT_METADATA_ID](boot_ms(memory), checksum(general), uri)


@cache
def parameters_file(parameters: tuple[Parameter, ...], obeyed: frozenset[str]) -> bytes:
    """Return the description of `parameters`, with the ranges of those that are `obeyed`."""
    return _compress({"version": 1, "parameters": [_describe(one, obeyed) for one in parameters]})


@cache
def general_file(parameters: tuple[Parameter, ...], obeyed: frozenset[str], modes: CustomModes) -> bytes:
    """Return the list of the descriptions, with the checksum of each."""
    files = (
        (_PARAMETER_METADATA, PARAMETERS_PATH, parameters_file(parameters, obeyed)),
        (_EVENTS_METADATA, EVENTS_PATH, events_file(modes)),
        (_ACTUATORS_METADATA, ACTUATORS_PATH, actuators_file()),
    )
    entries = [{"type": kind, "uri": f"mftp://{path}", "fileCrc": checksum(data)} for kind, path, data in files]
    return _compress({"version": 1, "metadataTypes": entries})


@cache
def events_file(modes: CustomModes) -> bytes:
    """Return the description of the events, and of the modes that the report on arming tells of."""
    return _compress(events_description(dict(modes)))


@cache
def actuators_file() -> bytes:
    """Return the description of the outputs."""
    return _compress(actuators_description())


def _describe(parameter: Parameter, obeyed: frozenset[str]) -> dict[str, str | float]:
    described: dict[str, str | float] = {
        "name": parameter.name,
        "type": _TYPES[parameter.mavlink_type],
        "default": parameter.default,
        "shortDesc": parameter.name,
        "group": parameter.name.partition("_")[0],
    }
    return described | {"min": parameter.lowest, "max": parameter.highest} if parameter.name in obeyed else described


def _compress(content: object) -> bytes:
    return lzma.compress(json.dumps(content, separators=(",", ":")).encode(), check=lzma.CHECK_CRC32)


def actuators_description() -> dict[str, object]:
    """Return which functions there are, which outputs, and what the mixer drives."""
    motors = {str(_FIRST_MOTOR + place): {"label": f"Motor {place + 1}"} for place in range(_MOTORS)}
    channels = [{"label": f"Channel {number}", "param-index": number} for number in range(1, _OUTPUTS + 1)]
    function = {"label": "Function", "name": "PWM_MAIN_FUNC${i}", "function": "function"}
    outputs = {"label": "SIM", "subgroups": [{"channels": channels, "per-channel-parameters": [function]}]}
    motor = {
        "function-min": _FIRST_MOTOR,
        "function-max": _LAST_MOTOR,
        "label-index-offset": 1,
        "values": {"min": 0, "max": 1, "default-is-nan": True},
    }
    group = {"group-label": "Motors", "count": _MOTORS, "actuator-type": "motor", "required": True}
    mixer = {"actuator-types": {"motor": motor}, "config": [{"title": "Multirotor", "actuators": [group]}]}
    return {
        "version": 1,
        "functions_v1": {"0": {"label": "Disabled"}, **motors},
        "outputs_v1": [outputs],
        "mixer_v1": mixer,
    }
