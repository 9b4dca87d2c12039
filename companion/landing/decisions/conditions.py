"""Conditions of a step's facts, each with the time that it must hold before it counts: silence and contact; pure."""

from collections.abc import Callable
from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.contact import (
    Verdict,
    does_not_fall,
    is_over_road,
    is_stopped_by_pad,
    verdict,
)
from companion.landing.decisions.contact_signs import signs_of, signs_text
from companion.landing.decisions.contact_trial import (
    is_contact_tried,
    is_disputed_contact_tried,
    is_unheard,
    trial_hold_s,
)
from companion.landing.state.memory import Held
from companion.situation.phases import LANDING_PHASES, Phase
from companion.situation.situation import Situation, vehicle_stands
from companion.vehicle.pad import HEADING_UNKNOWN, TURNS_ON_SPOT


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Condition:
    """What must be true without a break for a while; each is itself only, so that a step need not compare their fields.

    Attributes:
        reason: that it gives, one of its own.
        phases: in which it is asked.
        is_true: of a step's facts.
        hold_s: for how long before it counts.
        cause: what is told of it, where that takes more than the reason.
        is_outage: it passes, and an approach that it breaks off goes on after it.
        anew_max: how often in one approach it leads to aligning or chasing again; then it is unsafe.
        goes_on: whether it goes on, by what has held so far, where it is not true for a moment; None: it never does.
    """

    reason: Reason
    phases: frozenset[Phase]
    is_true: Callable[[Situation, CompanionConfig], bool]
    hold_s: Callable[[Situation, CompanionConfig], float] = lambda _, __: 0.0
    cause: Callable[[Situation, CompanionConfig], Cause] | None = None
    is_outage: bool = False
    anew_max: Callable[[CompanionConfig], int] | None = None
    goes_on: Callable[[Held, Situation, CompanionConfig], bool] | None = None


def holds(condition: Condition, held: Held, s: Situation, config: CompanionConfig) -> bool:
    """Return whether a condition has been true for its hold time."""
    since_ns = held.get(condition.reason)
    return since_ns is not None and (s.monotonic_ns - since_ns) * 1e-9 >= condition.hold_s(s, config)


def cause_of(condition: Condition, s: Situation, config: CompanionConfig) -> Cause:
    """Return what is told of a condition that is true."""
    return Cause(condition.reason) if condition.cause is None else condition.cause(s, config)


def first_cause(conditions: tuple[Condition, ...], held: Held, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return what is told of the first condition that holds, None when none does."""
    return next((cause_of(one, s, config) for one in conditions if holds(one, held, s, config)), None)


def is_fix_old(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the vehicle has been silent for too long, or out of sight if it tells nothing."""
    age_s = s.vehicle.fix_age_s
    return s.pad is None or age_s is None or age_s > c.abort.fix_age_max_s


def is_above_commitment(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is so high above the pad that it may align again."""
    return s.approach is not None and s.approach.height_m > c.descent.commit_height_m


def is_low_above_pad(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is no higher above the pad than where it waits."""
    return s.approach is not None and s.approach.height_m <= c.descent.wait.height_m


def turns_on_spot(s: Situation) -> bool:
    """Return whether the pad goes round an antenna that turns: it is known again once the vehicle has turned."""
    return s.pad is not None and s.pad.unplaced == TURNS_ON_SPOT


def is_heading_to_be_shown(s: Situation, c: CompanionConfig) -> bool:
    """Return whether only a heading is missed that a vehicle shows: a vague one as it drives, or that of a turn."""
    if turns_on_spot(s):
        return True
    if s.pad is None or s.pad.yaw_rad is None or s.pad.unplaced != HEADING_UNKNOWN:
        return False
    return not vehicle_stands(s, c.chase)


def has_lost_heading(s: Situation, c: CompanionConfig) -> bool:
    """Return whether a drone that may align again waits for the heading."""
    return is_above_commitment(s, c) and is_heading_to_be_shown(s, c)


def _is_silent(s: Situation, c: CompanionConfig) -> bool:
    """Return whether a vehicle that tells of itself has fallen silent; any other has to be seen instead."""
    return c.silent_vehicle is None and is_fix_old(s, c)


def is_vehicle_taken(s: Situation, _: CompanionConfig) -> bool:
    """Return whether another drone lands on this vehicle, or stands on it, that was there first."""
    return s.rival is not None and not s.rival.is_this_drone


def tell_taken(s: Situation, _: CompanionConfig) -> Cause:
    """Return which drone that is."""
    return Cause(Reason.VEHICLE_TAKEN, ("nobody" if s.rival is None else s.rival.drone,))


def is_pad_doubted(s: Situation, _: CompanionConfig) -> bool:
    """Return whether the vehicle describes another pad than the one that is flown to: one of them is beside it."""
    return s.vehicle.is_pad_doubted


def is_drone_unknown(s: Situation, _: CompanionConfig) -> bool:
    """Return whether nobody knows where the drone is."""
    return s.drone is None


def is_attitude_unknown(s: Situation, _: CompanionConfig) -> bool:
    """Return whether nobody knows which way the drone looks and leans: sightings of the pad are turned by it."""
    return s.drone is not None and not s.drone.attitude_known


def _is_heard(s: Situation, c: CompanionConfig) -> bool:
    return not any(silence.is_true(s, c) for silence in SILENCES)


SILENCES = (
    Condition(reason=Reason.VEHICLE_DATA_OLD, phases=LANDING_PHASES, is_true=_is_silent, is_outage=True),
    Condition(reason=Reason.OWN_POSITION_OLD, phases=LANDING_PHASES, is_true=is_drone_unknown, is_outage=True),
    Condition(reason=Reason.OWN_ATTITUDE_OLD, phases=LANDING_PHASES, is_true=is_attitude_unknown, is_outage=True),
)
"""Of the vehicle, or of the autopilot."""

VEHICLE_SILENT, *AUTOPILOT_SILENT = SILENCES

HEARD = Condition(
    reason=Reason.HEARD,
    phases=frozenset({Phase.ABORT, Phase.HOLD}),
    is_true=_is_heard,
    hold_s=lambda _, c: c.abort.heard_hold_s,
)
"""The vehicle and the autopilot are, without a break."""


_DESCENT = frozenset({Phase.DESCEND})
_STANDING = frozenset({Phase.TOUCHDOWN})


def _is_in_hard_contact(s: Situation, c: CompanionConfig) -> bool:
    """Return whether what was touched stops the drone: a moment later the pad may be gone."""
    jolt_m_s2 = None if s.drone is None else s.drone.jolt_m_s2
    return (
        jolt_m_s2 is not None and jolt_m_s2 > c.touchdown.jolt_m_s2 and is_stopped_by_pad(signs_of(s, c.touchdown), c)
    )


def _is_road_below(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the range finder sees the road where the pad should be, be the drone at an edge or in the air."""
    signs = signs_of(s, c.touchdown)
    return is_over_road(signs, c) or verdict(signs, c) is Verdict.AT_EDGE


def _is_held_up(s: Situation, c: CompanionConfig) -> bool:
    return does_not_fall(signs_of(s, c.touchdown), c)


def _is_lifted(s: Situation, c: CompanionConfig) -> bool:
    return s.approach is not None and s.approach.height_m > c.touchdown.height_max_m


def is_below_pad(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is lower than anything that presses it onto the pad could bring it."""
    lowest_m = -c.descent.sink.press_depth_m - c.touchdown.height_max_m
    return s.approach is not None and s.approach.height_m < lowest_m


def is_sunk(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is so low that it stands on the pad, which is soon believed, or has none below it."""
    return s.approach is not None and s.approach.height_m < -c.touchdown.lost.missed_depth_m


TOUCHED = Condition(
    reason=Reason.CONTACT,
    phases=_DESCENT,
    is_true=is_contact_tried,
    hold_s=trial_hold_s,
    cause=lambda s, c: Cause(Reason.CONTACT, (signs_text(signs_of(s, c.touchdown)),)),
)
"""Every sign of a contact agrees."""

TOUCHED_BY_DISPUTE = Condition(
    reason=Reason.DISPUTED_CONTACT,
    phases=_DESCENT,
    is_true=is_disputed_contact_tried,
    hold_s=lambda _, c: c.touchdown.range_finder.disputed_hold_s,
    cause=lambda s, c: Cause(Reason.DISPUTED_CONTACT, (signs_text(signs_of(s, c.touchdown)),)),
)
"""All but the range finder's."""

STOPPED_BY_PAD = Condition(
    reason=Reason.HARD_CONTACT,
    phases=_DESCENT,
    is_true=_is_in_hard_contact,
    cause=lambda s, c: Cause(Reason.HARD_CONTACT, (signs_text(signs_of(s, c.touchdown)),)),
)
"""What stops the drone ends its commitment to land as well: this is asked before the conditions that abort."""

MISSED = (
    Condition(reason=Reason.BELOW_PAD, phases=_DESCENT, is_true=is_below_pad),
    Condition(
        reason=Reason.NOTHING_TOUCHED,
        phases=_DESCENT,
        is_true=is_sunk,
        hold_s=lambda _, c: c.touchdown.lost.missed_hold_s,
    ),
    Condition(
        reason=Reason.ROAD_BELOW,
        phases=_DESCENT,
        is_true=_is_road_below,
        hold_s=lambda _, c: c.touchdown.range_finder.off_hold_s,
    ),
    Condition(reason=Reason.SETPOINTS_UNHEARD, phases=_DESCENT, is_true=is_unheard),
)
"""What ends a commitment to land as well: the pad is not where it is said to be, or nothing presses the drone down."""

HELD_UP = Condition(
    reason=Reason.HELD_UP, phases=_STANDING, is_true=_is_held_up, hold_s=lambda _, c: c.touchdown.stopped_hold_s
)
"""Completes the evidence of a hard contact."""

LIFTED = Condition(
    reason=Reason.ABOVE_AFTER_CONTACT, phases=_STANDING, is_true=_is_lifted, hold_s=lambda _, c: c.touchdown.lost.hold_s
)
"""For so long no motors were switched off, and so high they are not by force."""
