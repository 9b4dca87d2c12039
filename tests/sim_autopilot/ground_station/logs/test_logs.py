"""The log service: a log of each flight, listed, sent and erased."""

import struct
from pathlib import Path

import pytest
from pymavlink.DFReader import DFReader_binary

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.copter import GUIDED, ardupilot, mode, take_off
from tests.sim_autopilot.pilot import START_NS, Pilot, arm, px4
from tests.sim_autopilot.pilot_files import PilotFiles

pytestmark = pytest.mark.slow


def flown(pilot: Pilot) -> Pilot:
    """Armed for two seconds, and disarmed."""
    pilot.step(arm())
    pilot.run(2.0)
    pilot.step(arm(armed=False))
    pilot.run(0.1)
    return pilot


def entries(pilot: Pilot) -> list[Message]:
    replies = pilot.step(mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF))
    return [reply for reply in replies if reply.get_type() == "LOG_ENTRY"]


def download(pilot: Pilot, entry: Message) -> bytes:
    pilot.step(mavlink.MAVLink_log_request_data_message(1, 1, entry.id, 0, 0xFFFFFFFF))
    pilot.run(1.0)
    pieces = sorted((piece.ofs, bytes(piece.data[: piece.count])) for piece in pilot.all("LOG_DATA"))
    return b"".join(piece for _, piece in pieces)


def test_px4_without_logs_says_nothing_and_arducopter_sends_an_entry_of_zeros() -> None:
    assert entries(Pilot()) == []
    (entry,) = entries(Pilot(ardupilot()))
    assert (entry.id, entry.num_logs, entry.size) == (0, 0, 0)


def test_px4_logs_a_flight_as_ulog() -> None:
    pilot = flown(Pilot())
    (entry,) = entries(pilot)
    assert (entry.id, entry.num_logs, entry.time_utc) == (0, 1, START_NS // 10**9)
    data = download(pilot, entry)
    assert len(data) == entry.size
    assert data[:7] == b"ULog\x01\x12\x35"
    kinds, at = [], 16
    while at < len(data):
        size, kind = struct.unpack_from("<Hc", data, at)
        kinds.append(kind)
        at += 3 + size
    assert at == len(data)
    assert kinds[0] == b"B"
    assert kinds.count(b"D") == 11  # five a second, and one when the motors start


def test_arducopter_logs_a_flight_as_dataflash_that_pymavlink_reads(tmp_path: Path) -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm())
    take_off(pilot, 5.0)
    pilot.run(12.0)
    pilot.step(arm(armed=False, force=True))
    pilot.run(0.1)
    (entry,) = entries(pilot)
    assert entry.id == 1
    path = tmp_path / "00000001.BIN"
    path.write_bytes(download(pilot, entry))
    reader = DFReader_binary(str(path))
    heights = []
    while (message := reader.recv_match(type="POS")) is not None:
        heights.append(message.RelOriginAlt)
    reader.data_map.close()
    reader.filehandle.close()
    assert max(heights) > 4.5
    assert len(heights) > 50


def test_arducopter_sends_no_list_while_armed_but_says_why() -> None:
    pilot = flown(Pilot(ardupilot()))
    pilot.step(mode(GUIDED), arm())
    assert entries(pilot) == []
    assert pilot.last("STATUSTEXT").text == "Disarm for log download"


def test_an_erased_log_is_gone() -> None:
    pilot = flown(Pilot())
    pilot.step(mavlink.MAVLink_log_erase_message(1, 1))
    assert entries(pilot) == []


def test_a_log_is_a_file_too() -> None:
    pilot = flown(Pilot(px4()))
    (entry,) = entries(pilot)
    files = PilotFiles(pilot)
    (day,) = files.names(b"/log")
    (name,) = files.names(b"/log/" + day[1:].encode())
    path = f"log/{day[1:]}/{name[1:].partition(chr(9))[0]}"
    assert files.read(path.encode()) == download(pilot, entry)
