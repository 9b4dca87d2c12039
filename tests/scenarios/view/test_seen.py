"""What the panel and Foxglove show of what the detector sees."""

from typing import Any, cast

import cv2
import imageio.v3 as iio
import numpy as np
import pytest

from companion.config.descent import DescentConfig
from link.messages import CompressedPicture, PadSighting
from link.payloads import cdr
from link.payloads.decklander_msgs import RosMessage
from link.recording.foxglove_server import FoxgloveServer
from link.zenoh.keys import Keys
from scenarios.view.foxglove import FoxgloveView
from scenarios.view.live import LiveSource
from scenarios.view.panel import pixels_of
from scenarios.view.panel_text import seen_text
from scenarios.view.state import StateReader, ViewState

KEYS = Keys()
SIGHTING = PadSighting(
    t_ns=4_800_000_000,
    position_flu_m=(0.3, -0.4, -1.2),
    orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
    position_covariance_m2=(1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 9e-4),
)


def jpeg(shades: np.ndarray[Any, np.dtype[np.uint8]]) -> CompressedPicture:
    return CompressedPicture(t_ns=7, format="jpeg", data=bytes(cv2.imencode(".jpg", shades)[1]))


def test_panel_says_how_far_how_well_and_how_long_ago_the_pad_was_seen() -> None:
    state = StateReader(KEYS).taken(ViewState(t_ns=5_000_000_000), KEYS.pad_pose, cdr.encode(SIGHTING))
    assert seen_text(state) == "1.30 m away to 0.03 m, 0.2 s ago"
    assert seen_text(ViewState()) == "-"


@pytest.mark.parametrize("shape", [(40, 60), (40, 60, 3)])
def test_picture_is_shown_in_half_its_size_whether_gray_or_not(shape: tuple[int, ...]) -> None:
    pixels = pixels_of(jpeg(np.full(shape, 90, np.uint8)))
    assert pixels is not None
    assert pixels.shape == (20, 30, 3)
    assert abs(pixels.astype(float) - 90.0).max() < 3.0


@pytest.mark.parametrize("data", [b"", b"no picture", bytes(range(256)) * 4])
def test_bytes_that_are_no_picture_show_nothing(data: bytes) -> None:
    assert pixels_of(CompressedPicture(t_ns=7, format="jpeg", data=data)) is None


def test_moving_picture_shows_its_first_one_and_cut_short_anywhere_never_raises() -> None:
    first = np.full((12, 8, 3), (200, 40, 90), np.uint8)
    data = iio.imwrite("<bytes>", np.stack((first, 255 - first)), extension=".gif")
    shown = [pixels_of(CompressedPicture(t_ns=7, format="gif", data=data[:end])) for end in range(len(data) + 1)]
    assert shown[-1] is not None
    assert shown[-1].tolist() == first[::2, ::2].tolist()
    assert {one.shape for one in shown if one is not None} == {(6, 4, 3)}


def test_foxglove_has_each_picture_once() -> None:
    sent: list[RosMessage] = []
    state = ViewState(t_ns=9, picture=jpeg(np.zeros((8, 8), np.uint8)))
    source: Any = type("Source", (), {"advance": lambda *_: state})()
    server: Any = type("Server", (), {"add": lambda _, message, __: sent.append(message)})()
    view = FoxgloveView(cast("LiveSource", source), DescentConfig(), KEYS, cast("FoxgloveServer", server))
    for tick in range(3):
        view.show(tick, 0.05 * tick)
    assert [message.topic for message in sent].count(KEYS.pad_view) == 1
