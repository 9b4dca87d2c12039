"""The conditions that phases wait for or break off at: each true or false of a step's facts, with its hold time.

A condition with a hold time must have been true without a break for that long.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache

from companion.config.companion import CompanionConfig
from companion.config.landing import LandingStyle
from companion.integrity.contradictions import CONTRADICTING, contradicts_itself
from companion.integrity.ground import SEEN_TOO_NEAR, is_seen_too_near
from companion.landing.condition import Held, Test
from companion.landing.contact_tests import HELD_UP, LIFTED, MISSED, STOPPED_BY_PAD, TOUCHED, TOUCHED_BY_DISPUTE
from companion.landing.silence import HEARD, attitude_unknown, fix_too_old, own_unknown
from companion.landing.targets import changes_speed, chase_floor_m, is_unseen, is_vague
from companion.situation.phases import LANDING_PHASES, NEAR_PHASES, Event, Phase
from companion.situation.situation import Approach, Situation, approach, stands
from companion.vehicle.pad import HEADING_UNKNOWN
from companion.vehicle.pad_reach import cone_radius_m, over_pad_radius_m


def is_uncertain(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the pad is not known well enough to come near it."""
    return s.pad is not None and is_vague(s.pad, c)


def must_be_seen(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the pad has to be seen (again) before it is landed on."""
    return s.pad is not None and is_unseen(s.pad, c)


def _must_be_seen_above(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return must_be_seen(s, a, c) and a is not None and a.height_m > c.descent.commit_height_m


def _token_lost(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    silent = s.fix_age_s is None or s.fix_age_s > c.abort.alive_lost_fix_age_max_s
    return s.vehicle_alive is False and silent


def is_stamped_ahead(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the newest fix came before it was taken: the vehicle's clock, or ours, is wrong."""
    return s.fix_age_on_arrival_s is not None and s.fix_age_on_arrival_s < -c.abort.fix_ahead_max_s


def not_placed(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    """Return whether nobody knows where on the vehicle the pad is: no heading is known, or no description."""
    return s.pad is not None and s.pad.unplaced is not None


def _not_followed(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.tracking_error_m > c.abort.tracking_error_max_m


def _beside_cone(a: Approach, c: CompanionConfig) -> bool:
    return a.distance_m > cone_radius_m(a.height_m, a.pad_half_width_m, c)


def must_wait(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    """Return whether a descent is to stay above the pad for now: what a change of the vehicle's speed does, passes."""
    return _strays(s, a, c) or (s.pad is not None and changes_speed(s.pad, c.descent))


def _outside_cone(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.height_m < c.abort.near_height_m and _beside_cone(a, c)


def _strays(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and (_beside_cone(a, c) or a.speed_m_s > c.abort.near_speed_max_m_s)


def _strays_above(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.height_m > c.descent.commit_height_m and _strays(s, a, c)


def is_over_pad(a: Approach, c: CompanionConfig) -> bool:
    """Return whether the drone is so near the pad's centre that what it touches is the pad."""
    return a.distance_m < over_pad_radius_m(a.pad_half_width_m, c)


def _too_fast_near_pad(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.height_m < c.abort.near_height_m and a.speed_m_s > c.abort.near_speed_max_m_s


def is_out_of_range(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the drone is farther from the waiting point than it may go."""
    if s.drone is None or s.waiting_point_enu_m is None:
        return False
    return math.hypot(*(s.drone.position_enu_m - s.waiting_point_enu_m)[:2].tolist()) > c.limits.range_max_m


def _outruns(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the vehicle is faster than the drone may fly, since a limit was lowered or it drives faster."""
    if s.limits is None or s.pad is None or fix_too_old(s, None, c):
        return False
    return math.hypot(*s.pad.velocity_enu_m_s[0, :2].tolist()) > s.limits.speed_max_m_s


ABORT_TESTS = (
    Test("vehicle data too old", LANDING_PHASES, fix_too_old, lambda _: 0.0),
    Test("vehicle position too uncertain", NEAR_PHASES, is_uncertain, lambda c: c.abort.cone_hold_s),
    Test("vehicle's link lost", LANDING_PHASES, _token_lost, lambda _: 0.0),
    Test("vehicle's clock is ahead", LANDING_PHASES, is_stamped_ahead, lambda c: c.abort.fix_ahead_hold_s),
    Test("own position too old", LANDING_PHASES, own_unknown, lambda _: 0.0),
    Test("own attitude too old", LANDING_PHASES, attitude_unknown, lambda _: 0.0),
    Test(HEADING_UNKNOWN, frozenset({Phase.DESCEND}), not_placed, lambda _: 0.0),
    Test("setpoint not followed", LANDING_PHASES, _not_followed, lambda c: c.abort.tracking_hold_s),
    Test("outside the descent cone", frozenset({Phase.DESCEND}), _outside_cone, lambda c: c.abort.cone_hold_s),
    Test(
        "too fast against the pad", frozenset({Phase.DESCEND}), _too_fast_near_pad, lambda c: c.abort.near_speed_hold_s
    ),
    Test(SEEN_TOO_NEAR, LANDING_PHASES, is_seen_too_near, lambda c: c.touchdown.range_off_hold_s),
    Test(CONTRADICTING, LANDING_PHASES, contradicts_itself, lambda _: 0.0),
    Test("vehicle faster than the limit", LANDING_PHASES, _outruns, lambda c: c.chase.driving_hold_s),
    Test("too far from the start", LANDING_PHASES, is_out_of_range, lambda _: 0.0),
    *MISSED,
)


def _aligned(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    if a is None or not_placed(s, a, c) or must_be_seen(s, a, c):
        return False
    return a.distance_m < c.descent.aligned_distance_m and a.speed_m_s < c.descent.aligned_speed_m_s


def _is_far_off(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.distance_m > 2.0 * c.descent.align_distance_m and c.landing is not LandingStyle.DIRECT


def is_too_low(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone hovers so low that a chase would run into the vehicle's side."""
    relative = approach(s)
    return relative is None or relative.height_m < chase_floor_m(config)


def _stands_nearby(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    if s.drone is None or s.pad is None or not_placed(s, None, c) or fix_too_old(s, None, c) or is_too_low(s, c):
        return False
    ahead = s.drone.position_enu_m[:2] - s.pad.position_enu_m[0, :2]
    return stands(s, c.chase) and math.hypot(*ahead.tolist()) < c.chase.passing_distance_m


def _drives(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.pad is not None and not stands(s, c.chase)


STRAYS = Test("not over the pad in time", frozenset({Phase.DESCEND}), _strays_above, lambda c: c.descent.stray_hold_s)
"""Costs no approach at first, for nothing was near."""

ALIGNMENT_LOST = Test("alignment lost", frozenset({Phase.ALIGN}), _is_far_off, lambda _: 0.0)
"""Is counted as strays are."""

TO_BE_SEEN = Test("pad to be seen again", frozenset({Phase.DESCEND}), _must_be_seen_above, lambda _: 0.0)
"""Is counted, too; without a hold time, or it slips below."""

NOT_SEEN = Test("pad not seen", frozenset({Phase.ALIGN}), must_be_seen, lambda c: c.descent.unseen_hold_s)
"""Likewise."""

# A vehicle that stands may be about to depart, so it is landed on only after it has stood for a while.
ENTRY_TESTS = (
    (
        Event.VEHICLE_PASSES,
        Test("vehicle stands", frozenset({Phase.WAITING}), _stands_nearby, lambda c: c.chase.parked_wait_s),
    ),
    (Event.ALIGNED, Test("aligned", frozenset({Phase.ALIGN}), _aligned, lambda c: c.descent.aligned_hold_s)),
    (Event.OUT_OF_ALIGNMENT, TO_BE_SEEN),
    (Event.OUT_OF_ALIGNMENT, STRAYS),
    (Event.OUT_OF_ALIGNMENT, ALIGNMENT_LOST),
    (Event.OUT_OF_ALIGNMENT, NOT_SEEN),
    (Event.CONTACT, TOUCHED),
    (Event.CONTACT, STOPPED_BY_PAD),
    (Event.CONTACT, TOUCHED_BY_DISPUTE),
)


MAY_BEGIN_ANEW: Mapping[str, Callable[[CompanionConfig], int]] = {
    STRAYS.reason: lambda c: c.descent.strays_max,
    ALIGNMENT_LOST.reason: lambda c: c.descent.strays_max,
    TO_BE_SEEN.reason: lambda c: c.descent.unseen_max,
    NOT_SEEN.reason: lambda c: c.descent.unseen_max,
}
"""How often in one approach each is aligned or chased again for; then it is unsafe."""

DRIVES = Test("vehicle drives", frozenset({Phase.WAITING}), _drives, lambda c: c.chase.driving_hold_s)
"""Without this no vehicle is taken to pass."""


def update_held(
    held: Held,
    phase: Phase,
    situation: Situation,
    relative: Approach | None,
    config: CompanionConfig,
    *,
    others: tuple[Test, ...] = (),
) -> dict[str, int]:
    """Return since when each test of this phase has been true."""
    return {
        test.reason: held.get(test.reason, situation.t_ns)
        for test in _tests_in(phase, others)
        if test.is_true(situation, relative, config)
    }


@cache
def _tests_in(phase: Phase, others: tuple[Test, ...]) -> tuple[Test, ...]:
    tests = (*others, *ABORT_TESTS, *(test for _, test in ENTRY_TESTS), HEARD, HELD_UP, LIFTED, DRIVES)
    return tuple(test for test in tests if phase in test.phases)
