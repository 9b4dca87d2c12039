"""Files that somebody else made: what cannot be read is one line, and nothing in them says how much memory is taken."""

import os
import struct
from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer

from companion.check.findings import read_kept
from companion.eyes.calibration import load_calibration
from link.errors import UserError
from link.mavlink.signing import read_key
from link.program.toml_config import parse_toml, read_toml
from link.recording.mcap_reader import read_head, read_messages
from link.zenoh.keys import Keys
from scenarios.campaigns.folder import read_landings, read_plan
from scenarios.recordings.replay import Flight, read_flights, replay
from scenarios.reports.run_data import read_result
from scenarios.view.recorded import RecordedSource

MAGIC = b"\x89MCAP0\r\n"
DEEP = "[" * 200_000
GB = 1 << 30


def record(opcode: int, content: bytes, length: int | None = None) -> bytes:
    return bytes([opcode]) + struct.pack("<Q", len(content) if length is None else length) + content


def chunk(data: bytes, told: int, compression: bytes = b"zstd") -> bytes:
    head = struct.pack("<QQQI", 0, 0, told, 0) + struct.pack("<I", len(compression)) + compression
    return record(Opcode.CHUNK, head + struct.pack("<Q", len(data)) + data)


def bomb() -> bytes:
    """A gigabyte of zeros, in some kilobytes that tell of it."""
    compressor = zstandard.ZstdCompressor(level=1).compressobj(size=GB)
    zeros = bytes(1 << 24)
    return b"".join(compressor.compress(zeros) for _ in range(GB >> 24)) + compressor.flush()


def recording(changes: Callable[[Writer], None] = lambda _: None) -> bytes:
    """A short recording of a companion's."""
    stream = BytesIO()
    writer = Writer(stream, compression=CompressionType.ZSTD)
    writer.start()
    metadata = {"namespace": "ns", "vehicle": "car", "drone": "drone", "system_id": "1", "dry_run": "false"}
    writer.add_metadata("run", metadata)
    writer.add_attachment(0, 0, "companion.toml", "text/plain", b"")
    changes(writer)
    schema = writer.register_schema("decklander_msgs/msg/NodeInput", "ros2msg", b"")
    channel = writer.register_channel("/ns/drone/companion/input", "cdr", schema)
    for number in range(20):
        writer.add_message(channel, number, b"\0\1\0\0" + bytes(40), number)
    writer.finish()  # type: ignore[no-untyped-call]  # it has no annotations
    return stream.getvalue()


def read(path: Path) -> None:
    """Read a recording in every way."""
    read_head(path)
    for _ in read_messages([path]):
        pass
    for _ in read_flights(path.parent):
        pass


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(b"not a recording at all", id="no MCAP"),
        pytest.param(MAGIC + chunk(b"\x28\xb5\x2f\xfdnonsense", 100), id="bad zstd"),
        pytest.param(MAGIC + chunk(zstandard.compress(b"x"), 1 << 62), id="a chunk of 4 EB"),
        pytest.param(MAGIC + chunk(b"x", 1, b"lz4"), id="another compression"),
        pytest.param(MAGIC + record(Opcode.HEADER, b"", length=4 << 30), id="a record of 4 GB"),
        pytest.param(
            MAGIC + record(Opcode.METADATA, struct.pack("<I", 4) + b"\xff\xfe\xfd\xfc" + bytes(8)), id="no UTF-8"
        ),
        pytest.param(MAGIC + record(Opcode.MESSAGE, struct.pack("<HIQQ", 7, 0, 0, 0)), id="no channel"),
        pytest.param(recording(lambda w: w.add_attachment(0, 0, "a.toml", "text/plain", b"\xff")), id="no text"),
    ],
)
def test_recording_that_makes_no_sense_is_one_line(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "companion_000.mcap"
    path.write_bytes(data)
    with pytest.raises(UserError) as caught:
        read(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_recording_that_is_a_pipe_is_one_line_and_nobody_waits_for_it(tmp_path: Path) -> None:
    path = tmp_path / "companion_000.mcap"
    os.mkfifo(path)
    with pytest.raises(UserError, match=r"companion_000\.mcap: .* \(it is a pipe\)"):
        read_head(path)


def test_gigabyte_in_a_few_kilobytes_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "companion_000.mcap"
    path.write_bytes(MAGIC + chunk(bomb(), 100))
    with pytest.raises(UserError, match=f"a chunk of {GB} bytes"):
        read(path)


@pytest.mark.parametrize("text", ["0", "256", "-3", "999999", "9" * 400, "one"])
def test_system_id_that_no_drone_has_is_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "companion_000.mcap"
    path.write_bytes(recording(lambda writer: writer.add_metadata("more", {"system_id": text})))
    flight = Flight(head=read_head(path), keys=Keys("ns", "car", "drone"), inputs=(), outputs={})
    with pytest.raises(UserError, match="its system_id is no whole number from 1 to 255"):
        replay(flight)


@pytest.mark.parametrize("name", ["namespace", "vehicle", "drone"])
@pytest.mark.parametrize("text", ["**", "", "a//b", "car?x"])
def test_name_that_no_key_has_is_one_line(tmp_path: Path, name: str, text: str) -> None:
    path = tmp_path / "companion_000.mcap"
    path.write_bytes(recording(lambda writer: writer.add_metadata("more", {name: text})))
    with pytest.raises(UserError, match=r"companion_000\.mcap: names in it are none of a key's"):
        list(read_flights(tmp_path))
    with pytest.raises(UserError, match=r"companion_000\.mcap: names in it are none of a key's"):
        RecordedSource(path)


@pytest.mark.parametrize("text", ["-1", "one"])
def test_seed_that_no_run_has_is_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "truth_000.mcap"

    def of_run(writer: Writer) -> None:
        writer.add_metadata("more", {"seed": text})
        writer.add_attachment(0, 0, "scenario.toml", "text/plain", b"")

    path.write_bytes(recording(of_run))
    with pytest.raises(UserError, match="its seed is no whole number from 0 on"):
        RecordedSource(path)


@settings(max_examples=60)
@given(data=st.data())
def test_spoiled_recording_is_read_up_to_there_or_is_one_line(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    whole = bytearray(recording())
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.mktemp("run") / "companion_000.mcap"
    path.write_bytes(whole[: data.draw(st.integers(0, len(whole)))])
    with suppress(UserError):
        read(path)


@pytest.mark.parametrize(
    "text",
    [
        "[]",
        "{}",
        "3",
        DEEP,
        '{"scenario": 1}',
        '{"scenario": "a", "seed": 1, "tier": "S1", "reason": "", "contact_s": "x"}',
    ],
)
def test_result_that_is_none_is_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "result.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match=r"result\.json"):
        read_result(path)


@pytest.mark.parametrize("text", ["[]", "{}", DEEP, "\x1b[2J"])
def test_campaign_that_is_none_is_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "campaign.json").write_text(text, encoding="utf-8")
    with pytest.raises(UserError):
        read_plan(tmp_path)
    with pytest.raises(UserError):
        read_landings(tmp_path)


def test_toml_that_is_nested_without_end_is_one_line() -> None:
    with pytest.raises(UserError, match="nested too deep"):
        parse_toml(f"a = {DEEP}", "scenario.toml")


def test_file_without_an_end_is_one_line() -> None:
    for read_it in (read_toml, load_calibration):
        with pytest.raises(UserError, match=r"/dev/zero: larger than 4 MB"):
            read_it(Path("/dev/zero"))


@pytest.mark.parametrize("read_it", [read_key, read_kept, read_result])
def test_file_without_an_end_holds_nothing_that_is_looked_for(read_it: Callable[[Path], object]) -> None:
    with pytest.raises(UserError, match=r"^/dev/zero: "):
        read_it(Path("/dev/zero"))


def test_campaign_whose_plan_has_no_end_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "campaign.json").symlink_to("/dev/zero")
    with pytest.raises(UserError, match=r"campaign\.json: not valid JSON"):
        read_plan(tmp_path)


def test_integer_of_thousands_of_digits_is_one_line() -> None:
    with pytest.raises(UserError, match=r"scenario\.toml: not valid TOML \(Exceeds the limit"):
        parse_toml(f"a = {'9' * 6000}", "scenario.toml")


def test_text_that_no_file_can_be_called_is_one_line() -> None:
    with pytest.raises(UserError, match=r"companion\.toml: not valid TOML \(a text has a NUL character\)"):
        parse_toml('[recording]\nfolder = "a\\u0000b"', "companion.toml")


def test_calibration_that_is_nested_without_end_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "camera.yaml"
    path.write_text(DEEP[:20_000], encoding="utf-8")
    with pytest.raises(UserError, match=r"camera\.yaml: no YAML \(nested too deep\)"):
        load_calibration(path)


def test_byte_order_mark_of_an_editor_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "companion.toml"
    path.write_bytes(b"\xef\xbb\xbf[descent]\n")
    assert read_toml(path) == {"descent": {}}
