"""What makes an approach unsafe: conditions of a step's facts, each with the time that it must hold; pure."""

import math

from companion.config.companion import CompanionConfig
from companion.config.planning import LandingStyle
from companion.core.reasons import Cause, Reason
from companion.integrity.contradictions import contradicts_itself, tell_rejected
from companion.integrity.frames import tell_uncertain, tell_unseen
from companion.integrity.heights import is_seen_too_near
from companion.integrity.sightings import are_sightings_impossible, do_sightings_disagree, is_seen_elsewhere
from companion.integrity.stamps import have_stamps_stepped, is_stamped_ahead
from companion.integrity.vehicle_data import contradicted_heading
from companion.landing.decisions.conditions import (
    AUTOPILOT_SILENT,
    MISSED,
    VEHICLE_SILENT,
    Condition,
    has_lost_heading,
    is_fix_old,
    is_heading_to_be_shown,
    is_pad_doubted,
    is_sunk,
    is_vehicle_taken,
    tell_taken,
    turns_on_spot,
)
from companion.landing.decisions.contact_trial import hears_setpoints
from companion.landing.decisions.standing import has_touched, tell_blown_off, would_blow_off
from companion.landing.steering.losing import LOST_FOR_S
from companion.situation.phases import LANDING_PHASES, NEAR_PHASES, Phase
from companion.situation.situation import Approach, Situation, driving_hold_s
from companion.vehicle.pad_reach import cone_radius_m, is_unseen, is_vague

_DESCENT = frozenset({Phase.DESCEND})
_MIXED_HOLD_S = 1.5  # three counts: a step of the drone's own frame has sightings of half a second rejected
_MOSTLY = 0.5  # of the ways in which a descent may go on


def is_uncertain(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the pad is not known well enough to come near it."""
    return s.pad is not None and is_vague(s.pad, c)


def must_be_seen(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the pad has to be seen (again) before it is landed on."""
    return s.pad is not None and is_unseen(s.pad, c)


def _looks_in_vain(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone has to see the pad, and is where a camera would that sees 45 degrees to each side."""
    if c.silent_vehicle is not None and is_fix_old(s, c):
        return True  # soon nobody knows where it is
    if s.approach is None or c.guidance.style is LandingStyle.DIRECT:
        return False
    return must_be_seen(s, c) and s.approach.distance_m < c.chase.height_m


def is_token_lost(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the vehicle's program has ended, or its network, and no fix is fresh."""
    age_s = s.vehicle.fix_age_s
    return s.vehicle.is_alive is False and (age_s is None or age_s > c.abort.alive_lost_fix_age_max_s)


def is_pad_unplaced(s: Situation, _: CompanionConfig) -> bool:
    """Return whether nobody knows where on the vehicle the pad is: no heading is known, or no description."""
    return s.pad is not None and s.pad.unplaced is not None


def _is_place_lost(s: Situation, c: CompanionConfig) -> bool:
    return is_pad_unplaced(s, c) and not has_lost_heading(s, c)


def _tell_place_lost(s: Situation, c: CompanionConfig) -> Cause:
    is_vague = is_heading_to_be_shown(s, c) and not turns_on_spot(s)
    return Cause(Reason.HEADING_LOST) if is_vague else why_unplaced(s) or Cause(Reason.HEADING_UNKNOWN)


def why_unplaced(s: Situation) -> Cause | None:
    """Return why nobody knows it, None when the place is known or no vehicle is."""
    return None if s.pad is None else s.pad.unplaced


def is_not_followed(s: Situation, _: CompanionConfig) -> bool:
    """Return whether the drone is farther from its setpoint than gusts and the link bring it, or loses it for long."""
    return s.following.error_m > s.following.error_max_m or s.following.lost_for_s > LOST_FOR_S


def _is_beside_cone(a: Approach, c: CompanionConfig) -> bool:
    return a.distance_m > cone_radius_m(a.height_m, a.pad_half_width_m, c)


def _is_outside_cone(s: Situation, c: CompanionConfig) -> bool:
    a = s.approach
    return a is not None and a.height_m < c.abort.near_height_m and _is_beside_cone(a, c) and not has_touched(s, c)


def strays(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone leaves the cone above the pad, or moves against the pad too fast to touch it."""
    a = s.approach
    return a is not None and (_is_beside_cone(a, c) or a.speed_m_s > c.abort.near_speed_max_m_s)


def _may_stand(a: Approach, c: CompanionConfig) -> bool:
    """Return whether a drone is lower than its height errs and does not sink, with a contact or without."""
    return a.height_m < c.abort.may_stand_below_m and -a.climb_m_s < c.touchdown.blocked_speed_m_s


def _is_contact_risky(s: Situation, c: CompanionConfig) -> bool:
    """Return whether a descent that is committed had better turn back; one that is not waits.

    It turns back, too, where it most likely would a moment later, nearer to a pad that is leaving it. One that may be
    too low for that tries: a pad that it touches as it does, it would touch anyway, sooner and harder. One that has
    sunk below the pad has no contact before it.
    """
    if s.contact is None or s.approach is None or s.approach.height_m > c.descent.commit_height_m or is_sunk(s, c):
        return False
    is_risky = s.contact.unsafe > c.descent.risk.turns_back_min or s.contact.broken_off > _MOSTLY
    return is_risky and not _may_stand(s.approach, c) and not has_touched(s, c)


def _tell_risk(s: Situation, _: CompanionConfig) -> Cause:
    return Cause(Reason.CONTACT_RISKY, (0.0 if s.contact is None else s.contact.s1,))


def _is_too_fast_near_pad(s: Situation, c: CompanionConfig) -> bool:
    a = s.approach
    if a is None or a.height_m >= c.abort.near_height_m or has_touched(s, c):
        return False
    return a.speed_m_s > c.abort.near_speed_max_m_s


def is_out_of_range(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the drone is farther from the waiting point than it may go."""
    if s.drone is None or s.waiting_point_enu_m is None:
        return False
    return math.hypot(*(s.drone.position_enu_m - s.waiting_point_enu_m)[:2].tolist()) > c.limits.range_max_m


def outruns(s: Situation, c: CompanionConfig) -> bool:
    """Return whether the vehicle is faster than the drone may fly, since a limit was lowered or it drives faster."""
    if s.limits is None or s.pad is None or is_fix_old(s, c):
        return False
    return s.pad.ground_speed_m_s > s.limits.speed_max_m_s


def _tell_not_followed(s: Situation, _: CompanionConfig) -> Cause:
    """Return why the drone is not where it was asked to be: it may not have heard of it."""
    return Cause(Reason.SETPOINT_NOT_FOLLOWED if hears_setpoints(s) else Reason.SETPOINTS_UNHEARD)


CONTACT_RISKY = Condition(reason=Reason.CONTACT_RISKY, phases=_DESCENT, is_true=_is_contact_risky, cause=_tell_risk)
"""Ends a commitment to land as well, as long as the drone does not stand."""

ABORTS = (
    VEHICLE_SILENT,
    # One that was out of reach when both began: two networks that meet, or a router that is back.
    Condition(reason=Reason.VEHICLE_TAKEN, phases=LANDING_PHASES, is_true=is_vehicle_taken, cause=tell_taken),
    Condition(
        reason=Reason.VEHICLE_UNCERTAIN,
        phases=NEAR_PHASES,
        is_true=is_uncertain,
        hold_s=lambda _, c: c.abort.cone_hold_s,
        cause=tell_uncertain,
    ),
    Condition(
        reason=Reason.OFFSET_UNKNOWN,
        phases=frozenset({Phase.CHASE}),
        is_true=_looks_in_vain,
        hold_s=lambda _, c: c.chase.unseen_hold_s,
        cause=tell_unseen,
    ),
    Condition(reason=Reason.VEHICLE_LINK_LOST, phases=LANDING_PHASES, is_true=is_token_lost),
    Condition(reason=Reason.PAD_CHANGED, phases=LANDING_PHASES, is_true=is_pad_doubted),
    Condition(
        reason=Reason.VEHICLE_CLOCK_AHEAD,
        phases=LANDING_PHASES,
        is_true=is_stamped_ahead,
        hold_s=lambda _, c: c.integrity.fix_ahead_hold_s,
    ),
    Condition(reason=Reason.STAMPS_STEPPED, phases=LANDING_PHASES, is_true=have_stamps_stepped),
    *AUTOPILOT_SILENT,
    Condition(
        reason=Reason.HEADING_UNKNOWN,
        phases=_DESCENT,
        is_true=_is_place_lost,
        cause=_tell_place_lost,
    ),
    Condition(
        reason=Reason.SETPOINT_NOT_FOLLOWED,
        phases=LANDING_PHASES,
        is_true=is_not_followed,
        hold_s=lambda _, c: c.abort.tracking_hold_s,
        cause=_tell_not_followed,
    ),
    Condition(
        reason=Reason.OUTSIDE_CONE, phases=_DESCENT, is_true=_is_outside_cone, hold_s=lambda _, c: c.abort.cone_hold_s
    ),
    Condition(
        reason=Reason.TOO_FAST_NEAR_PAD,
        phases=_DESCENT,
        is_true=_is_too_fast_near_pad,
        hold_s=lambda _, c: c.abort.near_speed_hold_s,
    ),
    Condition(
        reason=Reason.SEEN_TOO_NEAR,
        phases=LANDING_PHASES,
        is_true=is_seen_too_near,
        hold_s=lambda _, c: c.touchdown.range_finder.off_hold_s,
    ),
    Condition(
        reason=Reason.VEHICLE_CONTRADICTS_ITSELF,
        phases=LANDING_PHASES,
        is_true=contradicts_itself,
        cause=tell_rejected(Reason.VEHICLE_CONTRADICTS_ITSELF),
    ),
    Condition(
        reason=Reason.SEEN_ELSEWHERE,
        phases=LANDING_PHASES,
        is_true=is_seen_elsewhere,
        hold_s=lambda _, c: c.abort.cone_hold_s,
        cause=lambda s, _: contradicted_heading(s.pad) or Cause(Reason.SEEN_ELSEWHERE),
    ),
    Condition(
        reason=Reason.SIGHTINGS_DISAGREE,
        phases=LANDING_PHASES,
        is_true=do_sightings_disagree,
        hold_s=lambda s, _: 0.0 if s.vehicle.has_pad_stepped else _MIXED_HOLD_S,
        cause=lambda s, _: contradicted_heading(s.pad) or Cause(Reason.SIGHTINGS_DISAGREE),
    ),
    Condition(
        reason=Reason.SIGHTINGS_IMPOSSIBLE,
        phases=LANDING_PHASES,
        is_true=are_sightings_impossible,
        hold_s=lambda _, c: c.integrity.acceleration_hold_s,
    ),
    Condition(
        reason=Reason.VEHICLE_OUTRUNS,
        phases=LANDING_PHASES,
        is_true=outruns,
        hold_s=driving_hold_s,
    ),
    Condition(reason=Reason.WOULD_BLOW_OFF, phases=_DESCENT, is_true=would_blow_off, cause=tell_blown_off),
    *MISSED,
    CONTACT_RISKY,
    Condition(reason=Reason.TOO_FAR_FROM_START, phases=LANDING_PHASES, is_true=is_out_of_range),
)
"""What makes an approach unsafe, the first that holds first."""
