"""Frames from what OpenCV captures: a camera of the kernel (V4L2), an RTSP stream or a video file.

A thread of its own waits for the camera, so that one that stops stops nothing else; only the newest frame is kept.
The time of a frame is when it arrived, less the camera's latency: from the middle of the exposure to the program.
"""

import re
import threading
from pathlib import Path

import cv2
import numpy as np

from companion.eyes.sources.frames import Captured
from link.errors import UserError
from link.program.clock import Clock
from link.units import NS_PER_S

_DEVICE = re.compile(r"(?:/dev/video)?(\d+)")
_JOIN_S = 1.0  # a driver that hangs holds its thread for ever; it is left behind


class CaptureSource:
    """A camera, a stream or a video file.

    Args:
        address: /dev/videoN, rtsp://..., or a file.
        clock: that gives UTC.
        latency_s: from the middle of an exposure to its arrival.
        size_px: to be asked of the camera, None for what it gives.

    Raises:
        UserError: there is no such camera or file, or it gives no picture.
    """

    def __init__(self, address: str, clock: Clock, *, latency_s: float, size_px: tuple[int, int] | None) -> None:
        self.name = address
        self._device = _DEVICE.fullmatch(address)
        self._is_file = self._device is None and "://" not in address
        self.is_live = not self._is_file
        self.refused_why: str | None = None  # OpenCV tells nothing of frames that it passes over
        self._clock = clock
        self._latency_ns = round(latency_s * NS_PER_S)
        self._size_px = size_px
        self._capture = self._open()
        self._newest: Captured | None = None
        self._came = threading.Condition()
        self._stopping = threading.Event()
        self._ended = False
        self._thread = threading.Thread(target=self._read, args=(self._capture, self._stopping), daemon=True)
        if not self._is_file:
            self._thread.start()

    def _open(self) -> cv2.VideoCapture:
        if self._device is not None:
            path = Path(f"/dev/video{self._device[1]}")
            if not path.exists():
                there = ", ".join(sorted(str(one) for one in Path("/dev").glob("video*"))) or "none"
                raise UserError(f"there is no camera {path}: connect it, or choose another --source (there: {there})")
            capture = cv2.VideoCapture(int(self._device[1]), cv2.CAP_V4L2)
        else:
            if self._is_file and not Path(self.name).is_file():
                raise UserError(f"--source {self.name}: there is no such file, folder or camera")
            capture = cv2.VideoCapture(self.name)
        if not capture.isOpened():
            capture.release()
            why = "another program may have it" if self._device is not None else "it cannot be opened"
            raise UserError(f"--source {self.name} gives no pictures: {why}")
        if self._size_px is not None and not self._is_file:
            width, height = self._size_px
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, width)
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, height)
        return capture

    def take(self, timeout_s: float) -> Captured | None:
        """Return the newest frame; of a file the next one."""
        if self._is_file:
            self._newest = self._next(self._capture)
            self._ended = self._newest is None
        else:
            with self._came:
                self._came.wait_for(lambda: self._newest is not None, timeout_s)
        with self._came:
            newest, self._newest = self._newest, None
        return newest

    def _next(self, capture: cv2.VideoCapture) -> Captured | None:
        found, picture = capture.read()
        if not found:
            return None
        t_ns = self._clock.now_ns() - self._latency_ns
        shades = picture if picture.ndim == 2 else cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
        return Captured(t_ns=t_ns, shades=np.asarray(shades, np.uint8))

    def _read(self, capture: cv2.VideoCapture, stopping: threading.Event) -> None:
        """Keep the newest frame until told to stop; a camera that fails is let go, and then none comes."""
        while not stopping.is_set():
            frame = self._next(capture)
            if frame is None:
                break
            with self._came:
                self._newest = frame
                self._came.notify()
        capture.release()

    def has_ended(self) -> bool:
        """Return whether a file is at its end."""
        return self._ended

    def restart(self) -> None:
        """Open the camera again; one that is not there yet is told by UserError."""
        self._stop()
        self._capture = self._open()
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._read, args=(self._capture, self._stopping), daemon=True)
        self._thread.start()

    def _stop(self) -> None:
        self._stopping.set()
        if self._thread.is_alive():
            self._thread.join(_JOIN_S)

    def close(self) -> None:
        """Let the camera go."""
        self._stop()
        if self._is_file:
            self._capture.release()
