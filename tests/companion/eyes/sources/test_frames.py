import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from companion.eyes.loop import STOPPED_NS, CameraWatch, Failure, failure_of, note_frame
from companion.eyes.picture import WholePicture
from companion.eyes.sight import Frame, SightMemory, sight_step
from companion.eyes.sources import opening
from companion.eyes.sources.capture_source import CaptureSource
from companion.eyes.sources.file_source import FolderSource
from companion.eyes.sources.frames import gray_of_file, gray_of_image
from link.errors import UserError
from link.messages import CameraImage, CompressedPicture
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.program.clock import Clock, SystemClock
from link.records import replace
from link.zenoh.inbox import Inbox, Sample, WakeUp
from link.zenoh.keys import Keys
from tests.companion.eyes.frames import system

SHADES = np.random.default_rng(2).integers(0, 256, (6, 8)).astype(np.uint8)


def image(encoding: str, pixels: np.ndarray[tuple[int, ...], np.dtype[np.uint8]], spare: int = 0) -> CameraImage:
    rows = np.pad(pixels.reshape(6, -1), ((0, 0), (0, spare)))
    return CameraImage(t_ns=1, width_px=8, height_px=6, encoding=encoding, row_bytes=rows.shape[1], data=rows.tobytes())


@pytest.mark.parametrize("spare", [0, 5])
def test_gray_pictures_are_read_as_they_are_with_or_without_spare_bytes(spare: int) -> None:
    assert (gray_of_image(image("mono8", SHADES, spare)) == SHADES).all()


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "bgra8", "rgba8"])
def test_a_gray_scene_in_colours_has_the_same_shades(encoding: str) -> None:
    pixels = np.repeat(SHADES[:, :, None], 4 if "a" in encoding else 3, axis=2)
    assert np.abs(gray_of_image(image(encoding, pixels)).astype(int) - SHADES).max() <= 1


def test_red_is_brighter_than_blue_whatever_their_order() -> None:
    red = np.zeros((6, 8, 3), np.uint8)
    red[:, :, 0] = 200
    assert gray_of_image(image("rgb8", red)).mean() > 2 * gray_of_image(image("bgr8", red)).mean()
    clear = np.dstack([red, np.zeros_like(SHADES)])
    assert gray_of_image(image("rgba8", clear)).mean() > 2 * gray_of_image(image("bgra8", clear)).mean()


def test_pictures_of_unknown_pixels_are_refused_by_name() -> None:
    with pytest.raises(PayloadError, match="'bayer_rggb8' are not read"):
        gray_of_image(image("bayer_rggb8", SHADES))
    with pytest.raises(PayloadError, match="does not hold 8 pixels"):
        gray_of_image(image("rgb8", SHADES))


@given(data=st.binary(max_size=200))
def test_files_of_random_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(PayloadError):
        gray_of_file(CompressedPicture(t_ns=1, format="jpeg", data=data))


@pytest.mark.slow
@given(shades=arrays(np.uint8, (720, 1280), elements=st.integers(0, 255), fill=st.integers(0, 255)))
@settings(max_examples=15, deadline=None)
def test_no_picture_stops_the_detector(shades: np.ndarray[tuple[int, int], np.dtype[np.uint8]]) -> None:
    frame = Frame(t_ns=5, picture=WholePicture(shades))
    assert sight_step(SightMemory(), frame, system())[1].sighting is None


def test_a_folder_gives_its_pictures_in_order_with_the_times_of_their_names(tmp_path: Path) -> None:
    for name in ("1763708400000000000", "1763708400033000000"):
        cv2.imwrite(str(tmp_path / f"{name}.png"), SHADES)
    (tmp_path / "1763708400010000000.png").write_bytes(b"no picture")
    source = FolderSource(tmp_path, start_ns=7, rate_hz=10.0)
    times = []
    while (captured := source.take(0.0)) is not None:
        times.append(captured.t_ns)
        assert (captured.shades == SHADES).all()
    assert times == [1_763_708_400_000_000_000, 1_763_708_400_033_000_000]
    assert source.refused_why == "1763708400010000000.png: 10 bytes are no picture of format 'png'"
    assert source.has_ended()


def test_pictures_without_times_follow_each_other_at_the_rate(tmp_path: Path) -> None:
    for name in ("20261128075437123456", "b", "c"):
        cv2.imwrite(str(tmp_path / f"{name}.png"), SHADES)
    source = FolderSource(tmp_path, start_ns=7, rate_hz=4.0)
    assert [one.t_ns for _ in range(3) if (one := source.take(0.0)) is not None] == [7, 250_000_007, 500_000_007]


def test_a_folder_without_pictures_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no picture in it"):
        FolderSource(tmp_path, start_ns=0, rate_hz=1.0)


def test_a_video_file_gives_all_its_frames_and_ends(tmp_path: Path) -> None:
    path = tmp_path / "flight.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (64, 48))
    for shade in (40, 120, 200):
        writer.write(np.full((48, 64, 3), shade, np.uint8))
    writer.release()
    source = CaptureSource(str(path), SystemClock(), latency_s=0.0, size_px=None)
    means = []
    while (captured := source.take(0.0)) is not None:
        means.append(float(captured.shades.mean()))
    assert means == pytest.approx([40, 120, 200], abs=4)
    assert source.has_ended()
    source.close()


@pytest.mark.parametrize(
    ("address", "why"),
    [("/dev/video97", "there is no camera /dev/video97"), ("no_such_file.mp4", "no such file, folder or camera")],
)
def test_a_camera_that_is_not_there_is_named(address: str, why: str) -> None:
    with pytest.raises(UserError, match=why):
        CaptureSource(address, SystemClock(), latency_s=0.0, size_px=None)


def test_frames_have_the_date_that_the_computer_got_after_the_start(monkeypatch: pytest.MonkeyPatch) -> None:
    clocks: list[Clock] = []
    monkeypatch.setattr(opening, "CaptureSource", lambda _, clock, **__: clocks.append(clock))
    options = opening.SourceOptions(size_px=None, latency_s=0.0, rate_hz=30.0)
    not_used: Any = None
    opening.open_source("/dev/video0", options, Keys(), not_used)
    monkeypatch.setattr(time, "time_ns", lambda: 1_800_000_000_123_456_789)
    assert [clock.now_ns() for clock in clocks] == [1_800_000_000_123_456_789]


def test_a_camera_that_stops_and_one_that_freezes_are_told_within_half_a_second() -> None:
    other = SHADES.copy()
    other[0, 0] ^= 1
    watch = CameraWatch(came_ns=0, changed_ns=0)
    for now_ns in (2, 6, 10):
        watch = note_frame(watch, SHADES, now_ns)
    watch = replace(watch, changed_ns=10)
    assert failure_of(watch, STOPPED_NS) is None
    assert failure_of(watch, STOPPED_NS + 10) is Failure.STOPPED
    for now_ns in range(20, STOPPED_NS + 20, STOPPED_NS // 10):
        watch = note_frame(watch, SHADES, now_ns)
    assert failure_of(watch, STOPPED_NS + 10) is Failure.FROZEN
    assert failure_of(note_frame(watch, other, STOPPED_NS + 20), STOPPED_NS + 30) is None


def test_latency_that_was_measured_counts_for_stamps_that_pictures_bring_along(tmp_path: Path) -> None:
    wake_up, keys = WakeUp(), Keys()
    inboxes = {key: Inbox(capacity=4, wake_up=wake_up) for key in (keys.camera_image, keys.camera_compressed)}
    session: Any = SimpleNamespace(subscribe=lambda key, **_: inboxes[key], wake_up=wake_up)
    stamp_ns = 1_763_708_400_000_000_000
    cv2.imwrite(str(tmp_path / f"{stamp_ns}.png"), SHADES)
    file = CompressedPicture(t_ns=stamp_ns, format="png", data=(tmp_path / f"{stamp_ns}.png").read_bytes())
    raw = replace(image("mono8", SHADES), t_ns=stamp_ns)
    for latency_s, late_ns in ((None, 0), (0.06, 60_000_000)):
        options = opening.SourceOptions(size_px=None, latency_s=latency_s, rate_hz=30.0)
        for address, key, message in (
            ("zenoh", keys.camera_image, raw),
            ("zenoh", keys.camera_compressed, file),
            (str(tmp_path), "", None),
        ):
            source = opening.open_source(address, options, keys, session)
            if message is not None:
                inboxes[key].put(Sample(key=key, payload=cdr.encode(message), received_ns=0))
            captured = source.take(0.0)
            assert captured is not None
            assert captured.t_ns == stamp_ns - late_ns
    wake_up.close()
