"""What the detector saw, drawn into its frame, or beside it as Foxglove lays it over."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.picture import Gray
from companion.eyes.sight import Sight, SightSystem
from link.payloads.annotations import annotations_message
from link.payloads.decklander_msgs import RosMessage

Color = tuple[float, float, float, float]

_GREEN: Color = (0.31, 0.86, 0.31, 1.0)
_YELLOW: Color = (1.0, 0.78, 0.0, 1.0)
_RED: Color = (0.9, 0.24, 0.24, 1.0)
_SHIFT = 4  # bits of a pixel's fraction that lines are drawn by
_QUALITY = 80  # of the JPEG
_TEXT_AT = (12, -14)  # from the left, from below


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """What is drawn on a frame.

    Attributes:
        outlines: of the plate and of the tags that were read, pixels (4, 2) each, with their colors (RGBA).
        text: what came of the frame.
        color: of the text.
    """

    outlines: tuple[tuple[NDArray[np.float64], Color], ...]
    text: str
    color: Color


def drawing_of(sight: Sight, system: SightSystem) -> Drawing:
    """Return what is to be drawn of a sight."""
    if sight.pose is None or sight.sighting is None:
        causes = (
            ("foreign ids", sight.foreign_ids),
            ("at two places", sight.doubled_ids),
            ("not where the board has them", sight.odd_ids),
        )
        why = "".join(f"; {cause} {sorted(ids)}" for cause, ids in causes if ids)
        return Drawing(outlines=(), text=f"no pad{why}", color=_RED)
    quads = [(system.board.outline_m, _GREEN)]
    quads += [(system.board.corners_m[tag_id], _YELLOW) for tag_id in sight.tags]
    side_px = -float(max(system.camera.size_px))
    outlines = tuple(
        (system.camera.pixels(corners_m, *sight.pose)[0], color)
        for corners_m, color in quads
        if system.camera.in_view(corners_m, *sight.pose, side_px).all()
    )
    x, y, z = sight.sighting.position_flu_m
    variance = sum(sight.sighting.position_covariance_m2[::4])
    text = (
        f"forward {x:+.2f} left {y:+.2f} up {z:+.2f} m, std {variance**0.5:.3f} m, {len(sight.tags)} tags, "
        f"{'tracked' if sight.tracked else 'searched'}"
    )
    return Drawing(outlines=outlines, text=text, color=_GREEN)


def annotate(shades: Gray, drawing: Drawing) -> NDArray[np.uint8]:
    """Return the frame (rows, columns, 3) with a drawing on it."""
    picture = np.asarray(cv2.cvtColor(shades, cv2.COLOR_GRAY2BGR), np.uint8)
    for pixels, color in drawing.outlines:
        points = np.round(pixels * 2**_SHIFT).astype(np.int32).reshape(-1, 1, 2)
        cv2.polylines(picture, [points], True, _bgr(color), 2, cv2.LINE_AA, _SHIFT)
    _write(picture, drawing.text, _bgr(drawing.color))
    return picture


def drawing_message(topic: str, t_ns: int, drawing: Drawing, size_px: tuple[int, int]) -> RosMessage:
    """Return a drawing as Foxglove lays it over the picture of `t_ns`."""
    outlines = [([(x, y) for x, y in pixels.tolist()], color) for pixels, color in drawing.outlines]
    place = (float(_TEXT_AT[0]), float(size_px[1] + _TEXT_AT[1]))
    return annotations_message(topic, t_ns, outlines, (place, drawing.text, drawing.color))


def _bgr(color: Color) -> tuple[int, int, int]:
    red, green, blue, _ = (round(255.0 * part) for part in color)
    return blue, green, red


def _write(picture: NDArray[np.uint8], text: str, color: tuple[int, int, int]) -> None:
    at = (_TEXT_AT[0], picture.shape[0] + _TEXT_AT[1])
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.7, (0, 0, 0), 4, cv2.LINE_AA)
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.7, color, 2, cv2.LINE_AA)


def jpeg_of(picture: NDArray[np.uint8]) -> bytes:
    """Return a picture, gray or in colors, as a JPEG file."""
    _, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    return bytes(data)
