"""How fast the detector is on this computer, against OpenCV's bare detector on the same pictures, on one core.

The pictures are warps of the board, straight down and with noise, for the heights that a landing passes. A message is a
sighting encoded for Zenoh; its time is counted from the frame on.
"""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import TypedDict

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import Board, dictionary_of, nested_board
from companion.eyes.camera import Camera
from companion.eyes.mounting import MountingConfig, mounting_of
from companion.eyes.picture import Gray, WholePicture
from companion.eyes.plate import raster_of
from companion.eyes.sight import Frame, SightMemory, SightSystem, sight_step
from link.payloads import cdr


class Times(TypedDict):
    """Of one way of looking at all pictures, several times."""

    median_ms: float
    p99_ms: float
    frames_s: float


class Table(TypedDict):
    """What a bench has measured; the ratios say what its lines do."""

    searched: Times
    tracked: Times
    opencv: Times
    tracked_over_searched_speed: float
    searched_over_opencv_time: float


_SIZE_PX = (1280, 720)
_FOCAL_PX = 640.0
_HEIGHTS_M = (12.0, 6.0, 3.0, 1.5, 0.7, 0.3)
_BOARD_M = 1.5
_PIXEL_M = 0.001
_BLACK, _WHITE, _GROUND = 20.0, 200.0, 60.0
_NOISE_STD = 3.0
_BLUR_PX = 0.7
_ROUNDS = 5
_NEXT_NS = 33_000_000


def bench() -> Table:
    """Return times in ms, frames a second, and ratios: tracked against searched, and searched against OpenCV's own."""
    cv2.setNumThreads(1)
    board = Board(nested_board(_BOARD_M))
    width, height = _SIZE_PX
    matrix = np.array([[_FOCAL_PX, 0.0, 0.5 * width], [0.0, _FOCAL_PX, 0.5 * height], [0.0, 0.0, 1.0]])
    camera = Camera(model="pinhole", matrix=matrix, distortion=np.zeros(5), size_px=_SIZE_PX)
    system = SightSystem(camera=camera, mounting=mounting_of(MountingConfig()), board=board)
    pictures = list(_pictures(board, camera))
    searched = _times_ms(partial(_look, SightMemory(), t_ns=0, system=system), pictures)
    bare = _times_ms(_bare_detector(), pictures)
    tracked: list[float] = []
    for shades in pictures:
        memory, _ = sight_step(SightMemory(), Frame(t_ns=0, picture=WholePicture(shades)), system)
        tracked += _times_ms(partial(_look, memory, t_ns=_NEXT_NS, system=system), [shades])
    return {
        "searched": _row(searched),
        "tracked": _row(tracked),
        "opencv": _row(bare),
        "tracked_over_searched_speed": float(np.median(searched) / np.median(tracked)),
        "searched_over_opencv_time": float(np.mean(searched) / np.mean(bare)),
    }


def _look(memory: SightMemory, shades: Gray, *, t_ns: int, system: SightSystem) -> None:
    """Do all that a frame takes but to capture it and to send its message."""
    _, sight = sight_step(memory, Frame(t_ns=t_ns, picture=WholePicture(shades)), system)
    if sight.sighting is not None:
        cdr.encode(sight.sighting)


def _bare_detector() -> Callable[[Gray], object]:
    """Return OpenCV's detector as it is without anything set but what refines corners, as a pose needs them."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    return cv2.aruco.ArucoDetector(dictionary_of("36h11"), parameters).detectMarkers


def _times_ms(look: Callable[[Gray], object], pictures: list[Gray]) -> list[float]:
    """Return how long each look took, in processor time: others on the computer do not count."""
    look(pictures[0])
    found = []
    for _ in range(_ROUNDS):
        for shades in pictures:
            began_ns = time.thread_time_ns()
            look(shades)
            found.append((time.thread_time_ns() - began_ns) * 1e-6)
    return found


def _row(times_ms: list[float]) -> Times:
    return {
        "median_ms": float(np.median(times_ms)),
        "p99_ms": float(np.quantile(times_ms, 0.99)),
        "frames_s": float(1000.0 / np.mean(times_ms)),
    }


def _pictures(board: Board, camera: Camera) -> Iterator[Gray]:
    """Yield the board from each height, a little beside the axis."""
    rng = np.random.default_rng(1)
    plate: NDArray[np.float32] = np.asarray(_BLACK + (_WHITE - _BLACK) * raster_of(board.config, _PIXEL_M), np.float32)
    half_m = 0.5 * _BOARD_M
    to_plate = np.array(
        [[0.0, -_PIXEL_M, half_m - 0.5 * _PIXEL_M], [-_PIXEL_M, 0.0, half_m - 0.5 * _PIXEL_M], [0.0, 0.0, 1.0]]
    )
    for height_m in _HEIGHTS_M:
        seen = np.array([[0.0, -1.0, 0.05], [-1.0, 0.0, 0.03], [0.0, 0.0, height_m]])
        texels = height_m / (_FOCAL_PX * _PIXEL_M)
        smooth = cv2.GaussianBlur(plate, (0, 0), 0.5 * texels) if texels > 1.0 else plate
        warped = cv2.warpPerspective(smooth, camera.matrix @ seen @ to_plate, _SIZE_PX, borderValue=_GROUND)
        blurred = cv2.GaussianBlur(warped, (0, 0), _BLUR_PX)
        noisy = blurred + _NOISE_STD * rng.standard_normal(blurred.shape)
        yield np.clip(noisy, 0.0, 255.0).astype(np.uint8)


def text_lines(table: Table) -> list[str]:
    """Return the table for people."""
    lines = ["1280 x 720, one core       median      p99   frames/s"]
    for label, row in (
        ("searched in full", table["searched"]),
        ("tracked", table["tracked"]),
        ("OpenCV's detector alone", table["opencv"]),
    ):
        lines.append(f"{label:24} {row['median_ms']:6.1f} ms {row['p99_ms']:5.1f} ms {row['frames_s']:10.0f}")
    lines.append(f"tracked is {table['tracked_over_searched_speed']:.1f} times as fast as searched in full")
    lines.append(f"searched in full takes {table['searched_over_opencv_time']:.2f} of OpenCV's detector alone")
    return lines
