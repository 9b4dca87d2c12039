"""How low a drone that does not land yet may come to what its range finder sees; pure numerics in W.

The pad's height is an estimate, and one that has been led astray, or of a pad that has not been seen for seconds, may
put the pad metres below the road. What the range finder sees is the road or the roof, and neither is to be flown into.
"""

import numpy as np

from companion.config.companion import CompanionConfig
from companion.config.planning import LandingStyle
from companion.landing.steering.following_height import chase_floor_m, waiting_height_m
from companion.landing.steering.targets import Aim
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from link.records import replace

_PHASES = frozenset({Phase.CHASE, Phase.ABORT})


def keep_above_seen(aim: Aim, phase: Phase, reference: ReferenceState, s: Situation, config: CompanionConfig) -> Aim:
    """Return the aim that keeps the feet as far above what is seen as above a pad that is not landed on yet.

    Something that hangs before the range finder makes the drone climb to where it would wait at most; higher up it
    only keeps it from sinking.

    Args:
        aim: after the pad.
        phase: of the landing.
        reference: the virtual model now.
        s: the facts.
        config: all numbers.
    """
    seen_m = s.below.range_height_m
    if phase not in _PHASES or config.guidance.style is LandingStyle.DIRECT or s.drone is None or seen_m is None:
        return aim
    clear_enu_m = float(s.drone.position_enu_m[2]) - seen_m + chase_floor_m(config)
    floor_enu_m = min(clear_enu_m, max(float(reference.position_enu_m[2]), waiting_height_m(s, config)))
    position, velocity, acceleration = (
        aim.target.position_enu_m,
        aim.target.velocity_enu_m_s,
        aim.target.acceleration_enu_m_s2,
    )
    is_lower = position[:, 2] < floor_enu_m
    if not is_lower.any():
        return aim
    position, velocity, acceleration = position.copy(), velocity.copy(), acceleration.copy()
    position[is_lower, 2] = floor_enu_m
    velocity[is_lower, 2] = acceleration[is_lower, 2] = 0.0
    target = replace(aim.target, position_enu_m=position, velocity_enu_m_s=velocity, acceleration_enu_m_s2=acceleration)
    return replace(aim, target=target, floor_enu_m=np.maximum(aim.floor_enu_m, floor_enu_m))
