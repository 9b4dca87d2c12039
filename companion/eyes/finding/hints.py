"""Why no tag of the board is read: the light, a mirrored picture, or a print of another kind; pure.

Of other families tags of 25 bits and more are tried, without any wrong one: chance reads them less than once in 5,000
squares.
"""

from functools import cache
from itertools import islice

import cv2
import numpy as np

from companion.eyes.board import Board
from companion.eyes.finding.reading import CONTRAST_MIN
from companion.eyes.finding.search import search
from companion.eyes.picture import Gray, Part, whole

_REDUCTION = 2  # four times as fast, and a user who looks for the cause holds the board near
_PASSES = 3  # of a search, up to this reduction
_SMOOTH_PX = 5  # over which a sensor's noise is averaged out
_WHITE, _WHITE_SHARE = 255, 0.5
_DIM = "the pictures show hardly anything: their shades differ by {} of 255; is the lens covered, or is it too dark?"
_BRIGHT = "{:.0f} % of the picture are overexposed: let the camera expose for less time"
_MIRRORED = "the pictures are mirrored: no tag can be read in them; switch the camera's mirror (h-flip) off"
_NEGATIVE = "tags are seen with black and white exchanged: print the board as the PDF has it"
_OTHER = "tags of {} are seen, and the board has AprilTag {}: print the board that `pad-detector print` draws"
_OTHERS = (
    ("AprilTag 36h10", cv2.aruco.DICT_APRILTAG_36h10),
    ("AprilTag 25h9", cv2.aruco.DICT_APRILTAG_25h9),
    ("ArUco 5x5", cv2.aruco.DICT_5X5_1000),
    ("ArUco 6x6", cv2.aruco.DICT_6X6_1000),
    ("ArUco 7x7", cv2.aruco.DICT_7X7_1000),
    ("ArUco MIP 36h12", cv2.aruco.DICT_ARUCO_MIP_36h12),
)
HINTS = 3 + len(_OTHERS)


def hint_of(shades: Gray, board: Board, number: int) -> str | None:
    """Return what is said of one of the causes, None where the picture does not speak for it.

    Args:
        shades: (rows, columns) of a picture in which no tag was read.
        board: that is looked for.
        number: of the cause, below `HINTS`.
    """
    if number == 0:
        return _light_of(shades)
    if number == 1:
        return _MIRRORED if _is_board(np.ascontiguousarray(shades[:, ::-1]), board) else None
    if number == 2:
        return _NEGATIVE if _is_board(255 - shades, board) else None
    name, table = _OTHERS[number - 3]
    return _OTHER.format(name, board.config.family) if _is_read(shades, table) else None


def _light_of(shades: Gray) -> str | None:
    """Return what is wrong with the light, None if the shades of a tag could be told apart."""
    smooth = cv2.blur(shades, (_SMOOTH_PX, _SMOOTH_PX))
    contrast = int(smooth.max()) - int(smooth.min())
    white = float(np.mean(shades == _WHITE))
    if white > _WHITE_SHARE:
        return _BRIGHT.format(100.0 * white)
    return _DIM.format(contrast) if contrast < CONTRAST_MIN else None


def _is_board(shades: Gray, board: Board) -> bool:
    """Return whether a tag of the board's family is found without the finest pass."""
    rows, columns = shades.shape
    passes = islice(search(Part(shades, whole((columns, rows))), board), _PASSES)
    return any(found.corners_px or found.foreign_ids for found in passes)


def _is_read(shades: Gray, table: int) -> bool:
    size = (shades.shape[1] // _REDUCTION, shades.shape[0] // _REDUCTION)
    if min(size) == 0:
        return False
    small = np.asarray(cv2.resize(shades, size, interpolation=cv2.INTER_AREA), np.uint8)
    corners, _, _ = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(table), _parameters()).detectMarkers(
        small
    )
    return len(corners) > 0


@cache
def _parameters() -> cv2.aruco.DetectorParameters:
    parameters = cv2.aruco.DetectorParameters()
    parameters.errorCorrectionRate = 0.0
    parameters.maxErroneousBitsInBorderRate = 0.0
    return parameters
