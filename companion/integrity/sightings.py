"""Whether what the drone sees of the pad agrees with both receivers, and with itself; pure.

A sighting places the pad in the drone's frame, a fix in the vehicle's. Where both have one frame, a pad that is seen
farther from its told place than both promise means that one of them is wrong: a detector that sees another pattern, or
whose board or mounting is another than it was told, somebody else who publishes sightings, or a receiver. Where nothing
says that they have one frame, any offset may be true, and the sightings alone place the pad: only sightings that
contradict each other can be told from right ones. A camera that looks at a pad sees it many times a second, so that a
few sightings which nothing follows place nothing. A pad that they have confirmed stays where it is on the vehicle: if
all of them show it elsewhere from some moment on, the detector has taken something else for it. A step of the drone's
own frame would look the same, but the estimate steps with that.
"""

import math

from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.config.integrity import ReceiverFrames
from companion.core.data import FIXED_STD_MAX_M, Quantity
from companion.situation.situation import Situation
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import cone_radius_at_pad_m, unseen_std_max_m
from link.records import replace

_STDS = 3.0
_CONFIRMING_MIN = 5  # of a camera that sees the pad at 5 Hz, the slowest that is worth following
_SIGHTED_S = 2.0  # of one sighting a second the newest is counted within 1.5 s
_CONFIRMING_S = 1.0  # over which drone and vehicle move against each other, and what is not the pad goes elsewhere


class SightingWatch(Struct, frozen=True, kw_only=True):
    """How the sightings of the pad agree with each other.

    Attributes:
        counted: accepted and rejected ones, when they were last counted.
        moves: of the pad to sightings, when they were last counted.
        has_stepped: in this approach a confirmed pad was seen to step, although the drone's own frame had not.
        are_mixed: of those since the count before so many were rejected that they contradict each other.
        agreeing: accepted ones since the pad's place was not known, or they contradicted each other.
        since_ns: monotonic, when the first of these was counted; None without one.
        is_confirmed: they were enough, for long enough, since the place was not known; or a launch has told it.
        was_confirmed: sightings were so once; what looks then is known for a detector, and only has to look again.
        seen_ns: monotonic, when accepted ones were counted last; None before the first.
    """

    counted: tuple[int, int] = (0, 0)
    moves: int = 0
    has_stepped: bool = False
    are_mixed: bool = False
    agreeing: int = 0
    since_ns: int | None = None
    is_confirmed: bool = False
    was_confirmed: bool = False
    seen_ns: int | None = None


def update_sightings(
    before: SightingWatch, health: BufferHealth, monotonic_ns: int, config: CompanionConfig
) -> SightingWatch:
    """Return the watch with what the estimator has counted by now; one that was restarted is counted again."""
    counted = health.counts(Quantity.PAD)
    accepted, rejected = (now - then for now, then in zip(counted, before.counted, strict=True))
    if accepted < 0 or rejected < 0:
        return SightingWatch(counted=counted, moves=health.moves_to_sightings)
    is_step = before.is_confirmed and health.moves_to_sightings > before.moves
    before = replace(
        before,
        moves=health.moves_to_sightings,
        has_stepped=before.has_stepped or is_step,
        seen_ns=monotonic_ns if accepted else before.seen_ns,
    )
    if rejected > config.integrity.rejected_share_max * (accepted + rejected):
        return replace(before, counted=counted, are_mixed=True, agreeing=0, since_ns=None)
    if accepted == 0:
        return replace(before, counted=counted, are_mixed=False)
    since_ns = monotonic_ns if before.since_ns is None else before.since_ns
    agreeing = before.agreeing + accepted
    is_long = before.was_confirmed or (monotonic_ns - since_ns) * 1e-9 >= _CONFIRMING_S
    are_enough = agreeing >= _CONFIRMING_MIN and is_long
    return replace(
        before,
        counted=counted,
        are_mixed=False,
        agreeing=agreeing,
        since_ns=since_ns,
        is_confirmed=before.is_confirmed or are_enough,
        was_confirmed=before.was_confirmed or are_enough,
    )


def forget_agreement(watch: SightingWatch) -> SightingWatch:
    """Return the watch of a pad whose place is not known any more, so that sightings have to confirm it again."""
    if not (watch.agreeing or watch.is_confirmed):
        return watch
    return replace(watch, agreeing=0, since_ns=None, is_confirmed=False)


def forget_step(watch: SightingWatch) -> SightingWatch:
    """Return the watch of a drone that does not approach: a pad that has stepped is to be confirmed where it is now."""
    return (
        replace(SightingWatch(), counted=watch.counted, moves=watch.moves, seen_ns=watch.seen_ns)
        if watch.has_stepped
        else watch
    )


def is_pad_sighted(watch: SightingWatch, monotonic_ns: int) -> bool:
    """Return whether some sightings have been accepted within the last seconds, however few and vague."""
    return watch.seen_ns is not None and (monotonic_ns - watch.seen_ns) * 1e-9 <= _SIGHTED_S


def has_nothing_but_unplaced_sightings(s: Situation, c: CompanionConfig) -> bool:
    """Return whether a vehicle that tells nothing will not be found, because all sightings are stamped wrong."""
    return c.silent_vehicle is not None and s.vehicle.has_unplaced_sightings


def do_sightings_disagree(s: Situation, _: CompanionConfig) -> bool:
    """Return whether the last sightings contradict each other, or those that confirmed the pad's place."""
    return s.vehicle.are_sightings_mixed or s.vehicle.has_pad_stepped


def are_sightings_impossible(s: Situation, c: CompanionConfig) -> bool:
    """Return whether a pad that only sightings place is seen to change its velocity as no vehicle can.

    What is estimated before the pad has been seen is nothing that sightings say: until then nothing tells how far the
    drone's frame is from a receiver's.
    """
    if s.pad is None or not s.pad.is_coarse:
        return False
    if s.pad.frame_offset.std_m > unseen_std_max_m(s.pad.half_width_m, c):
        return False
    return math.hypot(*s.pad.acceleration_enu_m_s2[0, :2].tolist()) > c.integrity.acceleration_max_m_s2


def is_seen_elsewhere(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the pad is seen where neither the receivers nor what they promise allow it to be.

    A drone whose own place has stepped since its origin was set or moved may have left the frame that its receiver had,
    or come back to it.
    """
    pad = s.pad
    off_m = None if pad is None else pad.frame_offset.distance_m
    if pad is None or off_m is None or not pad.has_one_frame:
        return False
    east_m, north_m, _ = s.autopilot.frame_moves.since_origin_enu_m
    return off_m > _offset_max_m(pad, s.vehicle.fix_std_m, c) + math.hypot(east_m, north_m)


def _offset_max_m(pad: PadPath, fix_std_m: float | None, c: CompanionConfig) -> float:
    """Return by how much what is seen may be off what is told.

    A smaller offset than the descent's cone leads onto the pad's middle by either. Frames that are only taken for one
    may be two base stations', which place themselves to a metre or so; up to half of the pad's width the drone
    comes down on it all the same. The first sightings, from far, are off by decimetres themselves.
    """
    harmless_m = (
        cone_radius_at_pad_m(pad.half_width_m, c)
        if c.integrity.receiver_frames is ReceiverFrames.ONE
        else pad.half_width_m
    )
    receiver_m = max(fix_std_m or 0.0, FIXED_STD_MAX_M)
    unsure_m = _STDS * pad.frame_offset.std_m
    return max(harmless_m + unsure_m, _STDS * math.hypot(pad.frame_offset.std_m, receiver_m, receiver_m))
