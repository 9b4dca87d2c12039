"""A Raspberry Pi's camera: when its pictures were taken, and one that is not there."""

import sys
import threading
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.sources.opening import SourceOptions, open_source
from companion.eyes.sources.picamera_source import PiCameraSource, PiRequest, open_picamera
from link.errors import UserError
from link.program.clock import SystemClock
from link.zenoh.keys import Keys

SIZE_PX = (40, 30)
LUMA = np.random.default_rng(5).integers(0, 256, (30, 64)).astype(np.uint8)
READ_NS, NOW_NS, UTC_NS = 5_000_000_000, 5_040_000_000, 1_700_000_000_000_000_000


class Clock(SystemClock):
    def now_ns(self) -> int:
        return UTC_NS


class Request:
    def make_array(self, name: str) -> NDArray[np.uint8]:
        assert name == "main"
        return np.vstack([LUMA, np.zeros((15, 64), np.uint8)])  # colours follow the luma

    def get_metadata(self) -> dict[str, Any]:
        return {"SensorTimestamp": READ_NS, "ExposureTime": 6_000}

    def release(self) -> None: ...


class Camera:
    """Gives one frame, and no other until it is closed."""

    def __init__(self) -> None:
        self.given = 0
        self.closed = threading.Event()

    def capture_request(self) -> PiRequest:
        self.given += 1
        if self.given > 1:
            self.closed.wait(0.05)
        return Request()

    def close(self) -> None:
        self.closed.set()


def test_a_picture_has_the_time_of_its_middle_rows_exposure_and_its_luma() -> None:
    camera = Camera()
    source = PiCameraSource(lambda: camera, Clock(), size_px=SIZE_PX, readout_s=0.02, monotonic_ns=lambda: NOW_NS)
    captured = source.take(5.0)
    source.close()
    assert captured is not None
    assert captured.t_ns == UTC_NS - 40_000_000 - 3_000_000 + 10_000_000
    assert (captured.shades == LUMA[:, :40]).all()
    assert camera.closed.wait(5.0)


class Stuck(Camera):
    """Gives no frame at all, as after libcamera's "frontend has timed out"."""

    def capture_request(self) -> PiRequest:
        self.closed.wait()
        return Request()


def test_camera_that_gives_no_more_frames_is_let_go_and_opened_again() -> None:
    cameras: list[Camera] = []

    def open_camera() -> Camera:
        if cameras and not cameras[-1].closed.is_set():
            raise UserError("device or resource busy")
        cameras.append(Camera() if cameras else Stuck())
        return cameras[-1]

    source = PiCameraSource(open_camera, Clock(), size_px=SIZE_PX, readout_s=0.0, monotonic_ns=lambda: NOW_NS)
    source.restart()
    captured = source.take(5.0)
    source.close()
    assert captured is not None


def test_camera_that_hangs_and_cannot_be_let_go_is_told() -> None:
    class Held(Stuck):
        def close(self) -> None:
            raise RuntimeError("Closing failed")

    source = PiCameraSource(Held, Clock(), size_px=SIZE_PX, readout_s=0.0, monotonic_ns=lambda: NOW_NS)
    with pytest.raises(UserError, match="Closing failed"):
        source.restart()


def test_without_picamera2_it_is_said_how_to_install_it() -> None:
    options = SourceOptions(size_px=SIZE_PX, latency_s=0.0, rate_hz=30.0)
    with pytest.raises(UserError, match="python3-picamera2"):
        open_source("picamera", options, Keys("decklander", "vehicle", "drone"), None)  # type: ignore[arg-type]  # unused


def test_camera_that_does_not_start_is_let_go(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = Camera()

    def busy() -> None:
        raise RuntimeError("Device or resource busy")

    opened = SimpleNamespace(
        configure=lambda _: None, create_video_configuration=lambda **_: {}, start=busy, close=camera.close
    )
    monkeypatch.setitem(sys.modules, "picamera2", SimpleNamespace(Picamera2=lambda: opened))
    with pytest.raises(UserError, match="resource busy"):
        open_picamera(SIZE_PX)
    assert camera.closed.is_set()


def test_latency_that_was_measured_counts_beside_what_the_camera_tells() -> None:
    camera = Camera()
    source = PiCameraSource(
        lambda: camera, Clock(), size_px=SIZE_PX, readout_s=0.0, latency_s=0.007, monotonic_ns=lambda: NOW_NS
    )
    captured = source.take(5.0)
    source.close()
    assert captured is not None
    assert captured.t_ns == UTC_NS - 40_000_000 - 3_000_000 - 7_000_000
