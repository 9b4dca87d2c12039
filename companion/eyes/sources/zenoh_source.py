"""Frames from Zenoh: `sensor_msgs/Image` and `CompressedImage`, with their own stamps.

Drivers that do not know when a frame was exposed stamp it as it arrives; these stamps are late by the camera's latency.
"""

import time

from companion.eyes.sources.frames import Captured, gray_of_file, gray_of_image
from link.messages import CameraImage, CompressedPicture
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.units import NS_PER_S
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession

_CAPACITY = 4  # pictures; older ones are worth nothing
PICTURE_MAX_BYTES = 1 << 26
"""20 million pixels in three colours."""


class ZenohSource:
    """The pictures that are published on the drone's camera keys.

    Args:
        zenoh: an open session.
        keys: of the Zenoh contract.
        latency_s: by which the stamps are late.

    Attributes:
        bad_payloads: that were no picture.
        refused_why: what was wrong with the last of them, None while there was none.
    """

    is_live = True

    def __init__(self, zenoh: ZenohSession, keys: Keys, *, latency_s: float = 0.0) -> None:
        self.name = keys.camera_image
        self.bad_payloads = 0
        self.refused_why: str | None = None
        self._zenoh = zenoh
        self._latency_ns = round(latency_s * NS_PER_S)
        self._raw: Inbox = zenoh.subscribe(keys.camera_image, capacity=_CAPACITY, bytes_max=PICTURE_MAX_BYTES)
        self._files: Inbox = zenoh.subscribe(keys.camera_compressed, capacity=_CAPACITY, bytes_max=PICTURE_MAX_BYTES)

    def take(self, timeout_s: float) -> Captured | None:
        """Return the newest picture; what is none is counted."""
        until_s = time.monotonic() + timeout_s
        while True:
            newest = self._decode()
            left_s = until_s - time.monotonic()
            if newest is not None or left_s <= 0.0:
                return newest
            self._zenoh.wake_up.wait(left_s)

    def _decode(self) -> Captured | None:
        newest: Captured | None = None
        for payload in (sample.payload for sample in self._raw.take()[-1:]):
            newest = self._captured(payload, is_file=False) or newest
        for payload in (sample.payload for sample in self._files.take()[-1:]):
            newest = self._captured(payload, is_file=True) or newest
        return newest

    def _captured(self, payload: bytes, *, is_file: bool) -> Captured | None:
        try:
            if is_file:
                picture = cdr.decode(CompressedPicture, payload)
                return Captured(t_ns=picture.t_ns - self._latency_ns, shades=gray_of_file(picture))
            image = cdr.decode(CameraImage, payload)
            return Captured(t_ns=image.t_ns - self._latency_ns, shades=gray_of_image(image))
        except PayloadError as error:
            self.bad_payloads += 1
            self.refused_why = str(error)
            return None

    def has_ended(self) -> bool:
        """Return False: somebody may publish again."""
        return False

    def restart(self) -> None:
        """Do nothing: who publishes has to be started again."""

    def close(self) -> None:
        """Do nothing: the session belongs to the program."""
