"""How long the signs of a contact are tried before they are believed, in a step's facts; pure.

An autopilot that hears no setpoint hovers above the last one, and all signs but the range finder's agree as on a pad. A
press shows that only if the autopilot hears it. That it does is known once it has answered a question that was asked
while they agreed. Where the range finder agrees, or there is none, no answer is asked for: over links that lose a fifth
of all frames it would come so late that drones would leave the pad that they stand on.
"""

from companion.config.companion import CompanionConfig
from companion.landing.decisions.contact import Verdict, trial_press_m_s2, trial_s, verdict
from companion.landing.decisions.contact_signs import signs_of
from companion.situation.situation import Situation


def trial_press(s: Situation, c: CompanionConfig) -> float:
    """Return how hard the drone may be pressed down to see whether it stands, m/s^2."""
    return trial_press_m_s2(signs_of(s, c.touchdown), _late_s(s), c.touchdown)


def trial_hold_s(s: Situation, c: CompanionConfig) -> float:
    """Return for how long all signs have to agree."""
    return trial_s(signs_of(s, c.touchdown), trial_press(s, c), _late_s(s), c.touchdown)


def disputed_hold_s(s: Situation, c: CompanionConfig) -> float:
    """Return for how long all signs but the range finder's have to agree."""
    return max(c.touchdown.range_finder.disputed_hold_s, s.following.unanswered_s)


def is_in_disputed_contact(s: Situation, c: CompanionConfig) -> bool:
    """Return whether all signs agree, or all but the range finder's."""
    return verdict(signs_of(s, c.touchdown), c) in {Verdict.CONTACT, Verdict.DISPUTED}


def is_trial_unheard(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone may hover: its autopilot has answered nothing for longer than a trial lasts."""
    is_disputed = verdict(signs_of(s, c.touchdown), c) is Verdict.DISPUTED
    return is_disputed and s.following.unanswered_s > c.touchdown.range_finder.disputed_hold_s


def _late_s(s: Situation) -> float:
    return s.following.late_s + (0.0 if s.drone is None else max(s.drone.age_s, 0.0))
