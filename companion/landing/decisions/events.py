"""Decides the event of a step: who is in command, what is unsafe, what takes too long, what comes next."""

import math

from companion.autopilots.messages import is_arming, may_turn, was_asked_to_arm
from companion.config.companion import CompanionConfig
from companion.config.planning import LandingStyle
from companion.core.data import GRAVITY_M_S2
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.aborts import (
    ABORTS,
    CONTACT_RISKY,
    is_pad_unplaced,
    is_uncertain,
    must_be_seen,
    why_unplaced,
)
from companion.landing.decisions.conditions import (
    LIFTED,
    MISSED,
    STOPPED_BY_PAD,
    Condition,
    cause_of,
    holds,
    is_below_pad,
    is_fix_old,
)
from companion.landing.decisions.entries import DRIVES, ENTRIES, Decision
from companion.landing.decisions.feasibility import is_drone_taken, obstacle
from companion.landing.decisions.passing import vehicle_passes
from companion.landing.decisions.retries import end_climb
from companion.landing.decisions.taken_control import find_taken_control, is_held_on_ground
from companion.landing.decisions.waiting import waited_s
from companion.landing.state.memory import ControlMemory, Held, Progress
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, Event, Phase
from companion.situation.situation import Approach, Situation
from companion.vehicle.pad_reach import left_behind_m, over_pad_radius_m

_COMMITTED = (*MISSED, CONTACT_RISKY)
_STDS = 2.0  # by which the pad may be elsewhere
_NEARLY_ALL = 0.95  # of 4.8 m/s^2, for 30 degrees: by what is left a drone comes nearer by a metre in 4 s


def decide(progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the event of this step and its cause, or None.

    The pilot comes first, then safety, then the time limits, then the landing's own progress.
    """
    # By then the autopilot's own failsafe acts. PX4 would go back into OFFBOARD with the first setpoint that arrives.
    if progress.phase in FLYING_PHASES and not s.autopilot.link_up:
        return Event.PILOT_TOOK_OVER, Cause(Reason.AUTOPILOT_LOST)
    if progress.phase in FLYING_PHASES and is_drone_taken(s, config):
        return Event.PILOT_TOOK_OVER, Cause(Reason.DRONE_TAKEN)
    taken = find_taken_control(progress.phase, control, s)
    if taken is not None:
        return taken
    # What the pad stops is fast against a pad that drives on: it would be taken for unsafe in the same step.
    if holds(STOPPED_BY_PAD, progress.held, s, config):
        return Event.CONTACT, cause_of(STOPPED_BY_PAD, s, config)
    # On the pad and committed, cutting the approach short is the more dangerous way, unless there is no pad or it would
    # be touched unsafely.
    committed = progress.phase is Phase.DESCEND and _is_committed(s, config)
    is_landing = progress.phase in LANDING_PHASES  # in a sortie the same reasons lead elsewhere
    broken_off = _unsafe(_COMMITTED if committed else ABORTS, s, progress.held, config) if is_landing else None
    if broken_off is None and not committed:
        broken_off = _time_limit(progress, control, s, config)
    return _go_on(progress, control, s, config) if broken_off is None else broken_off


def _unsafe(conditions: tuple[Condition, ...], s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    for condition in conditions:
        if holds(condition, held, s, config):
            return Event.UNSAFE, cause_of(condition, s, config)
    return None


def _go_on(progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the landing's own next event; a vehicle out of reach is waited beside, not chased."""
    if progress.phase is Phase.WAITING and obstacle(progress.held, s, config) is not None:
        return None
    for event, condition in ENTRIES:
        if holds(condition, progress.held, s, config):
            at_most = None if condition.anew_max is None else condition.anew_max(config)
            is_unsafe = at_most is not None and progress.begun_anew.get(condition.reason, 0) >= at_most
            return Event.UNSAFE if is_unsafe else event, cause_of(condition, s, config)
    if progress.phase is Phase.WAITING and not holds(DRIVES, progress.held, s, config):
        return None
    return _advance(progress, control, s, config)


def is_over_pad(a: Approach, c: CompanionConfig) -> bool:
    """Return whether the drone is so near the pad's centre that what it touches is the pad."""
    return a.distance_m < over_pad_radius_m(a.pad_half_width_m, c)


def _is_committed(s: Situation, config: CompanionConfig) -> bool:
    relative = s.approach
    return (
        relative is not None
        and not is_pad_unplaced(s, config)
        and -config.descent.sink.press_depth_m < relative.height_m < config.descent.commit_height_m
        and is_over_pad(relative, config)
        and relative.speed_m_s < config.abort.near_speed_max_m_s
    )


TOO_LONG = {
    Phase.LIFT_OFF: Reason.LIFT_OFF_TOO_LONG,
    Phase.RETURN: Reason.RETURN_TOO_LONG,
    Phase.TAKEOFF: Reason.TAKEOFF_TOO_LONG,
    Phase.CHASE: Reason.CHASE_TOO_LONG,
    Phase.ALIGN: Reason.ALIGN_TOO_LONG,
    Phase.DESCEND: Reason.DESCENT_TOO_LONG,
}


def _time_limit(progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    in_phase_s = (s.monotonic_ns - progress.since_ns) * 1e-9
    if progress.phase is Phase.TAKEOFF and in_phase_s > config.takeoff.refused_after_s:
        if not control.was_in_control:
            return Event.REFUSED, Cause(Reason.CONTROL_REFUSED)
        refused = arming_refused(progress, control, s)
        if refused is not None:
            return refused
    limit_s = _longest_s(progress.phase, config)
    waits_s = min(waited_s(progress, s.monotonic_ns), config.descent.risk.wait_max_s)
    if limit_s is not None and in_phase_s - waits_s > limit_s:
        not_placed = why_unplaced(s) if progress.phase is Phase.ALIGN else None
        held_back = _held_back(s) if progress.phase in (Phase.CHASE, Phase.ALIGN) else None
        return Event.TIME_LIMIT, not_placed or held_back or Cause(TOO_LONG[progress.phase], (limit_s,))
    return None


def _held_back(s: Situation) -> Cause | None:
    """Return that the pad's turn and the air take nearly all that the drone may lean, None where they do not."""
    most_m_s2 = math.inf if s.limits is None else s.limits.tilt_acceleration_m_s2
    if s.following.takes_m_s2 < _NEARLY_ALL * most_m_s2:
        return None
    takes_deg, most_deg = (math.degrees(math.atan(x / GRAVITY_M_S2)) for x in (s.following.takes_m_s2, most_m_s2))
    return Cause(Reason.TILT_TOO_SMALL, (takes_deg, most_deg))


def arming_refused(progress: Progress, control: ControlMemory, s: Situation) -> Decision | None:
    """Return that the autopilot does not arm although this phase has ordered it to; None where it has not."""
    if s.autopilot.armed or not was_asked_to_arm(control.driver, progress.since_ns):
        return None
    return Event.REFUSED, Cause(Reason.ARMING_REFUSED, (s.autopilot.refusal or "it said no reason",))


def _longest_s(phase: Phase, config: CompanionConfig) -> float | None:
    """Return how long a phase may take, None for as long as it likes."""
    match phase:
        case Phase.TAKEOFF:
            return config.takeoff.time_limit_s
        case Phase.CHASE:
            return config.chase.time_limit_s
        case Phase.ALIGN:
            return config.descent.alignment.time_limit_s
        case Phase.DESCEND:
            return config.descent.time_limit_s
        case _:
            return None


def _advance(progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    match progress.phase:
        case Phase.TAKEOFF:
            return _at_waiting_point(s, config)
        case Phase.WAITING:
            return vehicle_passes(s, config)
        case Phase.CHASE:
            return _over_pad(s, config)
        case Phase.TOUCHDOWN:
            return _motors_off(progress, control, s) if not s.autopilot.armed else _on_the_pad(s, progress.held, config)
        case Phase.HOLD | Phase.ABORT as phase:
            return end_climb(progress, s, config) if phase is Phase.ABORT else _never_armed(progress, control, s)
        case _:
            return None


def _at_waiting_point(s: Situation, config: CompanionConfig) -> Decision | None:
    if s.drone is None or s.waiting_point_enu_m is None or not (s.autopilot.armed and s.autopilot.in_control):
        return None
    distance_m = math.hypot(*(s.drone.position_enu_m - s.waiting_point_enu_m).tolist())
    if distance_m > config.takeoff.reached_distance_m:
        return None
    return Event.AT_WAITING_POINT, Cause(Reason.AT_WAITING_POINT)


def _over_pad(s: Situation, config: CompanionConfig) -> Decision | None:
    if s.approach is None or config.guidance.style is LandingStyle.DIRECT:
        return None
    known = not is_uncertain(s, config) and not must_be_seen(s, config)
    if s.approach.distance_m < config.descent.alignment.begin_distance_m and known:
        return Event.OVER_PAD, Cause(Reason.OVER_PAD, (s.approach.distance_m,))
    return None


def _motors_off(progress: Progress, control: ControlMemory, s: Situation) -> Decision | None:
    """Return the end of a landing, or of a take-off that the vehicle has carried off, once no motor can turn."""
    if is_arming(control.driver, s.monotonic_ns):
        return None
    if progress.cause.reason is Reason.RIDES_ALONG:
        return Event.CALLED_OFF, progress.cause
    return Event.MOTORS_OFF, Cause(Reason.MOTORS_OFF)


def _never_armed(progress: Progress, control: ControlMemory, s: Situation) -> Decision | None:
    """Return that a take-off is called off that was to be held on the ground, once no motor can turn.

    Its order to arm was under way and has failed, or the motors have been switched off again.
    """
    was_undone = is_held_on_ground(progress.phase, control, s) and control.driver.disarm_asked
    turns = (control.was_armed and not was_undone) or may_turn(s.autopilot, control.driver, s.monotonic_ns)
    return None if turns or s.autopilot.landed is False else (Event.CALLED_OFF, progress.cause)


def _on_the_pad(s: Situation, held: Held, config: CompanionConfig) -> Decision | None:
    relative = s.approach
    is_lost = relative is not None and relative.height_m > config.touchdown.lost.height_m
    if relative is not None and (is_lost or holds(LIFTED, held, s, config)):
        return Event.CONTACT_LOST, Cause(Reason.ABOVE_AFTER_CONTACT, (relative.height_m,))
    if is_below_pad(s, config):
        return Event.CONTACT_LOST, Cause(Reason.BELOW_AFTER_CONTACT)
    if _is_left_in_the_air(s, config):
        return Event.CONTACT_LOST, Cause(Reason.LEFT_AFTER_CONTACT)
    return None


def _is_left_in_the_air(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the pad has gone from under the drone and nothing else holds it up: it flies.

    That is so where its range finder sees nothing at its feet; without one, where no part of the vehicle is.
    """
    a, seen_m = s.approach, s.below.range_height_m
    if a is None or s.pad is None or s.autopilot.landed is True or is_fix_old(s, config):
        return False
    surely_m = a.distance_m - _STDS * float(max(s.pad.position_std_m[0, :2].tolist()))
    if surely_m <= left_behind_m(a.pad_half_width_m, config):
        return False
    if seen_m is not None:
        return seen_m > config.touchdown.range_finder.contact_height_max_m
    return surely_m > config.sortie.vehicle_radius_m
