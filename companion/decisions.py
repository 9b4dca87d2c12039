"""Which event a step's facts amount to: the entry tests, abort tests and time limits of each phase.

Every test that can flicker has a hold time: it must have been true without a break for that long.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from companion.config import CompanionConfig, LandingStyle
from companion.phases import FLYING_PHASES, LANDING_PHASES, Event, Phase
from companion.situation import Approach, Situation, approach
from companion.targets import chase_floor_m

CONTACT = "contact"

Decision = tuple[Event, str]
Held = Mapping[str, int]
"""Since when (UTC ns) each test has been true, by its name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Where in the landing we are, and for how long."""

    phase: Phase
    since_ns: int
    retries: int
    may_retry: bool  # no operator has broken the landing off
    was_in_control: bool  # the autopilot's mode has been the companion's since the start
    was_armed: bool  # and its motors were armed in that mode


@dataclass(frozen=True, slots=True)
class Test:
    """A condition with the time it must hold before it counts."""

    reason: str
    phases: frozenset[Phase]
    is_true: Callable[[Situation, Approach | None, CompanionConfig], bool]
    hold_s: Callable[[CompanionConfig], float]


def _fix_too_old(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.pad is None or s.fix_age_s is None or s.fix_age_s > c.abort.fix_age_max_s


def _estimate_uncertain(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.pad is not None and float(np.max(s.pad.position_std_m[0, :2])) > c.abort.position_std_max_m


def _token_lost(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    silent = s.fix_age_s is None or s.fix_age_s > c.abort.alive_lost_fix_age_max_s
    return s.vehicle_alive is False and silent


def _own_unknown(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    return s.drone is None


def _not_placed(s: Situation, _: Approach | None, __: CompanionConfig) -> bool:
    return s.pad is not None and not s.pad.placed


def _not_followed(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.tracking_error_m > c.abort.tracking_error_max_m


def cone_radius_m(height_m: float, config: CompanionConfig) -> float:
    """Return how far beside the pad's centre the drone may be at `height_m` above it while it descends."""
    return config.descent.cone_radius_at_pad_m + config.descent.cone_slope * max(height_m, 0.0)


def _outside_cone(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.distance_m > cone_radius_m(a.height_m, c)


def is_over_pad(a: Approach, c: CompanionConfig) -> bool:
    """Return whether the drone is so near the pad's centre that what it touches is the pad."""
    return a.distance_m < 2.0 * c.descent.cone_radius_at_pad_m


def _too_fast_near_pad(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.height_m < c.abort.near_height_m and a.speed_m_s > c.abort.near_speed_max_m_s


def _missed_pad(_: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    return a is not None and a.height_m < -c.descent.press_depth_m - c.touchdown.height_max_m


ABORT_TESTS = (
    Test("vehicle data too old", LANDING_PHASES, _fix_too_old, lambda _: 0.0),
    Test("vehicle position too uncertain", LANDING_PHASES, _estimate_uncertain, lambda c: c.abort.cone_hold_s),
    Test("vehicle's link lost", LANDING_PHASES, _token_lost, lambda _: 0.0),
    Test("own position too old", LANDING_PHASES, _own_unknown, lambda _: 0.0),
    Test("vehicle heading unknown", frozenset({Phase.DESCEND}), _not_placed, lambda _: 0.0),
    Test("setpoint not followed", LANDING_PHASES, _not_followed, lambda c: c.abort.tracking_hold_s),
    Test("outside the descent cone", frozenset({Phase.DESCEND}), _outside_cone, lambda c: c.abort.cone_hold_s),
    Test(
        "too fast against the pad", frozenset({Phase.DESCEND}), _too_fast_near_pad, lambda c: c.abort.near_speed_hold_s
    ),
    Test("below the pad without contact", frozenset({Phase.DESCEND}), _missed_pad, lambda _: 0.0),
)


def _aligned(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    if a is None or _not_placed(s, a, c):
        return False
    return a.distance_m < c.descent.aligned_distance_m and a.speed_m_s < c.descent.aligned_speed_m_s


def _is_low(s: Situation, config: CompanionConfig) -> bool:
    """Whether the drone hovers too low to fly over the pad, so that a chase would run into the vehicle's side."""
    relative = approach(s)
    return relative is None or relative.height_m < chase_floor_m(config)


def _stands_nearby(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    if s.drone is None or s.pad is None or not s.pad.placed or _fix_too_old(s, None, c) or _is_low(s, c):
        return False
    ahead = s.drone.position_enu_m[:2] - s.pad.position_enu_m[0, :2]
    speed_m_s = float(np.hypot(*s.pad.velocity_enu_m_s[0, :2]))
    return speed_m_s < c.chase.parked_speed_m_s and float(np.hypot(*ahead)) < c.chase.passing_distance_m


def _drives(s: Situation, _: Approach | None, c: CompanionConfig) -> bool:
    return s.pad is not None and float(np.hypot(*s.pad.velocity_enu_m_s[0, :2])) >= c.chase.parked_speed_m_s


def in_contact(s: Situation, a: Approach | None, c: CompanionConfig) -> bool:
    """Return whether the signs of a contact agree.

    The setpoint has sunk below the drone, yet the drone does not sink towards it, and its estimated height is
    that of the pad; or the autopilot itself says that it has landed there.
    """
    if a is None or s.reference is None or s.drone is None or a.height_m > c.touchdown.height_max_m:
        return False
    if not is_over_pad(a, c):
        return False
    sunk_m = float(s.drone.position_enu_m[2] - s.reference.position_enu_m[2])
    blocked = sunk_m > c.touchdown.blocked_depth_m and abs(a.climb_m_s) < c.touchdown.blocked_speed_m_s
    return blocked or s.autopilot.landed is True


# A vehicle that stands may be about to depart, so it is landed on only after it has stood for a while.
ENTRY_TESTS = (
    (
        Event.VEHICLE_PASSES,
        Test("vehicle stands", frozenset({Phase.WAITING}), _stands_nearby, lambda c: c.chase.parked_wait_s),
    ),
    (Event.ALIGNED, Test("aligned", frozenset({Phase.ALIGN}), _aligned, lambda c: c.descent.aligned_hold_s)),
    (Event.CONTACT, Test(CONTACT, frozenset({Phase.DESCEND}), in_contact, lambda c: c.touchdown.hold_s)),
)


DRIVES = Test("vehicle drives", frozenset({Phase.WAITING}), _drives, lambda c: c.chase.driving_hold_s)
"""Without this no vehicle is taken to pass."""


def update_held(
    held: Held, progress: Progress, situation: Situation, relative: Approach | None, config: CompanionConfig
) -> dict[str, int]:
    """Return since when each test of this phase has been true."""
    tests = (*ABORT_TESTS, *(test for _, test in ENTRY_TESTS), DRIVES)
    return {
        test.reason: held.get(test.reason, situation.t_ns)
        for test in tests
        if progress.phase in test.phases and test.is_true(situation, relative, config)
    }


def _holds(test: Test, held: Held, t_ns: int, config: CompanionConfig) -> bool:
    since_ns = held.get(test.reason)
    return since_ns is not None and (t_ns - since_ns) * 1e-9 >= test.hold_s(config)


def decide(progress: Progress, situation: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    """Return the event of this step and its reason in words, or None.

    The pilot comes first, then safety, then the time limits, then the landing's own progress.
    """
    taken = _control_taken(progress, situation)
    if taken is not None:
        return taken
    # On the pad and committed, cutting the approach short is the more dangerous way.
    for test in ABORT_TESTS:
        committed = progress.phase is Phase.DESCEND and _is_committed(situation, config)
        if not committed and _holds(test, held, situation.t_ns, config):
            return Event.UNSAFE, test.reason
    late = _time_limit(progress, situation, config)
    if late is not None:
        return late
    for event, test in ENTRY_TESTS:
        if _holds(test, held, situation.t_ns, config):
            return event, test.reason
    if progress.phase is Phase.WAITING and not _holds(DRIVES, held, situation.t_ns, config):
        return None
    return _advance(progress, situation, config)


def _is_committed(situation: Situation, config: CompanionConfig) -> bool:
    relative = approach(situation)
    return (
        relative is not None
        and not _not_placed(situation, relative, config)
        and -config.descent.press_depth_m < relative.height_m < config.descent.commit_height_m
        and is_over_pad(relative, config)
        and relative.speed_m_s < config.abort.near_speed_max_m_s
    )


def is_on_pad(situation: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone's estimated place is that of a drone standing on the pad: motors may be forced off."""
    relative = approach(situation)
    if relative is None or _not_placed(situation, relative, config) or _missed_pad(situation, relative, config):
        return False
    return relative.height_m < config.descent.commit_height_m and is_over_pad(relative, config)


def _control_taken(progress: Progress, s: Situation) -> Decision | None:
    # A silent link says nothing about who is in command; the autopilot's own failsafe acts.
    if progress.phase not in FLYING_PHASES or not progress.was_in_control or not s.autopilot.link_up:
        return None
    if s.autopilot.failsafe:
        return Event.PILOT_TOOK_OVER, "autopilot failsafe"
    if progress.phase is Phase.TOUCHDOWN and not s.autopilot.armed:
        return None  # as wanted; a mode that changes with it is not the pilot's
    if not s.autopilot.in_control:
        return Event.PILOT_TOOK_OVER, "mode changed by the pilot"
    if progress.was_armed and not s.autopilot.armed:
        return Event.PILOT_TOOK_OVER, "disarmed"
    return None


def _time_limit(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    in_phase_s = (s.t_ns - progress.since_ns) * 1e-9
    if progress.phase is Phase.TAKEOFF and in_phase_s > config.takeoff.refused_after_s:
        if not progress.was_in_control:
            return Event.REFUSED, "the autopilot did not give control in time"
        if not s.autopilot.armed:
            return Event.REFUSED, "the autopilot did not arm in time"
    limits_s = {
        Phase.TAKEOFF: config.takeoff.time_limit_s,
        Phase.CHASE: config.chase.time_limit_s,
        Phase.ALIGN: config.descent.align_time_limit_s,
        Phase.DESCEND: config.descent.time_limit_s,
    }
    limit_s = limits_s.get(progress.phase)
    if limit_s is not None and in_phase_s > limit_s:
        if progress.phase is Phase.ALIGN and _not_placed(s, None, config):
            return Event.TIME_LIMIT, "vehicle heading unknown"
        return Event.TIME_LIMIT, f"{progress.phase.value} took longer than {limit_s:g} s"
    return None


def _advance(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    match progress.phase:
        case Phase.TAKEOFF:
            return _at_waiting_point(s, config)
        case Phase.WAITING:
            return vehicle_passes(s, config)
        case Phase.CHASE | Phase.ALIGN:
            return _over_pad(progress, s, config)
        case Phase.TOUCHDOWN:
            return _on_the_pad(s, config)
        case Phase.ABORT:
            return _climbed(progress, s, config)
        case _:
            return None


def _at_waiting_point(s: Situation, config: CompanionConfig) -> Decision | None:
    if s.drone is None or s.waiting_point_enu_m is None or not (s.autopilot.armed and s.autopilot.in_control):
        return None
    distance_m = float(np.linalg.norm(s.drone.position_enu_m - s.waiting_point_enu_m))
    if distance_m > config.takeoff.reached_distance_m:
        return None
    return Event.AT_WAITING_POINT, "waiting for the vehicle"


def vehicle_passes(s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the event that starts the chase.

    A moving vehicle is chased from the moment at which a drone that accelerates evenly to the vehicle's speed
    v meets it: v / (2 a) before it passes. One that is past by more than the passing distance is let go.
    """
    if s.drone is None or s.pad is None or _fix_too_old(s, None, config) or _is_low(s, config):
        return None
    velocity = s.pad.velocity_enu_m_s[0, :2]
    ahead = s.drone.position_enu_m[:2] - s.pad.position_enu_m[0, :2]
    speed_m_s = float(np.hypot(*velocity))
    if speed_m_s < config.chase.parked_speed_m_s:
        return None
    to_go_m = float(ahead @ velocity) / speed_m_s
    beside_m = abs(float(ahead[0] * velocity[1] - ahead[1] * velocity[0])) / speed_m_s
    lead_m = speed_m_s**2 / (2.0 * config.chase.start_acceleration_m_s2)
    if beside_m > config.chase.passing_distance_m or not -config.chase.passing_distance_m < to_go_m < lead_m:
        return None
    return Event.VEHICLE_PASSES, f"vehicle passes at {speed_m_s:.1f} m/s"


def _over_pad(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    relative = approach(s)
    if relative is None or config.landing is LandingStyle.DIRECT:
        return None
    near_m = config.descent.align_distance_m
    if progress.phase is Phase.CHASE and relative.distance_m < near_m:
        return Event.OVER_PAD, f"{relative.distance_m:.1f} m from the pad"
    if progress.phase is Phase.ALIGN and relative.distance_m > 2.0 * near_m:
        return Event.OUT_OF_ALIGNMENT, f"{relative.distance_m:.1f} m from the pad"
    return None


def _on_the_pad(s: Situation, config: CompanionConfig) -> Decision | None:
    if not s.autopilot.armed:
        return Event.MOTORS_OFF, "motors are off on the pad"
    relative = approach(s)
    if relative is not None and relative.height_m > config.touchdown.lost_height_m:
        return Event.CONTACT_LOST, f"{relative.height_m:.1f} m above the pad after contact"
    return None


def _climbed(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    relative = approach(s)
    in_phase_s = (s.t_ns - progress.since_ns) * 1e-9
    fresh = not _fix_too_old(s, None, config)
    high = relative is not None and relative.height_m > 0.8 * config.abort.height_m
    if not (fresh and high) and in_phase_s < config.abort.time_limit_s:
        return None
    why_not = _no_retry(progress, s, config)
    if why_not is None:
        return Event.CLEAR, f"retry {progress.retries + 1} of {config.abort.retries_max}"
    return Event.CLEAR_TO_HOLD, why_not


def _no_retry(progress: Progress, s: Situation, config: CompanionConfig) -> str | None:
    if not progress.may_retry:
        return "broken off by the operator"
    if _fix_too_old(s, None, config):
        return "no vehicle data"
    if s.drone is None:
        return "own position too old"
    if _not_placed(s, None, config):
        return "vehicle heading unknown"
    return "no retry left" if progress.retries >= config.abort.retries_max else None
