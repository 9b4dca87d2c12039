"""One frame: where the pad is in it, a pure function of what was seen before, the frame, its time and the calibration.

A pad that has just been seen is looked for where it should be now (tracking): no tag is searched, those that are read
at the expected pose give it by their edges. Only when that fails is the picture searched.

Frames: W with z up, B the drone's body (FLU), C the camera, P the pad. Without the drone's attitude B is taken for
level.
"""

from dataclasses import dataclass

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from companion.eyes.board import CELLS, Board
from companion.eyes.camera import Camera, matrix_of
from companion.eyes.finding.agreement import most_agree, odd_ids
from companion.eyes.finding.choosing import (
    TILT_STDS_MAX,
    Candidate,
    Chosen,
    better,
    choose,
    leaning_of,
    mirrored,
    tilt_stds,
)
from companion.eyes.finding.pose import Pose, guesses, refine
from companion.eyes.finding.reading import TAGS_MAX, read_best
from companion.eyes.finding.search import search
from companion.eyes.finding.track import Track, expected_pose, update_track
from companion.eyes.mounting import Mounting, covariance_flu_m2
from companion.eyes.picture import Part, Picture, box_around, whole
from link.frames.rotations import matrix_from_quaternion, quaternion_from_matrix
from link.messages import PadSighting, Quaternion

Array = NDArray[np.float64]

_MARGIN_SHARE, _MARGIN_PX = 0.1, 12.0  # about the pad where it is looked for: of its size in the picture, and at least
_RMS_SHARE_MAX = 0.35  # of a cell of the largest tag: edges farther off are other edges
_RMS_MIN_PX = 1.0
_ROUNDS_MAX = 4
_SEARCH_NS = 1_000_000_000  # between two searches beside a track that reads less than that
_COMPLETE_SHARE = 0.5  # of the tags that should be seen: with more no other pass is needed to place the pad


class SightMemory(Struct, frozen=True, kw_only=True):
    """What is kept from frame to frame: where the pad was seen last, and when the picture was searched last."""

    track: Track | None = None
    searched_ns: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SightSystem:
    """What does not change: the camera, how it is mounted, and the board that it looks for."""

    camera: Camera
    mounting: Mounting
    board: Board


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """A picture, taken at `t_ns` (UTC, the middle of its exposure) by a drone of attitude q_WB, None where unknown."""

    t_ns: int
    picture: Picture
    orientation_wxyz: Quaternion | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Sight:
    """What was seen in a frame.

    Attributes:
        sighting: of the pad, None where it was not seen.
        pose: of the board in the camera, None where it was not seen.
        tags: that the pose rests on.
        rms_px: of the edges' distances from it.
        tracked: it was found without a search.
        is_complete: most tags were read that should be seen.
        foreign_ids: tags of the family that are not on the board, as far as it was searched.
        leaning: the most level pose of a pad that was read but not believed, since no deck leans so far.
        doubled_ids: of tags of the board that are seen at two places, so that the pad may be either.
        odd_ids: of tags of the board that are not where a pose has them, if these are most: none was believed.
    """

    sighting: PadSighting | None = None
    pose: Pose | None = None
    tags: tuple[int, ...] = ()
    rms_px: float | None = None
    tracked: bool = False
    is_complete: bool = False
    foreign_ids: frozenset[int] = frozenset()
    leaning: Pose | None = None
    doubled_ids: frozenset[int] = frozenset()
    odd_ids: frozenset[int] = frozenset()


def sight_step(memory: SightMemory, frame: Frame, system: SightSystem) -> tuple[SightMemory, Sight]:
    """Return what is kept for the next frame, and what was seen in this one."""
    R_WB = np.eye(3) if frame.orientation_wxyz is None else matrix_from_quaternion(frame.orientation_wxyz)
    R_WC = R_WB @ system.mounting.R_BC
    expected = expected_pose(memory.track, frame.t_ns, R_WC)
    sight = None if expected is None else _track(frame, system, R_WB, expected)
    if sight is None or _is_search_due(memory, sight, frame.t_ns):
        found = _search(frame, system, R_WB)
        memory = SightMemory(track=None if found.odd_ids else memory.track, searched_ns=frame.t_ns)
        sight = found if sight is None or found.odd_ids else sight
    if sight.pose is None:
        return memory, sight  # it is expected for a while where it was going
    track = update_track(memory.track, frame.t_ns, sight.pose, R_WC)
    return SightMemory(track=track, searched_ns=memory.searched_ns), sight


def _is_search_due(memory: SightMemory, tracked: Sight, t_ns: int) -> bool:
    """Return whether a track should be compared with all tags in the picture.

    One that began with a single tag goes on with it if the other tags are not where the board's file has them.
    """
    if tracked.is_complete or memory.searched_ns is None:
        return False
    return not 0 <= t_ns - memory.searched_ns < _SEARCH_NS


def _track(frame: Frame, system: SightSystem, R_WB: Array, expected: Pose) -> Sight | None:
    """Return the pad near where it is expected, None where it is not seen there."""
    pixels, _ = system.camera.pixels(system.board.outline_m, *expected)
    if not system.camera.in_view(system.board.outline_m, *expected, -float(max(frame.picture.size_px))).all():
        box = whole(frame.picture.size_px)
    else:
        margin_px = max(_MARGIN_PX, _MARGIN_SHARE * float(np.ptp(pixels, axis=0).max()))
        box = box_around(pixels, margin_px, frame.picture.size_px)
    if box.area == 0:
        return None
    candidate = _settle(frame.picture.part(box), system, R_WB, frame, expected)
    if candidate is None or candidate.tilt_stds > TILT_STDS_MAX:
        return None
    return _sight(frame, system, candidate, None, tracked=True)


def _search(frame: Frame, system: SightSystem, R_WB: Array) -> Sight:
    """Return the pad wherever it is in the picture; where a pass finds few tags, the next may find more.

    Once the pad is placed, the passes without mud are made all the same: coarse ones show one of two like boards only.
    """
    part = frame.picture.part(whole(frame.picture.size_px))
    foreign: frozenset[int] = frozenset()
    seen: dict[int, Array] = {}
    best: Chosen | None = None
    leaning: Pose | None = None
    is_explained = is_placed = False
    for found in search(part, system.board):
        foreign |= found.foreign_ids
        seen |= found.corners_px
        if found.doubled_ids:
            return Sight(foreign_ids=foreign, doubled_ids=found.doubled_ids)
        if not is_placed:
            near = _candidates(part, system, R_WB, frame, guesses(system.camera, system.board, found.corners_px))
            is_explained = is_explained or bool(near)
            best, leaning = better(best, choose(near)), leaning_of(near) or leaning
            is_placed = best is not None and best[0].is_complete
        if best is not None and found.is_followed_by_mud:
            break
    if best is None:
        return Sight(foreign_ids=foreign, leaning=leaning, odd_ids=frozenset() if is_explained else frozenset(seen))
    odd = odd_ids(system.camera, system.board, best[0].refined.pose, seen)
    if not most_agree(odd, seen):
        return Sight(foreign_ids=foreign, odd_ids=odd)
    return _sight(frame, system, *best, tracked=False, foreign_ids=foreign)


def _candidates(part: Part, system: SightSystem, R_WB: Array, frame: Frame, near: list[Pose]) -> list[Candidate]:
    """Return the poses near guesses; where there is one only, the one that mirrors it is looked for as well."""
    found = [one for guess in near if (one := _settle(part, system, R_WB, frame, guess)) is not None]
    if len(found) == 1:
        other = _settle(part, system, R_WB, frame, mirrored(found[0].refined.pose))
        found += [] if other is None else [other]
    return found


def _settle(part: Part, system: SightSystem, R_WB: Array, frame: Frame, guess: Pose) -> Candidate | None:
    """Return the pose near a guess; the better it gets, the more tags are read, until these are all."""
    camera, board = system.camera, system.board
    pose, refined = guess, None
    used, expected = read_best(part, system.camera, system.board, guess)
    for _ in range(_ROUNDS_MAX):
        found = refine(part, camera, board, pose, used) if used else None
        if found is None:
            break
        pose, refined, before = found.pose, found, used
        used, expected = read_best(part, system.camera, system.board, pose)
        if used.keys() <= before.keys():
            break
    if refined is None or not used or refined.rms_px > max(_RMS_MIN_PX, _RMS_SHARE_MAX * max(used.values()) / CELLS):
        return None
    return Candidate(
        refined=refined,
        tags=tuple(used),
        tilt_stds=tilt_stds(
            R_WB @ system.mounting.R_BC @ matrix_of(pose[0]), is_level_known=frame.orientation_wxyz is not None
        ),
        is_complete=len(used) > _COMPLETE_SHARE * min(expected, TAGS_MAX),
    )


def _sight(
    frame: Frame,
    system: SightSystem,
    candidate: Candidate,
    other: Candidate | None,
    *,
    tracked: bool,
    foreign_ids: frozenset[int] = frozenset(),
) -> Sight:
    mounting, refined = system.mounting, candidate.refined
    rotation, translation = refined.pose
    in_c = refined.covariance[3:, 3:]
    if other is not None:
        apart = other.refined.pose[1] - translation
        in_c = in_c + 0.25 * np.outer(apart, apart)
    in_b = covariance_flu_m2(mounting, translation, in_c)
    x, y, z = (mounting.R_BC @ translation + mounting.position_flu_m).tolist()
    a, b, c, d, e, f, g, h, i = in_b.ravel().tolist()
    sighting = PadSighting(
        t_ns=frame.t_ns + round(_late_s(candidate, system) * 1e9),
        position_flu_m=(x, y, z),
        orientation_wxyz=quaternion_from_matrix(mounting.R_BC @ matrix_of(rotation)),
        position_covariance_m2=(a, b, c, d, e, f, g, h, i),
    )
    return Sight(
        sighting=sighting,
        pose=refined.pose,
        tags=candidate.tags,
        rms_px=refined.rms_px,
        tracked=tracked,
        is_complete=candidate.is_complete,
        foreign_ids=foreign_ids,
    )


def _late_s(candidate: Candidate, system: SightSystem) -> float:
    """Return how long after the picture's middle row the rows were read that show the tags."""
    places = np.concatenate([system.board.corners_m[tag_id] for tag_id in candidate.tags])
    pixels, _ = system.camera.pixels(places, *candidate.refined.pose)
    height = system.camera.size_px[1]
    row = float(np.clip(pixels[:, 1], 0.0, height - 1.0).mean())
    return (row / (height - 1.0) - 0.5) * system.mounting.readout_s
