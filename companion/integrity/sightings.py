"""Whether what the drone sees of the pad agrees with the receivers, and with itself; pure.

A sighting places the pad in the drone's frame, a fix in the vehicle's. Where both have one frame, a pad that is seen
farther from its told place than both promise means that one of them is wrong: a detector that sees another pattern, or
whose board or mounting is another than it was told, somebody else who publishes sightings, or a receiver. Where nothing
says that they have one frame, any offset may be true, and the sightings alone place the pad: only sightings that
contradict each other can be told from right ones.
"""

import math

from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.config.integrity import ReceiverFrames
from companion.integrity.frames import FIXED_STD_MAX_M
from companion.situation.situation import Situation
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.pad import PadPath, cone_radius_at_pad_m

_STDS = 3.0


class SightingWatch(Struct, frozen=True, kw_only=True):
    """How the sightings of the pad agree with each other.

    Attributes:
        counted: accepted and rejected ones, when they were last counted.
        are_mixed: of those since the count before so many were rejected that they contradict each other.
    """

    counted: tuple[int, int] = (0, 0)
    are_mixed: bool = False


def update_sightings(before: SightingWatch, health: BufferHealth, config: CompanionConfig) -> SightingWatch:
    """Return the watch with what the estimator has counted by now; one that was begun anew is counted anew."""
    accepted, rejected = (now - then for now, then in zip(health.sightings, before.counted, strict=True))
    is_anew = accepted < 0 or rejected < 0
    are_mixed = not is_anew and rejected > config.integrity.rejected_share_max * (accepted + rejected)
    return SightingWatch(counted=health.sightings, are_mixed=are_mixed)


def do_sightings_disagree(s: Situation, _: CompanionConfig) -> bool:
    """Return whether the last sightings contradict each other."""
    return s.vehicle.are_sightings_mixed


def is_seen_elsewhere(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the pad is seen where neither the receivers nor what they promise allow it to be.

    A drone whose own place has jumped has left the frame that its receiver had.
    """
    pad = s.pad
    if pad is None or not pad.has_one_frame or pad.frame_offset_m is None or any(s.autopilot.frame_moves.shift_enu_m):
        return False
    return pad.frame_offset_m > _offset_max_m(pad, s.vehicle.fix_std_m, c)


def _offset_max_m(pad: PadPath, fix_std_m: float | None, c: CompanionConfig) -> float:
    """Return by how much what is seen may be off what is told.

    A smaller offset than the descent's cone leads onto the pad's middle by either. Frames that are only taken for one
    may be two base stations', which place themselves to a metre or so; up to half of the pad's width the drone
    comes down on it all the same.
    """
    harmless_m = (
        cone_radius_at_pad_m(pad.half_width_m, c)
        if c.integrity.receiver_frames is ReceiverFrames.ONE
        else pad.half_width_m
    )
    receiver_m = max(fix_std_m or 0.0, FIXED_STD_MAX_M)
    return max(harmless_m, _STDS * math.hypot(pad.frame_offset_std_m, receiver_m, receiver_m))
