"""The detector's picture as the page shows it."""

import io
from typing import Any

import imageio.v3 as iio
import numpy as np
from numpy.typing import NDArray

from link.messages import CompressedPicture

_REDUCTION = 2  # of a picture of 1280 x 720 what the panel's width shows


def pixels_of(picture: CompressedPicture) -> NDArray[np.uint8] | None:
    """Return the pixels (rows, columns, 3), reduced, None of bytes that are no picture."""
    try:
        found: Any = iio.imread(io.BytesIO(picture.data), plugin="pillow")
    except (OSError, ValueError, SyntaxError):  # what pillow raises of bytes that are something else
        return None
    small = np.asarray(found, np.uint8)[::_REDUCTION, ::_REDUCTION]
    return np.ascontiguousarray(np.repeat(small[:, :, None], 3, axis=2) if small.ndim == 2 else small[:, :, :3])
