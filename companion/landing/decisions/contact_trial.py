"""How long the signs of a contact are tried before they are believed, in a step's facts; pure.

An autopilot that hears no setpoint hovers above the last one, and the signs agree as on a pad; the range finder's too
if it hovers low enough. A press shows that only if the autopilot hears it, and follows: ArduCopter, which had begun to
brake, sank no faster for 0.2 s after it was pressed anew. So no trial goes on while it flies to none of the setpoints
of late, nor for a second afterwards. One that does not tell what it flies to is asked for the time as often as
setpoints are sent: while it answers, it hears them too, unless they alone are lost.
"""

from companion.config.companion import CompanionConfig
from companion.landing.decisions.contact import Verdict, trial_press_m_s2, trial_s, verdict
from companion.landing.decisions.contact_signs import signs_of
from companion.situation.situation import Situation
from link.mavlink.answers import ANSWER_GAP_S

_FOLLOWS_AGAIN_S = 1.0  # after it has heard nothing for a moment


def trial_press(s: Situation, c: CompanionConfig) -> float:
    """Return how hard the drone may be pressed down to see whether it stands, m/s^2."""
    return trial_press_m_s2(signs_of(s, c.touchdown), _late_s(s), c.touchdown)


def trial_hold_s(s: Situation, c: CompanionConfig) -> float:
    """Return for how long all signs have to agree."""
    return trial_s(signs_of(s, c.touchdown), trial_press(s, c), _late_s(s), c.touchdown)


def is_in_contact(s: Situation, c: CompanionConfig) -> bool:
    """Return whether every sign of a contact agrees now, however short it has been."""
    return verdict(signs_of(s, c.touchdown), c) is Verdict.CONTACT


def is_contact_tried(s: Situation, c: CompanionConfig) -> bool:
    """Return whether all signs agree, and the autopilot hears how the drone is pressed down."""
    return hears_setpoints(s) and is_in_contact(s, c)


def is_disputed_contact_tried(s: Situation, c: CompanionConfig) -> bool:
    """Return whether all signs agree, or all but the range finder's, and the autopilot hears the press."""
    return hears_setpoints(s) and _may_stand(s, c)


def is_unheard(s: Situation, c: CompanionConfig) -> bool:
    """Return whether nothing has shown for so long that it is heard that the drone hovers, or seems to stand so.

    It would come down too fast to where its setpoint has sunk meanwhile, as soon as it hears of it.
    """
    is_long = s.following.unanswered_s > c.touchdown.range_finder.disputed_hold_s
    return is_long or (not _is_answering(s) and _may_stand(s, c))


def _may_stand(s: Situation, c: CompanionConfig) -> bool:
    return verdict(signs_of(s, c.touchdown), c) in {Verdict.CONTACT, Verdict.DISPUTED}


def hears_setpoints(s: Situation) -> bool:
    """Return whether the autopilot hears setpoints, and has for so long that it follows them again."""
    answering_s = s.following.answering_s
    return _is_answering(s) and (answering_s is None or answering_s >= _FOLLOWS_AGAIN_S)


def _is_answering(s: Situation) -> bool:
    """Return whether they are heard; a drone that sinks to a contact takes longer to seem to stand than the gap."""
    return s.following.unanswered_s <= ANSWER_GAP_S + 2.0 * s.following.late_s


def _late_s(s: Situation) -> float:
    return s.following.late_s + (0.0 if s.drone is None else max(s.drone.age_s, 0.0))
