"""A calibrated camera: projects points to pixels and back.

Frame C: x to the right of the picture, y downwards, z along the optical axis. A pixel's centre has whole coordinates.
Models: `pinhole` with OpenCV's distortion of 4 to 14 coefficients (Brown and Conrady; ROS calls it plumb_bob or
rational_polynomial, kalibr radtan), and `fisheye` with 4 (Kannala and Brandt; equidistant in ROS and kalibr).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Model = Literal["pinhole", "fisheye"]

_EDGE_POINTS = 16  # along each side of the picture, to find how far from the axis it reaches
_UNDISTORT = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-8)


@dataclass(frozen=True)
class Camera:
    """A camera as its calibration describes it.

    Attributes:
        model: of the distortion.
        matrix: (3, 3) with focal lengths and principal point, pixels.
        distortion: coefficients in OpenCV's order.
        size_px: width and height of the pictures that it was calibrated for.
    """

    model: Model
    matrix: Array
    distortion: Array
    size_px: tuple[int, int]

    @property
    def focal_px(self) -> float:
        """The mean of the two focal lengths: pixels a radian near the axis."""
        return float(0.5 * (self.matrix[0, 0] + self.matrix[1, 1]))

    @cached_property
    def radius_max(self) -> float:
        """The tangent of the angle from the axis that the picture's farthest corner shows.

        Beyond it the polynomials of the distortion may fold back into the picture.
        """
        width, height = self.size_px
        x = np.linspace(0.0, width - 1.0, _EDGE_POINTS)
        y = np.linspace(0.0, height - 1.0, _EDGE_POINTS)
        edge = np.concatenate(
            [np.column_stack([x, np.full_like(x, at)]) for at in (0.0, height - 1.0)]
            + [np.column_stack([np.full_like(y, at), y]) for at in (0.0, width - 1.0)]
        )
        return float(np.max(np.hypot(*self.rays(edge).T)))

    def rays(self, pixels: Array) -> Array:
        """Return the directions of pixels (N, 2) as x/z and y/z in C (N, 2)."""
        points = np.ascontiguousarray(pixels, np.float64).reshape(-1, 1, 2)
        if self.model == "fisheye":
            found = cv2.fisheye.undistortPoints(points, self.matrix, self.distortion)
        else:
            found = cv2.undistortPoints(points, self.matrix, self.distortion, criteria=_UNDISTORT)
        return np.asarray(found, np.float64).reshape(-1, 2)

    def pixels(self, places: Array, rotation: Array, translation: Array) -> tuple[Array, Array]:
        """Return where places are seen, and how that changes with the pose.

        Args:
            places: (N, 3) in any frame P.
            rotation: (3,) rotation vector of R_CP.
            translation: (3,) p_CP, m.

        Returns:
            Pixels (N, 2) and their derivatives (N, 2, 6) with the rotation vector, then the translation.
        """
        points = np.ascontiguousarray(places, np.float64).reshape(-1, 1, 3)
        if self.model == "fisheye":
            found, slopes = cv2.fisheye.projectPoints(points, rotation, translation, self.matrix, self.distortion)
            first = 8  # after focal lengths, principal point and four coefficients
        else:
            found, slopes = cv2.projectPoints(points, rotation, translation, self.matrix, self.distortion)
            first = 0
        slopes = np.asarray(slopes, np.float64)[:, first : first + 6]
        return np.asarray(found, np.float64).reshape(-1, 2), slopes.reshape(-1, 2, 6)

    def in_view(self, places: Array, rotation: Array, translation: Array, margin_px: float = 0.0) -> NDArray[np.bool_]:
        """Return of places (N, 3) whether each is in front of the camera and `margin_px` within the picture."""
        in_c = places @ matrix_of(rotation).T + translation
        depth = np.maximum(in_c[:, 2], 1e-6)
        ahead = (in_c[:, 2] > 1e-3) & (np.hypot(in_c[:, 0], in_c[:, 1]) <= self.radius_max * depth)
        pixels, _ = self.pixels(places, rotation, translation)
        width, height = self.size_px
        inside = np.all((pixels >= margin_px) & (pixels <= np.array([width, height]) - 1.0 - margin_px), axis=1)
        return np.asarray(ahead & inside)


def matrix_of(rotation: Array) -> Array:
    """Return the matrix (3, 3) of a rotation vector."""
    return np.asarray(cv2.Rodrigues(np.asarray(rotation, np.float64))[0], np.float64)


def vector_of(matrix: Array) -> Array:
    """Return the rotation vector (3,) of a matrix."""
    return np.asarray(cv2.Rodrigues(matrix)[0], np.float64).ravel()
