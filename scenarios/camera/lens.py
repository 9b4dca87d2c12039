"""The lens of the simulated camera, and where its pixels look.

Global shutter, 1280 x 720 pixels of 3 um, 1.92 mm, F 2.4, focused at 1.2 m: 90 degrees along the picture and 58 across.
Blur is Gaussian: of the lens and its pixels 0.5 px; of defocus half the radius of the disc D f |1/z - 1/z_f| / 2.
Light falls off as the fourth power of the cosine.
"""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.camera import Camera
from companion.eyes.picture import Box

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

FOCAL_PX = 640.0
SIZE_PX = (1280, 720)
CAMERA = Camera(
    model="pinhole",
    matrix=np.array([[FOCAL_PX, 0.0, 642.3], [0.0, FOCAL_PX, 356.8], [0.0, 0.0, 1.0]]),
    distortion=np.array([-0.06, 0.012, 0.0004, -0.0003, 0.0]),
    size_px=SIZE_PX,
)
"""What is true of it; the detector is told this with the errors of a calibration."""

_APERTURE_M = 1.92e-3 / 2.4
_FOCUS_M = 1.2
_LENS_STD_PX = 0.5
MARGIN_PX = 8  # around the picture, for what blur brings in


def defocus_std_px(depth_m: float) -> float:
    """Return the standard deviation of all blur but motion's, for what is at a depth."""
    disc_px = 0.5 * _APERTURE_M * FOCAL_PX * abs(1.0 / max(depth_m, 0.02) - 1.0 / _FOCUS_M)
    return float(np.hypot(_LENS_STD_PX, 0.5 * disc_px))


@dataclass(frozen=True)
class Lens:
    """Directions and vignetting of each pixel of a camera, and of `MARGIN_PX` around its picture."""

    camera: Camera

    @cached_property
    def _rays(self) -> Floats:
        width, height = self.camera.size_px
        columns = np.arange(-MARGIN_PX, width + MARGIN_PX + 1)
        rows = np.arange(-MARGIN_PX, height + MARGIN_PX + 1)
        at = np.stack(np.meshgrid(columns, rows), axis=-1).astype(np.float64)
        return np.asarray(self.camera.rays(at.reshape(-1, 2)).reshape(at.shape), np.float32)

    @cached_property
    def _bright(self) -> Floats:
        return np.asarray((1.0 + (self._rays.astype(np.float64) ** 2).sum(axis=-1)) ** -2.0, np.float32)

    def within(self, box: Box) -> Box:
        """Return as much of a box as there are directions for."""
        width, height = self.camera.size_px
        return Box(
            max(box.left, -MARGIN_PX),
            max(box.top, -MARGIN_PX),
            min(box.right, width + MARGIN_PX),
            min(box.bottom, height + MARGIN_PX),
        )

    def vignetting(self, box: Box) -> Floats:
        """Return the share of the light (rows, columns) that reaches each pixel."""
        return self._bright[box.top + MARGIN_PX : box.bottom + MARGIN_PX, box.left + MARGIN_PX : box.right + MARGIN_PX]

    def rays(self, box: Box, *, is_fine: bool) -> Floats:
        """Return x/z and y/z (rows, columns, 2) of the pixels in a box, or of four points in each of them."""
        rows = slice(box.top + MARGIN_PX, box.bottom + MARGIN_PX)
        columns = slice(box.left + MARGIN_PX, box.right + MARGIN_PX)
        rays = self._rays[rows, columns]
        if not is_fine:
            return rays
        right, down = (
            np.diff(self._rays[rows, columns.start : columns.stop + 1], axis=1),
            np.diff(self._rays[rows.start : rows.stop + 1, columns], axis=0),
        )
        fine = np.empty((2 * rays.shape[0], 2 * rays.shape[1], 2), np.float32)
        for row, column in ((0, 0), (0, 1), (1, 0), (1, 1)):
            fine[row::2, column::2] = rays + (0.5 * row - 0.25) * down + (0.5 * column - 0.25) * right
        return fine


def smear(picture: Floats, motion_px: Array) -> Floats:
    """Return a picture (rows, columns) that moved by (2,) pixels, evenly, while it was exposed."""
    length_px = float(np.hypot(*motion_px))
    if length_px < 0.3:
        return picture
    half = int(np.ceil(0.5 * length_px)) + 1
    kernel = np.zeros((2 * half + 1, 2 * half + 1), np.float32)
    count = max(int(4.0 * length_px), 4)
    for share in (np.arange(count) + 0.5) / count - 0.5:
        x, y = half + share * motion_px
        left, top = int(x), int(y)
        for row, wy in ((top, 1.0 - (y - top)), (top + 1, y - top)):
            for column, wx in ((left, 1.0 - (x - left)), (left + 1, x - left)):
                kernel[row, column] += wx * wy / count
    return np.asarray(cv2.filter2D(picture, -1, kernel, borderType=cv2.BORDER_REPLICATE), np.float32)
