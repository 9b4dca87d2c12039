"""The tags of a family as they are printed: squares of 8 by 8 cells, the outer ring of them black.

The family 36h11 of AprilTag (Olson 2011) has 587 tags of 36 bits, any two of which differ in 11 bits or more however
they are turned, so that up to 5 wrong bits can be mended. OpenCV has them built in.
"""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

CELLS = 8
"""Along a side of a tag, its black border included."""

_FAMILIES = {"36h11": cv2.aruco.DICT_APRILTAG_36h11}


@cache
def dictionary_of(family: str) -> cv2.aruco.Dictionary:
    """Return OpenCV's table of the family."""
    return cv2.aruco.getPredefinedDictionary(_FAMILIES[family])


def ids_of(family: str) -> int:
    """Return how many tags the family has; their ids are counted from 0."""
    return len(dictionary_of(family).bytesList)


@cache
def cells_of(family: str, tag_id: int) -> NDArray[np.bool_]:
    """Return the cells of a tag (8, 8), row by row from its upper edge; true is white."""
    cells = dictionary_of(family).generateImageMarker(tag_id, CELLS) > 0
    cells.setflags(write=False)
    return cells
