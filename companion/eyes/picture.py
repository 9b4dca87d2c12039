"""A picture from which only parts are taken: of a whole frame a view, of a rendered one what is looked at."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Gray = NDArray[np.uint8]


class Box(NamedTuple):
    """A part of a picture: the first column and row in it, and the first ones beyond it."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def area(self) -> int:
        """In pixels; 0 where nothing is in it."""
        return max(self.right - self.left, 0) * max(self.bottom - self.top, 0)


@dataclass(frozen=True)
class Part:
    """A part of a picture, asked for by places in the whole picture.

    Attributes:
        shades: (rows, columns).
        box: where they are.
    """

    shades: Gray
    box: Box

    @cached_property
    def _floats(self) -> NDArray[np.float32]:
        return self.shades.astype(np.float32)

    def holds(self, pixels: Array) -> NDArray[np.bool_]:
        """Return of places (..., 2) whether each has pixels all around it."""
        box = self.box
        x, y = pixels[..., 0], pixels[..., 1]
        return np.asarray((x >= box.left) & (x <= box.right - 1) & (y >= box.top) & (y <= box.bottom - 1))

    def sample(self, pixels: Array) -> NDArray[np.float32]:
        """Return the shades at places (N, M, 2), between pixels in proportion; what is not held is black."""
        at = (pixels - np.array([self.box.left, self.box.top])).astype(np.float32)
        return remapped(self._floats, at, cv2.BORDER_CONSTANT)


class Picture(Protocol):
    """A picture in shades of gray."""

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""

    def part(self, box: Box) -> Part:
        """Return what is within `box`, which is within the picture."""


class WholePicture:
    """A picture that is there as a whole.

    Args:
        shades: (rows, columns).
    """

    def __init__(self, shades: Gray) -> None:
        self.shades = shades

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        rows, columns = self.shades.shape
        return columns, rows

    def part(self, box: Box) -> Part:
        """Return what is within `box`."""
        return Part(self.shades[box.top : box.bottom, box.left : box.right], box)


def whole(size_px: tuple[int, int]) -> Box:
    """Return the box of a whole picture."""
    return Box(0, 0, *size_px)


def box_around(pixels: Array, margin_px: float, size_px: tuple[int, int]) -> Box:
    """Return the box within a picture that holds `pixels` (N, 2) and `margin_px` about them."""
    low = np.floor(np.min(pixels, axis=0) - margin_px)
    high = np.ceil(np.max(pixels, axis=0) + margin_px) + 1.0
    limit = np.array(size_px, np.float64)
    left, top = np.clip(low, 0.0, limit).astype(int).tolist()
    right, bottom = np.clip(high, 0.0, limit).astype(int).tolist()
    return Box(left, top, right, bottom)


def remapped(shades: NDArray[np.float32], at: NDArray[np.float32], border: int) -> NDArray[np.float32]:
    """Return `shades` (rows, columns) at places (N, M, 2), columns and rows; OpenCV rounds them to 1/32."""
    found = cv2.remap(shades, at, None, cv2.INTER_LINEAR, borderMode=border)  # type: ignore[call-overload]  # see below
    return np.asarray(found, np.float32)  # OpenCV's types do not know that one map may hold both coordinates
