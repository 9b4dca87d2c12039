"""Recordings as files: read by an independent reader, cut off anywhere, rotated, and on a disk that is full."""

import os
import shutil
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from link.errors import UserError
from link.payloads.decklander_msgs import DEFINITIONS, PACKAGE, RosMessage, fields_of, floats, ros_message
from link.recording import mcap_writer
from link.recording.file_names import present_files
from link.recording.mcap_reader import read_head, read_messages, recording_files, recordings
from link.recording.mcap_writer import McapRecording, RecordingSpec
from link.recording.recorder import RecordsLost


def _setpoint(index: int) -> RosMessage:
    return ros_message(
        "decklander/drone/setpoint",
        "Setpoint",
        10**18 + index,
        position_m=floats((0.1 * index, 2.0, 3.0)),
        velocity_m_s=floats(None),
        acceleration_m_s2=floats((1.0, 2.0, 3.0)),
        yaw_rad=0.001 * index,
    )


def _write(folder: Path, count: int, file_max_bytes: int = 10**8, total_max_bytes: int = 10**9) -> list[Path]:
    spec = RecordingSpec(
        folder=folder,
        stem="test",
        metadata={"seed": "3"},
        attachments={"a.toml": "x = 1\n"},
        file_max_bytes=file_max_bytes,
        total_max_bytes=total_max_bytes,
    )
    recording = McapRecording(spec)
    for index in range(count):
        recording.add(_setpoint(index), 10**18 + index)
    recording.close()
    return recording_files(folder, "test")


def test_recording_is_decoded_by_rosbags_from_the_definitions_inside(tmp_path: Path) -> None:
    (file,) = _write(tmp_path, 300)
    with AnyReader([file]) as reader:
        yaw_rad = [
            reader.deserialize(raw, connection.msgtype).yaw_rad  # type: ignore[attr-defined]  # made by rosbags
            for connection, _, raw in reader.messages()
        ]
    assert yaw_rad == [0.001 * index for index in range(300)]


def test_recording_holds_its_metadata_and_attachments(tmp_path: Path) -> None:
    head = read_head(_write(tmp_path, 1)[0])
    assert head.metadata == {"seed": "3"}
    assert head.attachments == {"a.toml": "x = 1\n"}


def test_every_message_of_ours_has_a_definition_that_rosbags_reads_alone() -> None:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: PLC0415 (slow to load)

    from link.payloads.decklander_msgs import definition  # noqa: PLC0415 (with the type library)

    for name in DEFINITIONS:
        store = get_typestore(Stores.EMPTY)
        store.register(get_types_from_msg(definition(f"{PACKAGE}/{name}").split("=" * 80)[0], f"{PACKAGE}/{name}"))
        assert f"{PACKAGE}/{name}" in store.types


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.3, 0.8, 0.999])
def test_file_that_breaks_off_is_read_up_to_there(tmp_path: Path, share: float) -> None:
    (file,) = _write(tmp_path, 20_000)
    data = file.read_bytes()
    file.write_bytes(data[: int(share * len(data))])
    yaws = [fields_of(one.message.payload, one.message.type_name)["yaw_rad"] for one in read_messages([file])]
    assert len(yaws) > 1_000
    assert yaws == [0.001 * index for index in range(len(yaws))]


@pytest.mark.slow
def test_files_are_rotated_and_the_oldest_deleted_at_the_limit(tmp_path: Path) -> None:
    files = _write(tmp_path, 30_000, file_max_bytes=100_000, total_max_bytes=250_000)
    assert 2 <= len(files) <= 3
    assert files[0].name != "test_000.mcap"
    assert sum(file.stat().st_size for file in files) <= 250_000
    kept = [recorded.log_ns - 10**18 for recorded in read_messages(files)]
    assert kept == list(range(kept[0], 30_000))
    assert all(read_head(file).metadata == {"seed": "3"} for file in files)


def test_each_start_has_files_of_its_own_and_leaves_those_before_as_they_are(tmp_path: Path) -> None:
    first = _write(tmp_path, 300)
    before = [file.read_bytes() for file in first]
    second = _write(tmp_path, 500)
    third = _write(tmp_path, 10)
    assert [file.read_bytes() for file in first] == before
    assert recordings(tmp_path, "test") == [first, second, third]
    assert [len(list(read_messages(files))) for files in recordings(tmp_path, "test")] == [300, 500, 10]
    assert [file.name for file in (*first, *second, *third)] == [
        "test_000.mcap",
        "test_2_000.mcap",
        "test_3_000.mcap",
    ]


@pytest.mark.slow
def test_limit_of_all_files_counts_those_of_earlier_starts(tmp_path: Path) -> None:
    for _ in range(12):
        _write(tmp_path, 5_000, file_max_bytes=100_000, total_max_bytes=350_000)
    files = [file for start in recordings(tmp_path, "test") for file in start]
    assert sum(file.stat().st_size for file in files) <= 350_000
    numbers = [file.start for file in present_files(tmp_path, "test")]
    assert numbers[-1] == 12
    assert numbers == sorted(numbers)
    assert min(numbers) > 1


def _add(recording: McapRecording, indices: range) -> None:
    for index in indices:
        recording.add(_setpoint(index), index)


def _lost(recording: McapRecording, indices: range) -> int:
    """Add messages; return how many were lost."""
    lost = 0
    for index in indices:
        try:
            recording.add(_setpoint(index), index)
        except RecordsLost as error:
            lost += error.count
        except OSError:
            lost += 1
    return lost


@pytest.mark.slow
def test_write_that_fails_is_told_and_leaves_a_readable_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = mcap_writer._WholeRecords.write  # noqa: SLF001 (where a disk fills up)

    def full_at_50_kb(file: mcap_writer._WholeRecords, data: bytes) -> int:
        if file.size + len(data) > 50_000:
            raise OSError(28, "No space left on device")
        return whole(file, data)

    monkeypatch.setattr(mcap_writer._WholeRecords, "write", full_at_50_kb)  # noqa: SLF001 (where a disk fills up)
    recording = McapRecording(RecordingSpec(folder=tmp_path, stem="test"))
    lost = _lost(recording, range(20_000))
    recording.close()
    files = recording_files(tmp_path, "test")
    assert lost > 1_000
    assert len(files) > 1
    assert all(file.stat().st_size <= 50_000 for file in files)
    assert sum(1 for _ in read_messages(files)) == 20_000 - lost


def test_recording_goes_on_once_a_full_disk_has_room_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, is_full = mcap_writer._WholeRecords.write, False  # noqa: SLF001 (where a disk fills up)

    def write(file: mcap_writer._WholeRecords, data: bytes) -> int:
        if is_full:
            raise OSError(28, "No space left on device")
        return whole(file, data)

    monkeypatch.setattr(mcap_writer._WholeRecords, "write", write)  # noqa: SLF001 (where a disk fills up)
    recording = McapRecording(RecordingSpec(folder=tmp_path, stem="test"))
    lost = _lost(recording, range(10_000))
    is_full = True
    lost += _lost(recording, range(10_000, 30_000))
    is_full = False
    lost += _lost(recording, range(30_000, 40_000))
    recording.close()
    assert 15_000 < lost < 25_000
    assert sum(1 for _ in read_messages(recording_files(tmp_path, "test"))) == 40_000 - lost


def test_recording_whose_folder_is_deleted_says_so_and_begins_it_anew(tmp_path: Path) -> None:
    folder = tmp_path / "flight"
    recording = McapRecording(RecordingSpec(folder=folder, stem="test"))
    recording.add(_setpoint(0), 10**18)
    shutil.rmtree(folder)
    with pytest.raises(RecordsLost, match="the file was deleted"):
        _add(recording, range(1, 10_000))
    assert _lost(recording, range(5_000)) < 5_000
    recording.close()
    assert recording_files(folder, "test")


def test_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    tmp_path.joinpath("file").write_text("", encoding="utf-8")
    with pytest.raises(UserError, match="choose another place"):
        McapRecording(RecordingSpec(folder=tmp_path / "file" / "below", stem="test"))


def test_power_failure_costs_what_is_not_in_a_chunk_yet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    on_disk: list[int] = []
    monkeypatch.setattr(os, "fdatasync", lambda number: on_disk.append(os.fstat(number).st_size))
    file = mcap_writer.McapFile(tmp_path / "test_000.mcap", RecordingSpec(folder=tmp_path, stem="test"))
    for index in range(5_000):
        before = len(on_disk)
        file.add(_setpoint(index), index)
        assert (file.pending == 0) == (len(on_disk) > before)
        assert file.pending or on_disk[-1] == file.size
    chunks = len(on_disk)
    file.finish()
    assert chunks > 1
    assert on_disk[chunks:] == [file.path.stat().st_size]
