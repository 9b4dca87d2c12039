"""What a person writes and is told: devices, the pad, and the state of a receiver."""

from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.vehicle_sources.channel import FileTransport, gpsd_address, nmea_opener
from scenarios.vehicle_sources.health import Health, News
from scenarios.vehicle_sources.pad import pad_geometry
from scenarios.vehicle_sources.receiver import Lines

S = 1_000_000_000


def test_gpsd_address_has_a_default_port_and_a_receiver() -> None:
    device, receiver = gpsd_address("car.local")
    assert (str(device), receiver) == ("tcp:car.local:2947", None)
    device, receiver = gpsd_address("127.0.0.1:3000:/dev/ttyACM0")
    assert (str(device), receiver) == ("tcp:127.0.0.1:3000", "/dev/ttyACM0")


@pytest.mark.parametrize("text", ["", ":2947", "host:port", "host:70000", "tcp://host:2947"])
def test_what_is_no_gpsd_address_is_told(text: str) -> None:
    with pytest.raises(UserError, match="write HOST:PORT"):
        gpsd_address(text)


def test_nmea_comes_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "drive.nmea"
    path.write_bytes(b"$GPGGA\r\n")
    with nmea_opener(str(path))() as transport:
        assert isinstance(transport, FileTransport)
        assert transport.receive(0.0) == b"$GPGGA\r\n"
        assert not transport.is_at_end
        assert transport.receive(0.0) == b""
        assert transport.is_at_end


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("drive.nmea", "no such file"),
        ("tcp://host", "tcp:"),
        ("/dev/ttyUSB0,fast", "baud"),
    ],
)
def test_what_is_no_nmea_source_is_told(text: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        nmea_opener(text)


def test_pad_is_described_by_file_and_options(tmp_path: Path) -> None:
    path = tmp_path / "pad.toml"
    path.write_text("size_m = [1.5, 1.2]\nheight_m = 1.6\nantenna_to_pad_m = [0.8, 0.0, -0.1]\n")
    pad = pad_geometry(path, height_m=1.7)
    assert (pad.size_m, pad.height_m, pad.antenna_to_pad_m) == ((1.5, 1.2), 1.7, (0.8, 0.0, -0.1))


def test_a_pad_without_its_lever_arm_is_asked_for() -> None:
    with pytest.raises(UserError, match="give --antenna-to-pad"):
        pad_geometry(None, size_m=(1.0, 1.0), height_m=1.5, antenna_to_pad_m=None)


@pytest.mark.parametrize("text", ["size_m = [0.0, 1.0]", "high_m = 1.0", "size_m = [1.0]"])
def test_a_pad_that_cannot_be_names_file_and_key(tmp_path: Path, text: str) -> None:
    path = tmp_path / "pad.toml"
    path.write_text(text)
    with pytest.raises(UserError, match=r"pad\.toml.*(size_m|high_m)"):
        pad_geometry(path)


def test_a_line_without_end_is_dropped_and_the_next_one_read() -> None:
    lines = Lines()
    for _ in range(10):
        assert lines.take(b"x" * 5000) == []
    assert lines.overlong == 1
    assert lines.take(b"rest\nwhole\nbeg") == [b"whole"]
    assert lines.take(b"in\n") == [b"begin"]


def news_of(
    health: Health, t_s: float, *, connected: bool = True, heard: bool = False, fix: bool = False
) -> News | None:
    return health.update(round(t_s * S), is_connected=connected, heard=heard, has_fix=fix, complaint="no sky")


def test_each_trouble_is_told_once_and_then_now_and_again() -> None:
    health = Health("gpsd", 0)
    told = [news_of(health, float(t), connected=False) for t in range(70)]
    assert [t for t, news in enumerate(told) if news is not None] == [5, 35, 65]
    assert all("does not answer" in news.text for news in told if news is not None)


def test_health_tells_connection_silence_no_fix_and_fixes_apart() -> None:
    health = Health("gpsd", 0)
    for t, connected, heard, fix, words in (
        (6.0, False, False, False, "does not answer"),
        (7.0, True, False, False, "nothing is received"),
        (8.0, True, True, False, "no sky"),
        (9.0, True, True, True, "fixes from gpsd"),
        (13.0, True, True, False, ""),
        (14.5, True, True, False, "no sky"),
        (15.0, True, True, True, "fixes from gpsd"),
    ):
        news = news_of(health, t, connected=connected, heard=heard, fix=fix)
        assert (news is None) == (not words)
        assert news is None or words in news.text


def test_a_connection_that_brings_nothing_is_a_dead_one_after_a_while() -> None:
    health = Health("gpsd", 0)
    news_of(health, 1.0, heard=True)
    assert not health.is_silent(11 * S)
    assert health.is_silent(12 * S)
    health.closed(12 * S)
    assert not health.is_silent(60 * S)  # a lost one is opened again by the transport
