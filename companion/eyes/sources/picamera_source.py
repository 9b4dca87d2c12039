"""Frames from a Raspberry Pi's camera through picamera2, which says when each was taken.

Its SensorTimestamp is when the first row is read, at the end of that row's exposure, on the monotonic clock
(raspberrypi/picamera2 issues 821 and 787); the middle row's exposure has its middle half a readout later, less half the
exposure. So no latency is to be found out. The readout is the mounting's.
"""

import importlib
import threading
import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from companion.eyes.sources.frames import Captured
from link.errors import UserError
from link.program.clock import Clock, MonotonicNs
from link.units import NS_PER_S

_JOIN_S = 1.0  # without a frame the library waits for ever; the thread is left behind


class PiRequest(Protocol):
    """One of picamera2's completed requests."""

    def make_array(self, name: str) -> NDArray[np.uint8]:
        """Return the pixels of a stream."""

    def get_metadata(self) -> dict[str, Any]:
        """Return what libcamera says of the frame."""

    def release(self) -> None:
        """Give the buffer back."""


class PiCamera(Protocol):
    """What is used of picamera2's Picamera2, once it is started."""

    def capture_request(self) -> PiRequest:
        """Wait for a frame."""

    def close(self) -> None:
        """Let the camera go; one that is let go stays so."""


class PiCameraSource:
    """A Raspberry Pi's camera.

    Args:
        open_camera: gives a started camera, and UserError where there is none.
        clock: that gives UTC.
        size_px: width and height of the pictures.
        readout_s: from the first row to the last.
        latency_s: by which the times that the camera tells are late all the same.
        monotonic_ns: the clock of the camera's stamps.
    """

    name = "picamera"
    is_live = True
    refused_why: str | None = None

    def __init__(
        self,
        open_camera: Callable[[], PiCamera],
        clock: Clock,
        *,
        size_px: tuple[int, int],
        readout_s: float,
        latency_s: float = 0.0,
        monotonic_ns: MonotonicNs = time.monotonic_ns,
    ) -> None:
        self._open_camera = open_camera
        self._clock = clock
        self._size_px = size_px
        self._readout_ns = round(readout_s * NS_PER_S)
        self._latency_ns = round(latency_s * NS_PER_S)
        self._monotonic_ns = monotonic_ns
        self._newest: Captured | None = None
        self._came = threading.Condition()
        self._start()

    def _start(self) -> None:
        self._camera = self._open_camera()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._read, args=(self._camera, self._stopping), daemon=True)
        self._thread.start()

    def _read(self, camera: PiCamera, stopping: threading.Event) -> None:
        """Keep the newest frame until told to stop."""
        try:
            while not stopping.is_set():
                request = camera.capture_request()
                try:
                    frame = self._captured(request)
                finally:
                    request.release()
                with self._came:
                    self._newest = frame
                    self._came.notify()
        finally:
            camera.close()

    def _captured(self, request: PiRequest) -> Captured:
        told = request.get_metadata()
        first_row_ns = int(told["SensorTimestamp"]) - 500 * int(told["ExposureTime"])  # microseconds, half of them
        age_ns = self._monotonic_ns() - first_row_ns - self._readout_ns // 2 + self._latency_ns
        width, height = self._size_px
        luma = request.make_array("main")[:height, :width]  # of YUV420 the first rows; padded to the right
        return Captured(t_ns=self._clock.now_ns() - age_ns, shades=np.ascontiguousarray(luma, np.uint8))

    def take(self, timeout_s: float) -> Captured | None:
        """Return the newest frame."""
        with self._came:
            self._came.wait_for(lambda: self._newest is not None, timeout_s)
            newest, self._newest = self._newest, None
        return newest

    def has_ended(self) -> bool:
        """Return False: a camera has no end."""
        return False

    def restart(self) -> None:
        """Open the camera again; one that is not there is told by UserError."""
        self.close()
        self._start()

    def close(self) -> None:
        """Let the camera go, also from a thread that waits in vain for a frame: else nobody could open it again.

        Raises:
            UserError: such a camera cannot be let go.
        """
        self._stopping.set()
        self._thread.join(_JOIN_S)
        if not self._thread.is_alive():
            return
        try:
            self._camera.close()
        except RuntimeError as error:
            why = " ".join(str(error).split())[:120]
            raise UserError(f"--source picamera hangs and cannot be let go ({why}): start pad-detector again") from None


def open_picamera(size_px: tuple[int, int]) -> PiCamera:
    """Return the first of the Raspberry Pi's cameras, started.

    Raises:
        UserError: picamera2 is not installed, there is no camera, or another program has it.
    """
    try:
        library = importlib.import_module("picamera2")
    except ImportError:
        raise UserError(
            "--source picamera needs picamera2: apt install python3-picamera2, in an environment with system packages"
        ) from None
    camera = None
    try:
        camera = library.Picamera2()
        camera.configure(camera.create_video_configuration(main={"size": size_px, "format": "YUV420"}))
        camera.start()
    except (RuntimeError, IndexError) as error:
        if camera is not None:  # else nobody could open it again
            camera.close()
        why = " ".join(str(error).split())[:120]
        raise UserError(f"--source picamera gives no pictures ({why}): connect one, or end who has it") from None
    return camera  # type: ignore[no-any-return]  # picamera2 has no types
