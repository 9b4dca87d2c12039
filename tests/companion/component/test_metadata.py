"""The companion's metadata files: read by the bytes of MAVLink FTP, and against the published schemas.

Source of the required fields, of the types and the pattern of names: general.schema.json and parameter.schema.json of
mavlink/mavlink, component_metadata.
"""

import json
import lzma
import re
from typing import Any
from zlib import crc32

import pytest
from pydantic import ValidationError

from companion.component.metadata import (
    GENERAL_PATH,
    PARAMETERS_PATH,
    component_metadata,
    general_file,
    parameters_file,
)
from companion.component.parameters import PARAMETERS, value_of
from companion.config.companion import CompanionConfig
from link.ftp.wire import DATA_MAX, Error, Opcode
from link.mavlink.dialect import COMPONENT_METADATA_ID, Message, mavlink
from tests.companion.component.test_component import OWN, Station
from tests.link.ftp.file_client import FileClient, told

TYPES = {"Uint8", "Int8", "Uint16", "Int16", "Uint32", "Int32", "Float"}
PARAMETER_KEYS = {
    *("name", "type", "shortDesc", "longDesc", "units", "default", "decimalPlaces", "min", "max", "increment"),
    *("rebootRequired", "group", "category", "volatile", "values", "bitmask", "readOnly"),
}
GENERAL_KEYS = {"version", "vendorName", "modelName", "firmwareVersion", "hardwareVersion", "metadataTypes"}
WRITING = [Opcode.CREATE_FILE, Opcode.REMOVE_FILE, Opcode.CREATE_DIRECTORY, Opcode.OPEN_FILE_WO, Opcode.TRUNCATE_FILE]


class CompanionFiles(FileClient):
    """A client of the companion."""

    def __init__(self) -> None:
        super().__init__(self._ask_companion, OWN)
        self.station = Station()
        self.station.setup.run(1.5)

    def _ask_companion(self, question: Message) -> list[Message]:
        before = len(self.station.heard("FILE_TRANSFER_PROTOCOL"))
        self.station.send(question)
        self.station.setup.run(0.05)
        return self.station.heard("FILE_TRANSFER_PROTOCOL")[before:]


@pytest.fixture(scope="module")
def files() -> CompanionFiles:
    return CompanionFiles()


def unpacked(data: bytes) -> dict[str, Any]:
    found = json.loads(lzma.decompress(data))
    assert isinstance(found, dict)
    return found


def inverted_crc32(data: bytes) -> int:
    """The checksum of MAVLink FTP: CRC-32 without the usual inversions."""
    return crc32(data, 0xFFFFFFFF) ^ 0xFFFFFFFF


def test_message_leads_to_the_list_and_the_list_to_the_parameters(files: CompanionFiles) -> None:
    files.station.command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(COMPONENT_METADATA_ID))
    files.station.setup.run(0.1)
    (message,) = files.station.heard("COMPONENT_METADATA")
    uri = bytes(message.uri).rstrip(b"\0").decode() if isinstance(message.uri, bytes) else message.uri
    general = files.read(uri.removeprefix("mftp://").encode())
    assert inverted_crc32(general) == message.file_crc
    (entry,) = unpacked(general)["metadataTypes"]
    parameters = files.read(entry["uri"].removeprefix("mftp://").encode())
    assert inverted_crc32(parameters) == entry["fileCrc"]
    assert [one["name"] for one in unpacked(parameters)["parameters"]] == [one.name for one in PARAMETERS]


def test_burst_brings_the_same_as_single_reads(files: CompanionFiles) -> None:
    whole = files.read(PARAMETERS_PATH.encode())
    files.ask(Opcode.OPEN_FILE_RO, PARAMETERS_PATH.encode())
    answers = files.send(Opcode.BURST_READ_FILE, size=DATA_MAX)
    assert b"".join(told(answer)[3] for answer in answers[:-1]) == whole
    assert told(answers[-1])[3] == bytes([Error.END_OF_FILE])
    files.ask(Opcode.TERMINATE_SESSION)


def test_listing_names_both_files(files: CompanionFiles) -> None:
    names = {line[1:].partition("\t")[0] for line in files.names()}
    assert names == {GENERAL_PATH, PARAMETERS_PATH}


@pytest.mark.parametrize("opcode", WRITING)
def test_nothing_can_be_written(files: CompanionFiles, opcode: Opcode) -> None:
    for path in (b"another", PARAMETERS_PATH.encode()):
        assert files.ask(opcode, path) == (Opcode.NAK, bytes([Error.FILE_PROTECTED]))


def test_general_file_is_as_its_schema_has_it() -> None:
    general = unpacked(general_file())
    assert {"version", "metadataTypes"} <= set(general) <= GENERAL_KEYS
    assert re.fullmatch(r"\d+\.\d+\.\d+(\.\d+)?", general["firmwareVersion"])
    for entry in general["metadataTypes"]:
        assert {"type", "uri"} <= set(entry)
        assert isinstance(entry["type"], int)
        assert isinstance(entry["fileCrc"], int)


def test_parameters_file_is_as_its_schema_has_it() -> None:
    described = unpacked(parameters_file())
    assert set(described) == {"version", "parameters"}
    for one in described["parameters"]:
        assert {"name"} <= set(one) <= PARAMETER_KEYS
        assert re.fullmatch(r"[.\-a-zA-Z0-9_{}]{1,16}", one["name"])
        assert one["type"] in TYPES
        assert all(isinstance(one[key], float) for key in {"default", "min", "max"} & set(one))


@pytest.mark.parametrize("place", range(len(PARAMETERS)), ids=[one.name for one in PARAMETERS])
def test_parameter_is_described_as_the_configuration_has_it(place: int) -> None:
    parameter, one = PARAMETERS[place], unpacked(parameters_file())["parameters"][place]
    assert one["default"] == value_of(CompanionConfig(), parameter)
    assert one["shortDesc"] == parameter.description
    if parameter.is_choice:
        assert [choice["value"] for choice in one["values"]] == [0, 1, 2]
        return
    for beyond in (one["min"] - 1.0, one["max"] + 1.0):
        *tables, key = parameter.key.split(".")
        table: dict[str, Any] = {key: int(beyond) if parameter.is_whole else beyond}
        for name in reversed(tables):
            table = {name: table}
        with pytest.raises(ValidationError):
            CompanionConfig.model_validate(table)


def test_metadata_of_an_autopilot_that_runs_for_50_days_has_a_time_that_fits() -> None:
    assert component_metadata((1 << 32) + 7).time_boot_ms == 7
