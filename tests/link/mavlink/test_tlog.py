import os
import struct
from pathlib import Path

import pytest
from pymavlink import mavutil

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.peer import companion_heartbeat
from link.mavlink.tlog import TlogFrames, TlogSink, TlogWriter
from tests.link.mavlink.tlog_frames import frames_of

T_NS = 1_795_220_114_620_015_999


def test_a_recording_is_read_back_by_mavutil_in_both_directions(tmp_path: Path) -> None:
    path = tmp_path / "run.tlog"
    autopilot, companion = MavlinkCodec(1, 1), MavlinkCodec(1, 191)
    with TlogWriter(path) as tlog:
        for k in range(5):
            beat = mavlink.MAVLink_heartbeat_message(2, 12, 0, k, 4, 3)
            tlog.write(autopilot.encode(beat), T_NS + 2 * k * 1_000_000)
            tlog.write(companion.encode(mavlink.MAVLink_timesync_message(0, k + 1)), T_NS + (2 * k + 1) * 1_000_000)
    log = mavutil.mavlink_connection(str(path))
    read = [log.recv_msg() for _ in range(10)]
    assert log.recv_msg() is None
    log.close()
    assert [one.get_srcComponent() for one in read] == [1, 191] * 5
    assert [one.custom_mode for one in read[::2]] == list(range(5))
    for k, message in enumerate(read):
        assert message._timestamp == pytest.approx((T_NS // 1000 + 1000 * k) / 1e6, abs=1e-6)  # noqa: SLF001 (its only name)


def test_times_are_whole_microseconds_big_endian_before_the_frame(tmp_path: Path) -> None:
    path = tmp_path / "run.tlog"
    with TlogWriter(path) as tlog:
        tlog.write(b"frame", T_NS)
    assert path.read_bytes() == struct.pack(">Q", 1_795_220_114_620_015) + b"frame"


def test_a_recording_that_is_there_is_kept_and_the_new_one_gets_the_next_number(tmp_path: Path) -> None:
    path = tmp_path / "run.tlog"
    for word in (b"one", b"two", b"three"):
        with TlogWriter(path) as tlog:
            tlog.write(word, T_NS)
    ends = {file.name: file.read_bytes()[8:] for file in tmp_path.iterdir()}
    assert ends == {"run.tlog": b"one", "run_2.tlog": b"two", "run_3.tlog": b"three"}


def test_a_place_that_cannot_be_written_is_one_clear_line(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no/run\.tlog: cannot be written"):
        TlogWriter(tmp_path / "no" / "run.tlog")


def test_frames_are_read_as_they_were_written_and_a_cut_end_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "run.tlog"
    frames = [MavlinkCodec(1, 191).encode(companion_heartbeat()), MavlinkCodec(7, 1).encode(companion_heartbeat())]
    with TlogWriter(path) as tlog:
        for k, frame in enumerate(frames):
            tlog.write(frame, T_NS + 1000 * k)
    whole = path.read_bytes()
    whole_us = T_NS // 1000 * 1000
    assert list(frames_of(whole + whole[:9])) == [(whole_us, frames[0]), (whole_us + 1000, frames[1])]


def test_what_is_no_recording_is_refused_with_the_place() -> None:
    with pytest.raises(ValueError, match="no frame at byte 8"):
        list(frames_of(bytes(8) + b"\xfd\x03\x7f" + bytes(20)))


def test_a_power_failure_costs_the_last_second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    on_disk: list[int] = []
    monkeypatch.setattr(os, "fdatasync", lambda number: on_disk.append(os.fstat(number).st_size))
    sink = TlogSink(tmp_path / "run.tlog")
    for k in range(25):
        sink.write(TlogFrames([b"frame", b"answer"], T_NS + k * 100_000_000))
    sink.write(TlogFrames([b"frame", b"answer"], T_NS - 3_600_000_000_000))
    sink.close()
    a_record = TlogFrames([b"frame", b"answer"], T_NS).size()
    assert a_record == 2 * 8 + len(b"frame") + len(b"answer")
    assert on_disk == [a_record, 11 * a_record, 21 * a_record, 26 * a_record, 26 * a_record]
