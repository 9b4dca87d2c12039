"""MAVLink FTP: files shown, read, written, and refused as each firmware's server does."""

import json
import lzma
import struct
from itertools import pairwise

import pytest

from link.ftp.handlers import checksum
from link.ftp.wire import DATA_MAX, Error, Opcode
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.px4.px4 import PX4
from tests.link.ftp.file_client import told
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import Pilot
from tests.sim_autopilot.pilot_files import PilotFiles

GENERAL = b"etc/extras/component_general.json.xz"


@pytest.fixture
def px4_files() -> PilotFiles:
    return PilotFiles(Pilot())


@pytest.fixture
def copter_files() -> PilotFiles:
    return PilotFiles(Pilot(ardupilot()))


def unpacked(data: bytes) -> dict[str, tuple[int, float]]:
    """Type and value by name, of a parameter file."""
    magic, count, total = struct.unpack_from("<HHH", data)
    assert (magic, count) == (0x671B, total)
    kinds, at, name, values = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}, 6, "", {}
    while at < len(data):
        kind, lengths = data[at] & 0x0F, data[at + 1]
        rest = 1 + (lengths >> 4)
        name = name[: lengths & 0x0F] + data[at + 2 : at + 2 + rest].decode()
        (value,) = struct.unpack_from(kinds[kind], data, at + 2 + rest)
        values[name] = (kind, value)
        at += 2 + rest + struct.calcsize(kinds[kind])
    assert len(values) == count
    return values


def test_arducopters_parameter_file_holds_every_parameter(copter_files: PilotFiles) -> None:
    values = unpacked(copter_files.read(b"@PARAM/param.pck"))
    assert list(values) == [parameter.name for parameter in ARDUPILOT.parameters.table]
    assert values["WPNAV_SPEED"] == (4, 1000.0)
    assert values["SYSID_THISMAV"] == (2, 1)


@pytest.mark.slow
def test_px4_describes_its_parameters_in_a_file_whose_checksum_is_told(px4_files: PilotFiles) -> None:
    general = json.loads(lzma.decompress(px4_files.read(GENERAL)))
    (entry,) = (one for one in general["metadataTypes"] if one["type"] == 1)
    packed = px4_files.read(entry["uri"].removeprefix("mftp://").encode())
    assert checksum(packed) == entry["fileCrc"]
    described = {one["name"]: one for one in json.loads(lzma.decompress(packed))["parameters"]}
    assert len(described) == len(PX4.parameters.table)
    assert described["MPC_XY_VEL_MAX"]["default"] == 12.0


@pytest.mark.parametrize(("client", "path"), [("px4_files", GENERAL), ("copter_files", b"@PARAM/param.pck")])
def test_a_burst_brings_a_whole_file_and_then_its_end(client: str, path: bytes, request: pytest.FixtureRequest) -> None:
    files: PilotFiles = request.getfixturevalue(client)
    whole = files.read(path)
    files.ask(Opcode.OPEN_FILE_RO, path)
    answers = files.send(Opcode.BURST_READ_FILE, size=DATA_MAX)
    files.pilot.run(2.0)
    answers = files.pilot.all("FILE_TRANSFER_PROTOCOL")[-len(whole) // DATA_MAX - 1 :]
    opcodes = [told(answer)[0] for answer in answers]
    assert opcodes == [Opcode.ACK] * (len(answers) - 1) + [Opcode.NAK]
    assert b"".join(told(answer)[3] for answer in answers[:-1]) == whole
    assert told(answers[-1])[3] == bytes([Error.END_OF_FILE])
    sequences = [struct.unpack_from("<H", bytes(answer.payload))[0] for answer in answers]
    assert all(b == a + 1 for a, b in pairwise(sequences))


@pytest.mark.parametrize("client", ["px4_files", "copter_files"])
def test_a_written_file_is_listed_read_renamed_and_removed(client: str, request: pytest.FixtureRequest) -> None:
    files: PilotFiles = request.getfixturevalue(client)
    data = bytes(range(200)) * 3
    assert files.ask(Opcode.CREATE_DIRECTORY, b"/notes")[0] == Opcode.ACK
    assert files.ask(Opcode.CREATE_FILE, b"/notes/one.txt")[0] == Opcode.ACK
    for offset in range(0, len(data), 200):
        assert files.ask(Opcode.WRITE_FILE, data[offset : offset + 200], offset=offset)[0] == Opcode.ACK
    files.ask(Opcode.TERMINATE_SESSION)
    assert files.names(b"/notes") == ["Fone.txt\t600"]
    assert files.read(b"notes/one.txt") == data
    opcode, crc = files.ask(Opcode.CALC_FILE_CRC32, b"notes/one.txt")
    assert (opcode, int.from_bytes(crc, "little")) == (Opcode.ACK, checksum(data))
    assert files.ask(Opcode.RENAME, b"notes/one.txt\0notes/two.txt")[0] == Opcode.ACK
    assert files.ask(Opcode.OPEN_FILE_RO, b"notes/one.txt") == (Opcode.NAK, bytes([Error.FILE_NOT_FOUND]))
    assert files.ask(Opcode.REMOVE_FILE, b"notes/two.txt")[0] == Opcode.ACK
    assert files.ask(Opcode.REMOVE_DIRECTORY, b"notes")[0] == Opcode.ACK
    assert "Dnotes" not in files.names()


def test_a_checksum_is_the_one_that_both_servers_reckon() -> None:
    register = 0
    for byte in b"123456789":
        register ^= byte
        for _ in range(8):
            register = register >> 1 ^ (0xEDB88320 if register & 1 else 0)
    assert checksum(b"123456789") == register


@pytest.mark.slow
def test_a_second_file_is_refused_as_each_firmware_says_until_the_first_was_idle(
    px4_files: PilotFiles, copter_files: PilotFiles
) -> None:
    for files, path, error, idle_s in (
        (px4_files, GENERAL, Error.NO_SESSIONS_AVAILABLE, 10.1),
        (copter_files, b"@PARAM/param.pck", Error.FAIL, 3.1),
    ):
        files.ask(Opcode.OPEN_FILE_RO, path)
        assert files.ask(Opcode.OPEN_FILE_RO, path) == (Opcode.NAK, bytes([error]))
        files.pilot.run(idle_s)
        assert files.ask(Opcode.OPEN_FILE_RO, path)[0] == Opcode.ACK


def test_a_question_asked_again_is_answered_again_and_done_once(px4_files: PilotFiles) -> None:
    px4_files.ask(Opcode.CREATE_DIRECTORY, b"/notes")
    px4_files.sequence -= 2
    assert px4_files.ask(Opcode.CREATE_DIRECTORY, b"/notes")[0] == Opcode.ACK
    assert px4_files.ask(Opcode.CREATE_DIRECTORY, b"/notes") == (Opcode.NAK, bytes([Error.FILE_EXISTS]))


def test_the_autopilots_own_files_cannot_be_written(px4_files: PilotFiles) -> None:
    assert px4_files.ask(Opcode.REMOVE_FILE, GENERAL)[0] == Opcode.NAK
    assert px4_files.ask(Opcode.OPEN_FILE_WO, GENERAL)[0] == Opcode.NAK
    assert px4_files.ask(Opcode.OPEN_FILE_RO, GENERAL)[0] == Opcode.ACK


def test_clients_cannot_fill_the_memory(px4_files: PilotFiles) -> None:
    px4_files.ask(Opcode.CREATE_FILE, b"/large")
    assert px4_files.ask(Opcode.WRITE_FILE, b"x", offset=2**32 - 10)[0] == Opcode.NAK
