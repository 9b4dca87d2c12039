"""Frames as they come from a source: the shades of a picture, and when it was taken."""

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
import simplejpeg

from companion.eyes.picture import Gray
from companion.eyes.sources import PIXELS_MAX
from link.messages import CameraImage, CompressedPicture
from link.payloads.checks import PayloadError

_GRAY_OF = {
    "bgr8": cv2.COLOR_BGR2GRAY,
    "rgb8": cv2.COLOR_RGB2GRAY,
    "bgra8": cv2.COLOR_BGRA2GRAY,
    "rgba8": cv2.COLOR_RGBA2GRAY,
}
_JPEG = b"\xff\xd8\xff"  # begins with it; one that was cut short does not end as one does
_CHANNELS = {"mono8": 1, "8UC1": 1, "bgr8": 3, "rgb8": 3, "bgra8": 4, "rgba8": 4}


@dataclass(frozen=True, slots=True, kw_only=True)
class Captured:
    """A picture in shades of gray (rows, columns), taken at `t_ns` (UTC, the middle of its exposure)."""

    t_ns: int
    shades: Gray

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        rows, columns = self.shades.shape
        return columns, rows


class Source(Protocol):
    """Where frames come from."""

    name: str
    is_live: bool
    """Whether a frame that does not come is a failure, and one that does not change."""
    refused_why: str | None
    """Why what came last and was no picture was none."""

    def take(self, timeout_s: float) -> Captured | None:
        """Return the newest frame that was not taken yet, None where none comes in time."""

    def has_ended(self) -> bool:
        """Return whether no frame will come any more: a file is at its end."""

    def restart(self) -> None:
        """Open it again, as well as that is possible."""

    def close(self) -> None:
        """Let it go."""


def gray_of_image(image: CameraImage) -> Gray:
    """Return the shades of a raw picture.

    Raises:
        PayloadError: its pixels are of another kind, or fewer than it says.
    """
    channels = _CHANNELS.get(image.encoding)
    if channels is None:
        raise PayloadError(f"pictures of encoding {image.encoding!r} are not read; {', '.join(_CHANNELS)} are")
    if image.row_bytes < image.width_px * channels:
        raise PayloadError(f"a row of {image.row_bytes} bytes does not hold {image.width_px} pixels")
    rows = np.frombuffer(image.data, np.uint8).reshape(image.height_px, image.row_bytes)
    pixels = rows[:, : image.width_px * channels]
    if channels == 1:
        return np.ascontiguousarray(pixels)
    colored = np.ascontiguousarray(pixels.reshape(image.height_px, image.width_px, channels))
    return np.asarray(cv2.cvtColor(colored, _GRAY_OF[image.encoding]), np.uint8)


def gray_of_file(picture: CompressedPicture) -> Gray:
    """Return the shades of a compressed picture as the camera's pixels lie, whatever way up it says to be shown.

    Raises:
        PayloadError: it cannot be read, or is a JPEG of which a part was lost.
    """
    if picture.data.startswith(_JPEG):
        return _gray_of_jpeg(picture.data)
    try:
        found = cv2.imdecode(
            np.frombuffer(picture.data, np.uint8), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
        )
    except cv2.error as error:  # of an empty one, or of one that says to be enormous
        raise PayloadError(f"no picture: {str(error).splitlines()[0]}") from None
    if found is None:
        raise PayloadError(f"{len(picture.data)} bytes are no picture of format {picture.format!r}")
    return np.asarray(found, np.uint8)


def _gray_of_jpeg(data: bytes) -> Gray:
    """Return its shades.

    What comes behind a lost part is decoded, too, but belongs elsewhere in the picture: OpenCV shows it where the lost
    part was, with the pad metres away from where it is.
    """
    try:
        height_px, width_px, *_ = simplejpeg.decode_jpeg_header(data)
        is_enormous = height_px * width_px > PIXELS_MAX
        shades = None if is_enormous else simplejpeg.decode_jpeg(data, colorspace="GRAY", strict=True)
    except ValueError as error:
        raise PayloadError(f"a damaged JPEG: {error}") from None
    if shades is None:
        raise PayloadError(f"a JPEG of {width_px} x {height_px} pixels; at most {PIXELS_MAX} are read")
    return np.asarray(shades[:, :, 0], np.uint8)
