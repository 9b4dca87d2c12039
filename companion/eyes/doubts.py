"""Why a board that is there is not reported: what the user has to mend, said once for each cause."""

import math
from enum import Enum, auto

import numpy as np

from companion.eyes.alignment import upright
from companion.eyes.board import Board
from companion.eyes.camera import matrix_of
from companion.eyes.finding.hints import HINTS, hint_of
from companion.eyes.finding.pose import Pose
from companion.eyes.mounting import Mounting, angles_of
from companion.eyes.picture import Gray
from companion.eyes.sight import Frame, Sight
from link.frames.rotations import matrix_from_quaternion

_PICTURES = 30  # a second of most cameras: of a board that is carried, or a drone that flares, there are few
_HINT_EVERY = 4  # pictures without a tag: a look for one cause takes as long as a search's coarse passes
_HINT_TIMES = 3  # in a row: chance reads a tag of some family in one picture or another
_IDS_MAX = 5  # that are named


class Doubt(Enum):
    """Why a board that is read is not reported."""

    LEANING = auto()
    DOUBLED = auto()
    ODD = auto()


class DoubtWatch:
    """Counts the pictures since the last sighting in which the board was read and not believed."""

    def __init__(self) -> None:
        self._counts = dict.fromkeys(Doubt, 0)
        self._told: set[Doubt] = set()

    def update(self, frame: Frame, sight: Sight, mounting: Mounting) -> str | None:
        """Return what is to be said after a frame, None for nothing."""
        if sight.sighting is not None:
            self._counts = dict.fromkeys(Doubt, 0)
        doubt = _doubt_of(sight)
        if doubt is None:
            return None
        self._counts[doubt] += 1
        if self._counts[doubt] < _PICTURES or doubt in self._told:
            return None
        self._told.add(doubt)
        if doubt is Doubt.DOUBLED:
            return _doubled_line(sight.doubled_ids)
        if doubt is Doubt.ODD:
            return _odd_line(sight.odd_ids)
        return None if sight.leaning is None else _leaning_line(frame, sight.leaning, mounting)


def _doubt_of(sight: Sight) -> Doubt | None:
    if sight.leaning is not None:
        return Doubt.LEANING
    if sight.doubled_ids:
        return Doubt.DOUBLED
    return Doubt.ODD if sight.odd_ids else None


def ids_text(ids: frozenset[int]) -> str:
    """Return the lowest ids, and whether there are more."""
    shown = ", ".join(map(str, sorted(ids)[:_IDS_MAX]))
    return f"{shown} and {len(ids) - _IDS_MAX} more" if len(ids) > _IDS_MAX else shown


def _doubled_line(ids: frozenset[int]) -> str:
    return (
        f"the board is read but not reported: tags seen at two places are {ids_text(ids)}; which of two boards is the "
        "pad cannot be told: cover one, or print it with other ids (--first-id)"
    )


def _odd_line(ids: frozenset[int]) -> str:
    return (
        f"the board is read but not reported: tags not where the --board file has them are {ids_text(ids)}; measure "
        "sides and places of the printed tags, and see whether the --calibration is of this camera"
    )


def _leaning_line(frame: Frame, leaning: Pose, mounting: Mounting) -> str:
    R_WB = np.eye(3) if frame.orientation_wxyz is None else matrix_from_quaternion(frame.orientation_wxyz)
    off = upright(mounting.R_BC @ matrix_of(leaning[0]), R_WB)
    return (
        "the board is read but not reported: it would lean by {:.0f} degrees, which no deck does; is the camera "
        "turned otherwise than its --mounting says? About roll_rad = {:.1f}, pitch_rad = {:.1f}, yaw_rad = {:.1f} "
        "would fit".format(math.degrees(float(np.linalg.norm(off))), *angles_of(matrix_of(off) @ mounting.R_BC))
    )


class HintWatch:
    """Looks for the cause where no tag at all is read, until the first one is."""

    def __init__(self) -> None:
        self._pictures = 0
        self._counts = [0] * HINTS
        self._is_over = False

    def update(self, shades: Gray, sight: Sight, board: Board) -> str | None:
        """Return what is to be said after a frame, None for nothing."""
        is_read = sight.sighting is not None or sight.foreign_ids or _doubt_of(sight) is not None
        self._is_over = self._is_over or bool(is_read)
        if self._is_over:
            return None
        self._pictures += 1
        if self._pictures % _HINT_EVERY:
            return None
        number = self._pictures // _HINT_EVERY % HINTS
        text = hint_of(shades, board, number)
        self._counts[number] = 0 if text is None else self._counts[number] + 1
        self._is_over = self._counts[number] == _HINT_TIMES
        return text if self._is_over else None
