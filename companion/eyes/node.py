"""The detector without I/O: frames and the companion's own state in, Zenoh payloads and news out."""

import math
from dataclasses import dataclass, field
from enum import Enum, auto

import numpy as np

from companion.eyes.alignment import is_told_wrong, no_alignment, turned_of, update_alignment
from companion.eyes.annotation import Drawing, annotate, drawing_of, jpeg_of
from companion.eyes.attitude import Attitude, attitude_at, with_attitude
from companion.eyes.calibration import check_size
from companion.eyes.camera import matrix_of
from companion.eyes.doubts import DoubtWatch, HintWatch
from companion.eyes.mounting import angles_of
from companion.eyes.picture import WholePicture
from companion.eyes.sight import Frame, Sight, SightMemory, SightSystem, sight_step
from companion.eyes.sources.frames import Captured
from link.errors import UserError
from link.frames.rotations import matrix_from_quaternion
from link.messages import BodyTruth, CompressedPicture, PadGeometry, PadSighting
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.units import NS_PER_S
from link.zenoh.keys import Keys, Publication

_STAMPS_NS = (int(0.1 * NS_PER_S), (1 << 31) * NS_PER_S - int(0.1 * NS_PER_S))
"""What a message can hold, less the half of a readout by which a sighting may be before or after its picture.

Below is what a driver sends that fills in no time at all: 0.
"""
_SIZE_SPARE = 1.02  # by which a board may be larger than the pad: what tape measures


@dataclass(slots=True)
class Counts:
    """What became of the frames."""

    frames: int = 0
    seen: int = 0
    tracked: int = 0
    bad_payloads: int = 0


class _Refused(Enum):
    """What pictures are passed over for."""

    SIZE = auto()
    TIME = auto()


@dataclass(slots=True)
class _News:
    foreign_ids: set[int] = field(default_factory=set)
    is_seen: bool = False
    is_turned: bool = False
    refused: set[_Refused] = field(default_factory=set)
    lines: list[str] = field(default_factory=list)


class EyesNode:
    """Sees the pad in one frame after the other.

    Args:
        system: camera, mounting and board.
        keys: of the Zenoh contract.
    """

    def __init__(self, system: SightSystem, keys: Keys) -> None:
        self.counts = Counts()
        self._system = system
        self._keys = keys
        self._memory = SightMemory()
        self._alignment = no_alignment()
        self._attitudes: tuple[Attitude, ...] = ()
        self._sight = Sight()
        self._news = _News()
        self._doubts = DoubtWatch()
        self._hints = HintWatch()

    def drawing(self) -> Drawing:
        """Return what is to be drawn on the frame that was looked at last."""
        return drawing_of(self._sight, self._system)

    def receive_own(self, payload: bytes) -> None:
        """Take what the companion tells of the drone; bad bytes are counted."""
        try:
            own = cdr.decode(BodyTruth, payload)
        except PayloadError:
            self.counts.bad_payloads += 1
            return
        attitude = Attitude(t_ns=own.t_ns, orientation_wxyz=own.orientation_wxyz)
        self._attitudes = with_attitude(self._attitudes, attitude)

    def receive_pad(self, pad: PadGeometry) -> None:
        """Check the vehicle's description of its pad against the board.

        Once the board has been seen, somebody may be flying by it: then a description that does not fit ends nothing.

        Raises:
            UserError: the board is larger than the pad that it should be on, and has not been seen yet.
        """
        board_m = self._system.board.config.size_m
        if all(own <= _SIZE_SPARE * told for own, told in zip(board_m, pad.size_m, strict=True)):
            return
        why = (
            "the board is {:g} x {:g} m and the vehicle's pad {:g} x {:g} m: give the board that is on it by "
            "--board, or correct the vehicle's size_m".format(*board_m, *pad.size_m)
        )
        if not self.counts.seen:
            raise UserError(why)
        self._news.lines.append(why)

    def look(self, captured: Captured, *, shows: bool) -> list[Publication]:
        """Return what a frame brings: a sighting, and with `shows` the frame with it drawn in.

        One without a time that can be told is passed over.

        Raises:
            UserError: the first frame's size is not the calibration's; later ones of another size are passed over.
        """
        if self.counts.frames and captured.size_px != self._system.camera.size_px:
            self._refuse(
                _Refused.SIZE,
                "pictures of {} x {} pixels are passed over: the calibration is for {} x {}".format(
                    *captured.size_px, *self._system.camera.size_px
                ),
            )
            return []
        check_size(self._system.camera, captured.size_px)
        if not _STAMPS_NS[0] <= captured.t_ns <= _STAMPS_NS[1]:
            why = "pictures without a time are passed over: their stamp should be the UTC of the exposure"
            self._refuse(_Refused.TIME, why)
            return []
        frame = Frame(
            t_ns=captured.t_ns,
            picture=WholePicture(captured.shades),
            orientation_wxyz=attitude_at(self._attitudes, captured.t_ns),
        )
        self._memory, sight = sight_step(self._memory, frame, self._system)
        self._count(sight)
        self._align(frame, sight)
        doubt = self._doubts.update(frame, sight, self._system.mounting)
        hint = self._hints.update(captured.shades, sight, self._system.board)
        self._news.lines += [line for line in (doubt, hint) if line is not None]
        self._sight = sight
        found: list[Publication] = []
        if sight.sighting is not None:
            payload = cdr.encode(sight.sighting)
            found.append(Publication(self._keys.pad_pose, payload, cdr.encoding_of(PadSighting)))
        if shows:
            drawn = jpeg_of(annotate(captured.shades, drawing_of(sight, self._system)))
            shown = CompressedPicture(t_ns=captured.t_ns, format="jpeg", data=drawn)
            found.append(Publication(self._keys.pad_view, cdr.encode(shown), cdr.encoding_of(CompressedPicture)))
        return found

    def _refuse(self, what: _Refused, why: str) -> None:
        """Count a picture that is passed over, and say why for the first one of its kind."""
        self.counts.bad_payloads += 1
        if what not in self._news.refused:
            self._news.refused.add(what)
            self._news.lines.append(why)

    def _count(self, sight: Sight) -> None:
        counts, news = self.counts, self._news
        counts.frames += 1
        counts.seen += sight.sighting is not None
        counts.tracked += sight.tracked
        if (sight.sighting is not None) != news.is_seen:
            news.is_seen = sight.sighting is not None
            news.lines.append("pad seen" if news.is_seen else "pad lost")
        unknown = sorted(sight.foreign_ids - news.foreign_ids)
        if unknown:
            news.foreign_ids |= sight.foreign_ids
            news.lines.append(
                f"tags {unknown} are seen that are not on the board: is this the --board that was printed?"
            )

    def _align(self, frame: Frame, sight: Sight) -> None:
        """Compare the pad's attitude with the drone's, and say once if the camera is turned otherwise than told."""
        if sight.sighting is None or sight.pose is None or frame.orientation_wxyz is None or self._news.is_turned:
            return
        mounting = self._system.mounting
        self._alignment = update_alignment(
            self._alignment,
            frame.t_ns,
            float(np.linalg.norm(sight.pose[1])),
            matrix_from_quaternion(sight.sighting.orientation_wxyz),
            matrix_from_quaternion(frame.orientation_wxyz),
        )
        turned = turned_of(self._alignment)
        if not is_told_wrong(turned, mounting.rotation_std_rad):
            return
        off = np.array([turned.about_x_rad, turned.about_y_rad, 0.0])
        self._news.is_turned = True
        self._news.lines.append(
            "the camera is turned by {:.1f} degrees (to {:.1f}) against its mounting file, or the autopilot is not "
            "level: roll_rad = {:.3f}, pitch_rad = {:.3f}, yaw_rad = {:.3f} would fit".format(
                math.degrees(float(np.linalg.norm(off))),
                math.degrees(turned.std_rad),
                *angles_of(matrix_of(off) @ mounting.R_BC),
            )
        )

    def take_news(self) -> list[str]:
        """Return what has happened since it was asked last."""
        lines, self._news.lines = self._news.lines, []
        return lines
