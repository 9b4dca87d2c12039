"""The conditions of a contact with the pad: touched, stopped by it, missed, left again; pure."""

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.landing.condition import Condition
from companion.landing.contact import Verdict, does_not_fall, is_stopped_by_pad, signs_of, signs_text, verdict
from companion.situation.phases import Phase
from companion.situation.situation import Situation

_DESCENT = frozenset({Phase.DESCEND})
_STANDING = frozenset({Phase.TOUCHDOWN})


def _is_in_contact(s: Situation, c: CompanionConfig) -> bool:
    return verdict(signs_of(s), c) is Verdict.CONTACT


def _is_in_hard_contact(s: Situation, c: CompanionConfig) -> bool:
    """Return whether what was touched stops the drone: a moment later the pad may be gone."""
    jolt_m_s2 = None if s.drone is None else s.drone.jolt_m_s2
    return jolt_m_s2 is not None and jolt_m_s2 > c.touchdown.jolt_m_s2 and is_stopped_by_pad(signs_of(s), c)


def _is_in_disputed_contact(s: Situation, c: CompanionConfig) -> bool:
    return verdict(signs_of(s), c) is not Verdict.AIRBORNE


def _is_held_up(s: Situation, c: CompanionConfig) -> bool:
    return does_not_fall(signs_of(s), c)


def _is_lifted(s: Situation, c: CompanionConfig) -> bool:
    return s.approach is not None and s.approach.height_m > c.touchdown.height_max_m


def is_below_pad(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is lower than anything that presses it onto the pad could bring it."""
    lowest_m = -c.descent.press_depth_m - c.touchdown.height_max_m
    return s.approach is not None and s.approach.height_m < lowest_m


def _is_sunk(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is so low that it stands on the pad, which is soon believed, or has none below it."""
    return s.approach is not None and s.approach.height_m < -c.touchdown.missed_depth_m


TOUCHED = Condition(
    reason=Reason.CONTACT,
    phases=_DESCENT,
    is_true=_is_in_contact,
    hold_s=lambda c: c.touchdown.hold_s,
    cause=lambda s, _: Cause(Reason.CONTACT, (signs_text(signs_of(s)),)),
)
"""Every sign of a contact agrees."""

TOUCHED_BY_DISPUTE = Condition(
    reason=Reason.DISPUTED_CONTACT,
    phases=_DESCENT,
    is_true=_is_in_disputed_contact,
    hold_s=lambda c: c.touchdown.disputed_hold_s,
    cause=lambda s, _: Cause(Reason.DISPUTED_CONTACT, (signs_text(signs_of(s)),)),
)
"""All but the range finder's."""

STOPPED_BY_PAD = Condition(
    reason=Reason.HARD_CONTACT,
    phases=_DESCENT,
    is_true=_is_in_hard_contact,
    cause=lambda s, _: Cause(Reason.HARD_CONTACT, (signs_text(signs_of(s)),)),
)
"""What stops the drone ends its commitment to land as well: this is asked before the conditions that abort."""

MISSED = (
    Condition(reason=Reason.BELOW_PAD, phases=_DESCENT, is_true=is_below_pad),
    Condition(
        reason=Reason.NOTHING_TOUCHED, phases=_DESCENT, is_true=_is_sunk, hold_s=lambda c: c.touchdown.missed_hold_s
    ),
)
"""What ends a commitment to land as well: the pad is not where it is said to be."""

HELD_UP = Condition(
    reason=Reason.HELD_UP, phases=_STANDING, is_true=_is_held_up, hold_s=lambda c: c.touchdown.stopped_hold_s
)
"""Completes the evidence of a hard contact."""

LIFTED = Condition(
    reason=Reason.ABOVE_AFTER_CONTACT, phases=_STANDING, is_true=_is_lifted, hold_s=lambda c: c.touchdown.lost_hold_s
)
"""For so long no motors were switched off, and so high they are not by force."""
