"""Component metadata: files that describe the companion's parameters, read from it over MAVLink FTP.

Made of the table of parameters and the configuration's own defaults and bounds. Whoever asks for COMPONENT_METADATA is
told where the list of the files is, and its checksum.
Source: https://mavlink.io/en/services/component_information.html; the schemas in mavlink/mavlink, component_metadata.
QGroundControl takes version 1 only, which PX4's files have, too.
"""

import json
import lzma
import re
from functools import cache
from importlib.metadata import version
from operator import attrgetter
from typing import Any

from annotated_types import Ge, Gt, Le, Lt
from pydantic.fields import FieldInfo

from companion.component.parameters import CHOICES, PARAMETERS, Parameter, value_of
from companion.config.companion import CompanionConfig
from link.ftp.handlers import checksum
from link.ftp.server import answer, burst_on
from link.ftp.state import NO_FTP, FtpRules
from link.ftp.wire import question_from_message
from link.mavlink.dialect import COMPONENT_METADATA_ID, Message, mavlink
from link.program.toml_config import StrictModel

GENERAL_PATH = "general.json.xz"
PARAMETERS_PATH = "parameters.json.xz"
_VERSION = 1
_PARAMETERS_TYPE = 1  # COMP_METADATA_TYPE_PARAMETER
_UNITS = {"_m_s": "m/s", "_m": "m", "_s": "s", "_share": "norm"}
_UNIT = re.compile("|".join(f"{ending}$" for ending in _UNITS))
_FIRST_NUMBERS = re.compile(r"\d+\.\d+\.\d+")


def component_metadata(boot_ms: int) -> Message:
    """Return the COMPONENT_METADATA, `boot_ms` after the autopilot's start."""
    return mavlink.mavlink_map[COMPONENT_METADATA_ID](
        boot_ms & 0xFFFF_FFFF, checksum(general_file()), f"mftp://{GENERAL_PATH}".encode()
    )


@cache
def general_file() -> bytes:
    """Return the list of the other files."""
    numbers = _FIRST_NUMBERS.match(version("decklander"))
    told: dict[str, object] = {"version": _VERSION, "vendorName": "Decklander", "modelName": "companion"}
    if numbers is not None:
        told["firmwareVersion"] = numbers.group()
    parameters = {
        "type": _PARAMETERS_TYPE,
        "uri": f"mftp://{PARAMETERS_PATH}",
        "fileCrc": checksum(parameters_file()),
    }
    return _compress(told | {"metadataTypes": [parameters]})


@cache
def parameters_file() -> bytes:
    """Return what is to be known of each parameter."""
    default = CompanionConfig()
    return _compress({"version": _VERSION, "parameters": [_describe(one, default) for one in PARAMETERS]})


def _describe(one: Parameter, default: CompanionConfig) -> dict[str, Any]:
    told = {
        "name": one.name,
        "type": "Float",
        "shortDesc": one.description,
        "longDesc": f"{one.key} of the configuration. It can be set between two flights, until the companion ends.",
        "default": value_of(default, one),
        "decimalPlaces": 0 if one.is_whole else 2,
        "group": "Decklander",
    }
    unit = _UNIT.search(one.key)
    if unit is not None:
        told["units"] = _UNITS[unit.group()]
    if one.is_choice:
        told["values"] = [{"value": place, "description": name.value} for place, name in enumerate(CHOICES)]
    return told | _bounds(_field(default, one.key))


def _field(config: CompanionConfig, key: str) -> FieldInfo:
    """Return the field of the configuration that `key` names."""
    *tables, name = key.split(".")
    model: type[StrictModel] = type(attrgetter(".".join(tables))(config))
    return model.model_fields[name]


def _bounds(field: FieldInfo) -> dict[str, float]:
    """Return the least and the largest value of a field, as far as it has bounds."""
    found: dict[str, float] = {}
    for bound in field.metadata:
        match bound:
            case Ge(least) | Gt(least):
                found["min"] = float(str(least))
            case Le(most) | Lt(most):
                found["max"] = float(str(most))
            case _:
                pass
    return found


def _compress(content: object) -> bytes:
    return lzma.compress(json.dumps(content, separators=(",", ":")).encode(), check=lzma.CHECK_CRC32)


_FILES = {GENERAL_PATH: general_file, PARAMETERS_PATH: parameters_file}
_RULES = FtpRules(is_read_only=True, burst_a_step=1)  # setpoints share the link


class FileServer:
    """The server of these files, which answers one client after the other."""

    def __init__(self) -> None:
        general_file()  # both are made now: it takes as long as a step has
        self._ftp = NO_FTP

    def answer(self, message: Message, local_ns: int) -> tuple[Message, ...]:
        """Take a FILE_TRANSFER_PROTOCOL; return its answer."""
        self._ftp, answers = answer(self._ftp, question_from_message(message), _FILES, _RULES, local_ns)
        return answers

    def continue_burst(self) -> tuple[Message, ...]:
        """Return what of a burst under way goes now."""
        self._ftp, messages = burst_on(self._ftp, _RULES)
        return messages
