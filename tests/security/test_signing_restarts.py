"""Signed frames that are recorded and sent again after the companion was started anew."""

import os
from pathlib import Path

import pytest

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.signing import SIGNING_EPOCH_NS, Signing, signing_timestamp
from link.mavlink.signing_memory import SigningMemory, open_signing, restored, stamps_file

KEY = bytes(range(32))
S = 10**9
NOW_NS = SIGNING_EPOCH_NS + 350_000_000 * S
DAY_NS = 86_400 * S


def frames(t_ns: int, count: int = 1, link: int = 1) -> bytes:
    """Return what an autopilot sends at `t_ns`."""
    codec = MavlinkCodec(1, 1, signing=Signing(KEY, link, signing_timestamp(t_ns)))
    return b"".join(codec.encode(mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 4, 3)) for _ in range(count))


def taken(signing: Signing, data: bytes) -> int:
    return len(MavlinkCodec(1, 191, signing=signing).decode(data))


def restarted(path: Path, signing: Signing, t_ns: int) -> Signing:
    """End a companion, and start it anew at `t_ns` by its own clock."""
    SigningMemory(path, signing).close()
    return restored(path, KEY, t_ns)


def test_frames_from_before_a_restart_are_refused_and_those_after_it_taken(tmp_path: Path) -> None:
    signing = restored(tmp_path / "stamps", KEY, NOW_NS)
    recorded = frames(NOW_NS - 20 * S) + frames(NOW_NS, 3)
    assert taken(signing, recorded) == 4
    signing = restarted(tmp_path / "stamps", signing, NOW_NS + 2 * S)
    assert taken(signing, recorded) == 0
    assert taken(signing, frames(NOW_NS + 2 * S)) == 1


def test_clock_that_is_behind_after_a_restart_takes_nothing_old_and_signs_no_earlier_than_before(
    tmp_path: Path,
) -> None:
    signing = restored(tmp_path / "stamps", KEY, NOW_NS)
    recorded = frames(NOW_NS)
    taken(signing, recorded)
    signing = restarted(tmp_path / "stamps", signing, 0)
    assert taken(signing, recorded) == 0
    assert taken(signing, frames(NOW_NS - 2 * 60 * S, link=7)) == 0
    assert signing.timestamp >= signing_timestamp(NOW_NS)


def test_first_frame_of_a_first_start_may_be_a_minute_old_and_no_older(tmp_path: Path) -> None:
    for age_ns, expected in ((300 * DAY_NS, 0), (61 * S, 0), (59 * S, 1)):
        assert taken(restored(tmp_path / "none", KEY, NOW_NS), frames(NOW_NS - age_ns)) == expected


def test_killed_companion_has_kept_what_it_took_up_to_a_second_ago(tmp_path: Path) -> None:
    path = tmp_path / "stamps"
    signing = restored(path, KEY, NOW_NS)
    memory = SigningMemory(path, signing)
    early = frames(NOW_NS)
    taken(signing, early)
    memory.poll(0)
    memory.close()  # writes what was due; later frames are those of the last second
    late = frames(NOW_NS + S // 2)
    assert taken(signing, late) == 1
    again = restored(path, KEY, NOW_NS + 3 * S)
    assert taken(again, early + late) == 0


def test_stamps_of_all_systems_and_components_there_can_be_are_read_again(tmp_path: Path) -> None:
    stamp = signing_timestamp(NOW_NS)
    streams = {(system, component, 255): stamp for system in range(256) for component in range(256)}
    signing = Signing(KEY, timestamp=stamp, streams=streams)
    assert restarted(tmp_path / "stamps", signing, NOW_NS).streams.keys() == streams.keys()


def test_stamps_are_on_the_disk_in_whole_before_they_replace_the_older_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, on_disk = tmp_path / "stamps", []

    def note(descriptor: int) -> None:
        state = os.fstat(descriptor)
        on_disk.append((state.st_ino, state.st_size))
        assert not path.exists()

    monkeypatch.setattr(os, "fsync", note)
    memory = SigningMemory(path, restored(path, KEY, NOW_NS))
    assert on_disk == [(path.stat().st_ino, path.stat().st_size)]
    monkeypatch.undo()
    memory.close()


@pytest.mark.parametrize(
    "content", [b"", b"{}", b"[]", b"[" * 100_000, b'{"timestamp": -1, "streams": []}', b'{"timestamp": 1e99}', b"\xff"]
)
def test_file_that_holds_no_stamps_is_the_users_mistake(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "stamps"
    path.write_bytes(content)
    with pytest.raises(UserError, match="holds no time stamps"):
        restored(path, KEY, NOW_NS)


def test_stamps_are_kept_beside_the_key_and_a_place_that_cannot_be_written_is_told_before_the_flight(
    tmp_path: Path,
) -> None:
    key = tmp_path / "mavlink.key"
    key.write_text(KEY.hex(), encoding="ascii")
    assert stamps_file(key, None) == tmp_path / "mavlink.key.stamps"
    signing = open_signing(key, None)
    with pytest.raises(UserError, match="--signing-stamps"):
        SigningMemory(tmp_path / "no" / "folder", signing)


def test_second_program_is_told_that_another_one_keeps_its_stamps_there(tmp_path: Path) -> None:
    path, signing = tmp_path / "stamps", restored(tmp_path / "stamps", KEY, NOW_NS)
    first = SigningMemory(path, signing)
    taken(signing, frames(NOW_NS))
    with pytest.raises(UserError, match="another program keeps time stamps"):
        SigningMemory(path, restored(tmp_path / "none", KEY, 0))
    first.close()
    again = restarted(path, restored(path, KEY, NOW_NS), NOW_NS)
    assert taken(again, frames(NOW_NS)) == 0


def test_stamps_that_cannot_be_written_in_flight_are_noticed(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    memory = SigningMemory(folder / "stamps", restored(folder / "stamps", KEY, NOW_NS))
    assert memory.why_lost == ""
    folder.rename(tmp_path / "elsewhere")
    memory.close()  # writes the last
    assert memory.why_lost == "No such file or directory"
