"""What `pad-detector calibrate` and `latency` gather from a source of frames before they compute."""

import time
from collections.abc import Callable

from companion.eyes.attitude import Attitude
from companion.eyes.board import Board
from companion.eyes.calibrating import Shot, covered_share, is_new, is_still, shot_of
from companion.eyes.calibration import check_size
from companion.eyes.picture import WholePicture
from companion.eyes.sight import Frame, SightMemory, SightSystem, sight_step
from companion.eyes.sources.frames import Source
from link.errors import UserError
from link.messages import BodyTruth, PadSighting
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.zenoh.inbox import Inbox

_WAIT_S = 0.1
_SILENT_MAX_S = 5.0  # of a source before its first picture, and of a camera in between

Say = Callable[[str], None]


class _Patience:
    """Ends with one line what waits for pictures that do not come."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self._came_s = time.monotonic()

    def note(self, *, came: bool) -> None:
        now_s = time.monotonic()
        if came:
            self._came_s = now_s
        elif now_s - self._came_s > _SILENT_MAX_S and not self._source.has_ended():
            raise UserError(
                f"--source {self._source.name} has given no picture for {_SILENT_MAX_S:g} s: start it again"
            )


def collect_shots(source: Source, board: Board, count: int, say: Say) -> tuple[list[Shot], tuple[int, int]]:
    """Return shots of the board that tell something new, and the pictures' size; of a file or folder from all of it.

    Raises:
        UserError: no picture comes, or one is of another size than the first.
    """
    shots: list[Shot] = []
    size_px: tuple[int, int] | None = None
    before: Shot | None = None
    patience = _Patience(source)
    while len(shots) < count and not source.has_ended():
        captured = source.take(_WAIT_S)
        patience.note(came=captured is not None)
        if captured is None:
            continue
        size_px = captured.size_px if size_px is None else size_px
        if captured.size_px != size_px:
            raise UserError(
                "pictures of {} x {} pixels after ones of {} x {}: use one".format(*captured.size_px, *size_px)
            )
        shot = shot_of(captured.shades, board)
        if shot is not None and is_new(shots, shot, size_px) and (not source.is_live or is_still(before, shot)):
            shots.append(shot)
            covered = 100.0 * covered_share(shots, size_px)
            say(f"{len(shots)} of {count} pictures, {covered:.0f} % of the picture covered")
        before = shot
    if size_px is None:
        raise UserError(f"--source {source.name} has no pictures")
    return shots, size_px


def collect_rotation(
    source: Source, own: Inbox, system: SightSystem, duration_s: float, say: Say
) -> tuple[list[Attitude], list[PadSighting]]:
    """Return the drone's attitudes and the sightings of the pad over some seconds.

    Raises:
        UserError: no picture comes, one does not fit the calibration, or the companion tells nothing of the drone.
    """
    attitudes: list[Attitude] = []
    sightings: list[PadSighting] = []
    memory, patience = SightMemory(), _Patience(source)
    end_s = time.monotonic() + duration_s
    while time.monotonic() < end_s and not source.has_ended():
        captured = source.take(_WAIT_S)
        attitudes += _attitudes_of(own)
        patience.note(came=captured is not None)
        if captured is None:
            continue
        check_size(system.camera, captured.size_px)
        latest = attitudes[-1].orientation_wxyz if attitudes else None
        frame = Frame(t_ns=captured.t_ns, picture=WholePicture(captured.shades), orientation_wxyz=latest)
        memory, sight = sight_step(memory, frame, system)
        if sight.sighting is not None:
            sightings.append(sight.sighting)
            if len(sightings) % 100 == 0:
                say(f"{len(sightings)} sightings")
    if not attitudes:
        raise UserError("the companion tells nothing of the drone's attitude: start `companion --dry-run` beside this")
    return attitudes, sightings


def _attitudes_of(own: Inbox) -> list[Attitude]:
    found = []
    for sample in own.take():
        try:
            told = cdr.decode(BodyTruth, sample.payload)
        except PayloadError:
            continue  # what is no state of the drone tells nothing; that none comes at all is said in the end
        found.append(Attitude(t_ns=told.t_ns, orientation_wxyz=told.orientation_wxyz))
    return found
