"""The tests of a contact with the pad: touched, stopped by it, missed, left again; pure."""

from companion.config.companion import CompanionConfig
from companion.landing.condition import Test
from companion.landing.contact import Verdict, does_not_fall, is_stopped_by_pad, signs_of, verdict
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation

CONTACT = "contact"
DISPUTED_CONTACT = "contact against the range finder"
HARD_CONTACT = "hard contact"


def _in_contact(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return verdict(signs_of(s), c) is Verdict.CONTACT


def _in_hard_contact(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether what was touched stops the drone: a moment later the pad may be gone."""
    jolt_m_s2 = None if s.drone is None else s.drone.jolt_m_s2
    return jolt_m_s2 is not None and jolt_m_s2 > c.touchdown.jolt_m_s2 and is_stopped_by_pad(signs_of(s), c)


def _does_not_fall(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return does_not_fall(signs_of(s), c)


def _is_lifted(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.height_m > c.touchdown.height_max_m


def _in_disputed_contact(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return verdict(signs_of(s), c) is not Verdict.AIRBORNE


def missed_pad(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the drone is lower than anything that presses it onto the pad could bring it."""
    return a is not None and a.height_m < -c.descent.press_depth_m - c.touchdown.height_max_m


def _is_sunk(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the drone is so low that it stands on the pad, which is soon believed, or has none below it."""
    return a is not None and a.height_m < -c.touchdown.missed_depth_m


TOUCHED = Test(CONTACT, frozenset({Phase.DESCEND}), _in_contact, lambda c: c.touchdown.hold_s)
"""Every sign of a contact agrees."""

TOUCHED_BY_DISPUTE = Test(
    DISPUTED_CONTACT, frozenset({Phase.DESCEND}), _in_disputed_contact, lambda c: c.touchdown.disputed_hold_s
)
"""All but the range finder's."""

STOPPED_BY_PAD = Test(HARD_CONTACT, frozenset({Phase.DESCEND}), _in_hard_contact, lambda _: 0.0)
"""What stops the drone ends its commitment to land as well: this is asked before the tests that abort."""

MISSED = (
    Test("below the pad without contact", frozenset({Phase.DESCEND}), missed_pad, lambda _: 0.0),
    Test("nothing touched", frozenset({Phase.DESCEND}), _is_sunk, lambda c: c.touchdown.missed_hold_s),
)
"""What ends a commitment to land as well: the pad is not where it is said to be."""

HELD_UP = Test("held up", frozenset({Phase.TOUCHDOWN}), _does_not_fall, lambda c: c.touchdown.stopped_hold_s)
"""Completes the evidence of a hard contact."""

LIFTED = Test(
    "above the pad after contact", frozenset({Phase.TOUCHDOWN}), _is_lifted, lambda c: c.touchdown.lost_hold_s
)
"""For so long no motors were switched off, and so high they are not by force."""
