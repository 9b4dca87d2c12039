"""What a camera's shutter and the drops on its window make of a picture.

Rolling shutter: rows are read one after the other, the middle one in the middle of the picture's time. What a pixel
sees then is what another one would have seen in the middle; the difference is its motion by as much time, to first
order, for the plane of the deck.

Drops: on a window 10 mm before the lens a drop 2 mm wide is 130 pixels wide, its edge as soft as the aperture of 0.8 mm
is wide from there, 50 pixels. Through it the scene is out of focus.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.picture import Box
from scenarios.camera.lens import MARGIN_PX, SIZE_PX
from scenarios.camera.planes import View

Floats = NDArray[np.float32]

_RADIUS_PX = (32.0, 95.0)  # of drops 1 to 3 mm wide
_EDGE_STD_PX = 15.0  # a disc of 50 pixels as a Gaussian
_THROUGH_STD_PX = 12.0
_INVERSE_DEPTH_MAX = 33.0  # 1/m


@dataclass(frozen=True, slots=True, kw_only=True)
class Optics:
    """Seconds from reading the first row to reading the last (0: global shutter); share of the window with drops."""

    readout_s: float = 0.0
    wet_share: float = 0.0


def rolled(rays: Floats, box: Box, view: View, height_m: float, readout_s: float) -> Floats:
    """Return the rays of the picture's middle time that see what each pixel sees when its row is read.

    Args:
        rays: x/z and y/z (rows, columns, 2) of the pixels, or of several points in each of them.
        box: that they are of.
        view: in the middle of the picture's time.
        height_m: of the deck.
        readout_s: from the first row to the last.
    """
    points = rays.shape[0] / (box.bottom - box.top)
    row = box.top + (np.arange(rays.shape[0]) + 0.5) / points - 0.5
    late_s = ((row / (SIZE_PX[1] - 1.0) - 0.5) * readout_s).astype(np.float32)[:, None]
    x, y = rays[..., 0], rays[..., 1]
    down = view.R_VC[2].astype(np.float32)
    below_m = np.float32(min(height_m - float(view.camera_m[2]), -0.01))
    inverse_depth = np.clip((down[0] * x + down[1] * y + down[2]) / below_m, 0.0, _INVERSE_DEPTH_MAX)
    u, v, w = (-view.R_VC.T @ view.velocity_m_s).astype(np.float32)
    p, q, r = view.turning_c_rad_s.astype(np.float32)
    rate_z = w * inverse_depth - (p * y - q * x)
    rate_x = u * inverse_depth - (q - r * y) - x * rate_z
    rate_y = v * inverse_depth - (r * x - p) - y * rate_z
    return np.stack([x - late_s * rate_x, y - late_s * rate_y], axis=-1)


def draw_drops(share: float, rng: np.random.Generator) -> Floats:
    """Return how much (rows, columns) of what each pixel sees, `MARGIN_PX` around the picture too, is through drops."""
    width, height = SIZE_PX[0] + 2 * MARGIN_PX, SIZE_PX[1] + 2 * MARGIN_PX
    covered = np.zeros((height, width), np.float32)
    while float(covered.mean()) < share:
        center = (int(rng.integers(0, width)), int(rng.integers(0, height)))
        cv2.circle(covered, center, int(rng.uniform(*_RADIUS_PX)), 1.0, thickness=-1)
    return np.asarray(cv2.GaussianBlur(covered, (0, 0), _EDGE_STD_PX), np.float32)


def seen_through(shades: Floats, drops: Floats) -> Floats:
    """Return the picture (rows, columns) as it is through drops that cover shares (rows, columns) of it."""
    if float(drops.max()) < 0.01:
        return shades
    blurred = np.asarray(cv2.GaussianBlur(shades, (0, 0), _THROUGH_STD_PX), np.float32)
    return np.asarray(shades + drops * (blurred - shades), np.float32)
