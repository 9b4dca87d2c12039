"""What nothing that the drone has can verify, as the status tells it; pure.

A vehicle's stamps date its fixes, and only a sighting, which the drone dates itself, shows that they are late. A
sighting in turn is compared with the receivers, and only where these have one frame. What is left is believed.
"""

import math
from enum import Enum

from companion.config.companion import CompanionConfig
from companion.config.integrity import ReceiverFrames
from companion.situation.situation import Situation

_LATE_S = 0.1  # by which a receiver's output follows its measurement: Pixhawk, NMEA and ROS drivers stamp either


class Unverified(Enum):
    """What is believed, with a place for its number."""

    PLACE = "the pad is where sightings alone say: nothing shows a detector that is always off by the same"
    FRAMES = "both receivers are taken to have one frame, for their phases are fixed: nothing sees the pad"
    STAMPS = "the vehicle's stamps: those that are {late_s:g} s late put the pad {off_m:.1f} m off, and nothing sees it"


def unverified(s: Situation, c: CompanionConfig) -> tuple[str, ...]:
    """Return what nobody can know in this step, in words."""
    pad = s.pad
    if pad is None:
        return ()
    if pad.is_coarse or not pad.has_one_frame:
        return (Unverified.PLACE.value,) if pad.frame_offset.is_confirmed else ()
    if pad.frame_offset.is_confirmed:
        return ()
    off_m = _LATE_S * math.hypot(*pad.velocity_enu_m_s[0, :2].tolist())
    stamps = Unverified.STAMPS.value.format(late_s=_LATE_S, off_m=off_m)
    return (stamps, *((Unverified.FRAMES.value,) if c.integrity.receiver_frames is ReceiverFrames.AUTO else ()))
