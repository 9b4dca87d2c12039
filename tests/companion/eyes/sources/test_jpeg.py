"""A JPEG file: its shades, and that of one of which a part was lost nothing is shown."""

import struct

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.sources.frames import gray_of_file
from link.messages import CompressedPicture
from link.payloads.checks import PayloadError


def jpeg(shades: NDArray[np.uint8]) -> bytes:
    return bytes(cv2.imencode(".jpg", shades)[1])


def scene() -> NDArray[np.uint8]:
    noise = np.random.default_rng(4).integers(0, 255, (240, 320), np.uint8)
    return np.asarray(cv2.GaussianBlur(noise, (9, 9), 0), np.uint8)


def shades_of(data: bytes) -> NDArray[np.uint8]:
    return gray_of_file(CompressedPicture(t_ns=1, format="jpeg", data=data))


@pytest.mark.parametrize("colored", [scene(), np.dstack([scene(), scene()[::-1], 255 - scene()])], ids=["gray", "bgr"])
def test_a_whole_jpeg_has_the_shades_that_opencv_finds(colored: NDArray[np.uint8]) -> None:
    data = jpeg(colored)
    assert (shades_of(data) == cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE)).all()


@pytest.mark.parametrize("lost_bytes", [512, 1400])
def test_a_jpeg_that_lost_a_part_on_its_way_is_refused_although_opencv_shows_it(lost_bytes: int) -> None:
    data = jpeg(scene())
    first, last = (
        data.index(b"\xff\xda") + 14,
        len(data) - lost_bytes - 2,
    )  # the end stays: without it, nothing is shown
    for begin in np.linspace(first, last, 40).astype(int).tolist():
        left = data[:begin] + data[begin + lost_bytes :]
        assert cv2.imdecode(np.frombuffer(left, np.uint8), cv2.IMREAD_GRAYSCALE) is not None
        with pytest.raises(PayloadError, match="a damaged JPEG: "):
            shades_of(left)


def test_a_jpeg_that_claims_to_be_enormous_is_refused_before_room_is_made_for_it() -> None:
    data = jpeg(scene())
    height_at = data.index(b"\xff\xc0") + 5
    with pytest.raises(PayloadError, match="a JPEG of 60000 x 60000 pixels"):
        shades_of(data[:height_at] + struct.pack(">HH", 60_000, 60_000) + data[height_at + 4 :])


def test_a_picture_keeps_its_cameras_rows_whatever_way_up_it_is_to_be_shown() -> None:
    a_quarter_turned = b"Exif\0\0MM\0*\0\0\0\x08" + struct.pack(">HHHIHHI", 1, 0x0112, 3, 1, 6, 0, 0)
    data = jpeg(scene())
    turned = data[:2] + b"\xff\xe1" + struct.pack(">H", len(a_quarter_turned) + 2) + a_quarter_turned + data[2:]
    upright = cv2.imdecode(np.frombuffer(turned, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert upright is not None
    assert upright.shape == (320, 240)
    assert (shades_of(turned) == shades_of(data)).all()
