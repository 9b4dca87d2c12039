"""Whether a drone that touches the pad stays there: what it slides on, and what the air does to it, in a step's facts.

A drone without thrust stands by the friction of its gear alone. The air over the pad goes on to push it as it did in
flight, where the lean that holds against the air shows how hard that is: at 45 m/s by three quarters of its weight. It
pushes harder on the roof than over it, for a body in a stream drives the air about it faster. Over a car, taken as half
an ellipsoid (Lamb, Hydrodynamics, section 114), the air has 1.19 times the stream's speed where a drone stands, and
1.07 times where it waits. Drag is taken as linear in it: with the rotors off, less of it is left than in flight.
"""

from companion.config.companion import CompanionConfig
from companion.core.data import GRAVITY_M_S2
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.conditions import is_above_commitment, is_low_above_pad
from companion.landing.decisions.contact_trial import is_in_contact
from companion.situation.situation import Situation

FASTER_ON_ROOF = 1.19 / 1.07
_WET_FRICTION = 0.5  # of rubber on painted metal: a drone that slides may have less than its gear holds when dry


def has_touched(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone stands on the pad, or slides to rest on it: to lift off would be the greater danger."""
    a = s.approach
    if a is None or not is_in_contact(s, c):
        return False
    room_m = a.pad_half_width_m - a.distance_m
    friction = min(_WET_FRICTION, c.touchdown.gear_friction)
    return 0.5 * a.speed_m_s**2 < friction * GRAVITY_M_S2 * room_m


def would_blow_off(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the air would push the drone along the pad once its motors are off.

    Higher than where it waits, it may still catch up with the vehicle, and the wind is stronger. Lower than the commit
    height it may touch as it turns back, and what pushes a drone that slides on the pad is not the air alone.
    """
    if not (is_low_above_pad(s, c) and is_above_commitment(s, c)):
        return False
    return _pushed_m_s2(s) > c.touchdown.gear_friction * GRAVITY_M_S2


def _pushed_m_s2(s: Situation) -> float:
    """Return how hard the air would push a drone that stands."""
    return FASTER_ON_ROOF * s.following.pushed_m_s2


def tell_blown_off(s: Situation, c: CompanionConfig) -> Cause:
    """Return that with its numbers: by which share of its weight the air pushes the drone, and what the gear holds."""
    return Cause(Reason.WOULD_BLOW_OFF, (_pushed_m_s2(s) / GRAVITY_M_S2, c.touchdown.gear_friction))
