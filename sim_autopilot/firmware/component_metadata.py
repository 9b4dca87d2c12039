"""PX4's component metadata: files about parameters, events and actuators, as ground stations read them over FTP.

Source: https://mavlink.io/en/services/component_information.html. Names, types and defaults of all parameters;
ranges of those that the flight obeys, and the events that are sent.
"""

import json
import lzma
from functools import cache

from link.mavlink.dialect import mavlink
from sim_autopilot.files.ftp_handlers import checksum
from sim_autopilot.firmware.actuator_metadata import ACTUATORS_PATH, actuators_description
from sim_autopilot.firmware.event_metadata import EVENTS_PATH, events_description
from sim_autopilot.flight.modes import Mode
from sim_autopilot.parameters import Parameter

GENERAL_PATH = "etc/extras/component_general.json.xz"
PARAMETERS_PATH = "etc/extras/parameters.json.xz"
COMPONENT_METADATA, PROTOCOL_VERSION = 397, 300
"""Messages that pymavlink names nowhere."""
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


@cache
def parameters_file(parameters: tuple[Parameter, ...], obeyed: frozenset[str]) -> bytes:
    """Return the description of `parameters`, with the ranges of those that are `obeyed`."""
    return _compressed({"version": 1, "parameters": [_described(one, obeyed) for one in parameters]})


@cache
def general_file(parameters: tuple[Parameter, ...], obeyed: frozenset[str], modes: CustomModes) -> bytes:
    """Return the list of the descriptions, with the checksum of each."""
    files = (
        (_PARAMETER_METADATA, PARAMETERS_PATH, parameters_file(parameters, obeyed)),
        (_EVENTS_METADATA, EVENTS_PATH, events_file(modes)),
        (_ACTUATORS_METADATA, ACTUATORS_PATH, actuators_file()),
    )
    entries = [{"type": kind, "uri": f"mftp://{path}", "fileCrc": checksum(data)} for kind, path, data in files]
    return _compressed({"version": 1, "metadataTypes": entries})


@cache
def events_file(modes: CustomModes) -> bytes:
    """Return the description of the events, and of the modes that the report on arming tells of."""
    return _compressed(events_description(dict(modes)))


@cache
def actuators_file() -> bytes:
    """Return the description of the outputs."""
    return _compressed(actuators_description())


def _described(parameter: Parameter, obeyed: frozenset[str]) -> dict[str, str | float]:
    described: dict[str, str | float] = {
        "name": parameter.name,
        "type": _TYPES[parameter.mavlink_type],
        "default": parameter.default,
        "shortDesc": parameter.name,
        "group": parameter.name.partition("_")[0],
    }
    return described | {"min": parameter.lowest, "max": parameter.highest} if parameter.name in obeyed else described


def _compressed(content: object) -> bytes:
    return lzma.compress(json.dumps(content, separators=(",", ":")).encode(), check=lzma.CHECK_CRC32)
