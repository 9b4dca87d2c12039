"""Which event a step's facts amount to: who is in command, what is unsafe, what takes too long, what comes next."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.config.landing import LandingStyle
from companion.landing.condition import Held, Test, holds
from companion.landing.conditions import (
    ABORT_TESTS,
    DRIVES,
    ENTRY_TESTS,
    MAY_BEGIN_ANEW,
    is_out_of_range,
    is_over_pad,
    is_uncertain,
    must_be_seen,
    not_placed,
)
from companion.landing.contact import described, signs_of
from companion.landing.contact_tests import LIFTED, MISSED, STOPPED_BY_PAD, missed_pad
from companion.landing.feasibility import obstacle
from companion.landing.passing import vehicle_passes
from companion.landing.silence import HEARD, attitude_unknown, fix_too_old
from companion.situation.phases import FLYING_PHASES, Event, Phase
from companion.situation.situation import Situation, approach

Decision = tuple[Event, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Where in the landing we are, and for how long."""

    phase: Phase
    since_ns: int
    retries: int
    may_retry: bool  # no operator has broken the landing off
    was_in_control: bool  # the autopilot's mode has been the companion's since the start
    was_armed: bool  # and its motors were armed in that mode
    is_interrupted: bool  # what was broken off goes on, at no cost
    begun_anew: Mapping[str, int]  # how often in this approach, by the reason
    waited_s: float  # in this phase, above a vehicle that has surprised


def decide(progress: Progress, situation: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    """Return the event of this step and its reason in words, or None.

    The pilot comes first, then safety, then the time limits, then the landing's own progress.
    """
    # By then the autopilot's own failsafe acts. PX4 would go back into OFFBOARD with the first setpoint that arrives.
    if progress.phase in FLYING_PHASES and not situation.autopilot.link_up:
        return Event.PILOT_TOOK_OVER, "out of touch with the autopilot"
    taken = _control_taken(progress, situation)
    if taken is not None:
        return taken
    # What the pad stops is fast against a pad that drives on: it would be taken for unsafe in the same step.
    if holds(STOPPED_BY_PAD, held, situation.t_ns, config):
        return Event.CONTACT, _with_evidence(Event.CONTACT, STOPPED_BY_PAD.reason, situation)
    # On the pad and committed, cutting the approach short is the more dangerous way, unless there is no pad.
    committed = progress.phase is Phase.DESCEND and _is_committed(situation, config)
    broken_off = _unsafe(MISSED if committed else ABORT_TESTS, situation, held, config)
    if broken_off is None and not committed:
        broken_off = _time_limit(progress, situation, config)
    return _going_on(progress, situation, held, config) if broken_off is None else broken_off


def _unsafe(tests: tuple[Test, ...], s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    for test in tests:
        if holds(test, held, s.t_ns, config):
            unplaced = s.pad.unplaced if s.pad is not None and test.is_true is not_placed else None
            return Event.UNSAFE, unplaced or test.reason
    return None


def _going_on(progress: Progress, s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    """Return the landing's own next event; a vehicle out of reach is waited beside, not chased."""
    if progress.phase is Phase.WAITING and obstacle(held, s, config) is not None:
        return None
    for event, test in ENTRY_TESTS:
        if holds(test, held, s.t_ns, config):
            at_most = MAY_BEGIN_ANEW.get(test.reason)
            if at_most is not None and progress.begun_anew.get(test.reason, 0) >= at_most(config):
                return Event.UNSAFE, test.reason
            return event, _with_evidence(event, test.reason, s)
    if progress.phase is Phase.WAITING and not holds(DRIVES, held, s.t_ns, config):
        return None
    return _advance(progress, s, held, config)


def _is_committed(situation: Situation, config: CompanionConfig) -> bool:
    relative = approach(situation)
    return (
        relative is not None
        and not not_placed(situation, relative, config)
        and -config.descent.press_depth_m < relative.height_m < config.descent.commit_height_m
        and is_over_pad(relative, config)
        and relative.speed_m_s < config.abort.near_speed_max_m_s
    )


def _with_evidence(event: Event, reason: str, situation: Situation) -> str:
    """Return the reason of an event; a contact's bears the signs that it was decided by, for the log."""
    return f"{reason}: {described(signs_of(situation))}" if event is Event.CONTACT else reason


def _control_taken(progress: Progress, s: Situation) -> Decision | None:
    if progress.phase not in FLYING_PHASES or not progress.was_in_control:
        return None
    if s.autopilot.failsafe or s.autopilot.overruled:
        return Event.PILOT_TOOK_OVER, "autopilot failsafe"
    if progress.phase is Phase.TOUCHDOWN and not s.autopilot.armed:
        return None  # as wanted; a mode that changes with it is not the pilot's
    if not s.autopilot.in_control:
        return Event.PILOT_TOOK_OVER, "autopilot restarted" if s.autopilot.restarted else "mode changed by the pilot"
    if progress.was_armed and not s.autopilot.armed:
        return Event.PILOT_TOOK_OVER, "disarmed"
    return None


def _time_limit(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    in_phase_s = (s.t_ns - progress.since_ns) * 1e-9
    if progress.phase is Phase.TAKEOFF and in_phase_s > config.takeoff.refused_after_s:
        if not progress.was_in_control:
            return Event.REFUSED, "the autopilot did not give control in time"
        if not s.autopilot.armed:
            return Event.REFUSED, f"the autopilot did not arm in time: {s.autopilot.refusal or 'it said no reason'}"
    limit_s, waited_s = _longest_s(progress.phase, config), min(progress.waited_s, config.descent.surprise_wait_max_s)
    if limit_s is not None and in_phase_s - waited_s > limit_s:
        if progress.phase is Phase.ALIGN and s.pad is not None and s.pad.unplaced is not None:
            return Event.TIME_LIMIT, s.pad.unplaced
        return Event.TIME_LIMIT, f"{progress.phase.value} took longer than {limit_s:g} s"
    return None


def _longest_s(phase: Phase, config: CompanionConfig) -> float | None:
    """Return how long a phase may take, None for as long as it likes."""
    match phase:
        case Phase.TAKEOFF:
            return config.takeoff.time_limit_s
        case Phase.CHASE:
            return config.chase.time_limit_s
        case Phase.ALIGN:
            return config.descent.align_time_limit_s
        case Phase.DESCEND:
            return config.descent.time_limit_s
        case _:
            return None


def _advance(progress: Progress, s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    match progress.phase:
        case Phase.TAKEOFF:
            return _at_waiting_point(s, config)
        case Phase.WAITING:
            return vehicle_passes(s, config)
        case Phase.CHASE:
            return _over_pad(s, config)
        case Phase.TOUCHDOWN:
            return _on_the_pad(s, held, config)
        case Phase.ABORT:
            return _climbed(progress, s, held, config)
        case _:
            return None


def _at_waiting_point(s: Situation, config: CompanionConfig) -> Decision | None:
    if s.drone is None or s.waiting_point_enu_m is None or not (s.autopilot.armed and s.autopilot.in_control):
        return None
    distance_m = math.hypot(*(s.drone.position_enu_m - s.waiting_point_enu_m).tolist())
    if distance_m > config.takeoff.reached_distance_m:
        return None
    return Event.AT_WAITING_POINT, "waiting for the vehicle"


def _over_pad(s: Situation, config: CompanionConfig) -> Decision | None:
    relative = approach(s)
    if relative is None or config.landing is LandingStyle.DIRECT:
        return None
    known = not is_uncertain(s, relative, config) and not must_be_seen(s, relative, config)
    if relative.distance_m < config.descent.align_distance_m and known:
        return Event.OVER_PAD, f"{relative.distance_m:.1f} m from the pad"
    return None


def _on_the_pad(s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    if not s.autopilot.armed:
        return Event.MOTORS_OFF, "motors are off on the pad"
    relative = approach(s)
    is_lost = relative is not None and relative.height_m > config.touchdown.lost_height_m
    if relative is not None and (is_lost or holds(LIFTED, held, s.t_ns, config)):
        return Event.CONTACT_LOST, f"{relative.height_m:.1f} m above the pad after contact"
    if missed_pad(s, relative, config):
        return Event.CONTACT_LOST, "below the pad after contact"
    return None


def _climbed(progress: Progress, s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    relative = approach(s)
    in_phase_s = (s.t_ns - progress.since_ns) * 1e-9
    high = relative is not None and relative.height_m > 0.8 * config.abort.height_m
    ready = high and holds(HEARD, held, s.t_ns, config)
    if not ready and in_phase_s < config.abort.time_limit_s:
        return None
    why_not = _no_retry(progress, s, held, config)
    if why_not is None and progress.is_interrupted:
        return Event.CLEAR, "heard again: the same approach goes on"
    if why_not is None:
        return Event.CLEAR, f"retry {progress.retries + 1} of {config.abort.retries_max}"
    return Event.CLEAR_TO_HOLD, why_not


def _no_retry(progress: Progress, s: Situation, held: Held, config: CompanionConfig) -> str | None:
    """Return why no other approach is made, the first of all reasons; None when one is."""
    known = obstacle(held, s, config)
    unplaced = None if s.pad is None else s.pad.unplaced
    reasons = {
        "broken off by the operator": not progress.may_retry,
        "no vehicle data": fix_too_old(s, None, config),
        "own position too old": s.drone is None,
        "own attitude too old": attitude_unknown(s, None, config),
        "vehicle or autopilot heard of with breaks only": not holds(HEARD, held, s.t_ns, config),
        unplaced or "pad placed": unplaced is not None,
        "too far from the start": is_out_of_range(s, None, config),
        known[1] if known is not None else "": known is not None,
        "no retry left": not progress.is_interrupted and progress.retries >= config.abort.retries_max,
    }
    return next((reason for reason, holds_now in reasons.items() if holds_now), None)
