"""What the detector saw, drawn into its frame."""

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.picture import Gray
from companion.eyes.sight import Sight, SightSystem

_GREEN, _YELLOW, _RED = (80, 220, 80), (0, 200, 255), (60, 60, 230)
_SHIFT = 4  # bits of a pixel's fraction that lines are drawn by
_QUALITY = 80  # of the JPEG


def annotate(shades: Gray, sight: Sight, system: SightSystem) -> NDArray[np.uint8]:
    """Return the frame (rows, columns, 3) with the plate's outline, the tags that were read, and what came of it."""
    picture = np.asarray(cv2.cvtColor(shades, cv2.COLOR_GRAY2BGR), np.uint8)
    if sight.pose is None or sight.sighting is None:
        _write(picture, "no pad" if not sight.foreign_ids else f"no pad; foreign ids {sorted(sight.foreign_ids)}", _RED)
        return picture
    quads = [(system.board.outline_m, _GREEN)]
    quads += [(system.board.corners_m[tag_id], _YELLOW) for tag_id in sight.tags]
    for corners_m, color in quads:
        if system.camera.in_view(corners_m, *sight.pose, -float(max(shades.shape))).all():
            pixels, _ = system.camera.pixels(corners_m, *sight.pose)
            points = np.round(pixels * 2**_SHIFT).astype(np.int32).reshape(-1, 1, 2)
            cv2.polylines(picture, [points], True, color, 2, cv2.LINE_AA, _SHIFT)
    x, y, z = sight.sighting.position_flu_m
    variance = sum(sight.sighting.position_covariance_m2[::4])
    _write(
        picture,
        f"forward {x:+.2f} left {y:+.2f} up {z:+.2f} m, std {variance**0.5:.3f} m, {len(sight.tags)} tags, "
        f"{'tracked' if sight.tracked else 'searched'}",
        _GREEN,
    )
    return picture


def _write(picture: NDArray[np.uint8], text: str, color: tuple[int, int, int]) -> None:
    at = (12, picture.shape[0] - 14)
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.7, (0, 0, 0), 4, cv2.LINE_AA)
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.7, color, 2, cv2.LINE_AA)


def jpeg_of(picture: NDArray[np.uint8]) -> bytes:
    """Return a picture as a JPEG file."""
    _, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    return bytes(data)
