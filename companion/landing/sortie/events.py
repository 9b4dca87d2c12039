"""Decides the event of a step in a sortie, and updates the sortie's memory; pure."""

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.integrity.contradictions import contradicts_itself, tell_rejected
from companion.integrity.stamps import have_stamps_stepped, is_stamped_ahead
from companion.landing.decisions.aborts import is_not_followed, is_token_lost, outruns
from companion.landing.decisions.conditions import (
    HEARD,
    Condition,
    first_cause,
    holds,
    is_attitude_unknown,
    is_drone_unknown,
    is_fix_old,
)
from companion.landing.decisions.entries import Decision
from companion.landing.decisions.events import TOO_LONG, arming_refused
from companion.landing.decisions.feasibility import EMPTY
from companion.landing.sortie.over_vehicle import is_deck_quiet, shall_motors_turn, tell_restless
from companion.landing.sortie.riding import CARRIED_OFF, call_off, has_not_left_deck
from companion.landing.sortie.way_home import warn_of_way_home, way_home_due
from companion.landing.state.memory import ControlMemory, Progress
from companion.landing.steering.following_height import chase_floor_m
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation, driving_hold_s
from companion.sortie.memory import UNTOLD, SortieMemory, update_battery
from companion.sortie.station import ahead_rad
from link.messages import StationFrame
from link.records import replace

_RISEN_SHARE = 0.8  # of the height that is clear of the deck
_ORDERED = frozenset({Reason.OPERATOR_HOLDS, Reason.OPERATOR_ABORTS, Reason.BROKEN_OFF})
_TOGETHER = frozenset({Phase.LIFT_OFF, Phase.FOLLOW, Phase.RETURN})

LOST = (
    Condition(reason=Reason.VEHICLE_DATA_OLD, phases=_TOGETHER | {Phase.ON_DECK}, is_true=is_fix_old),
    Condition(reason=Reason.VEHICLE_LINK_LOST, phases=_TOGETHER, is_true=is_token_lost),
    Condition(
        reason=Reason.VEHICLE_CLOCK_AHEAD,
        phases=_TOGETHER,
        is_true=is_stamped_ahead,
        hold_s=lambda _, c: c.integrity.fix_ahead_hold_s,
    ),
    Condition(
        reason=Reason.VEHICLE_CONTRADICTS_ITSELF,
        phases=_TOGETHER,
        is_true=contradicts_itself,
        cause=tell_rejected(Reason.VEHICLE_CONTRADICTS_ITSELF),
    ),
    Condition(
        reason=Reason.VEHICLE_OUTRUNS,
        phases=frozenset({Phase.FOLLOW, Phase.RETURN}),
        is_true=outruns,
        hold_s=driving_hold_s,
    ),
)
"""The vehicle is not heard, cannot be believed, or cannot be followed."""

OWN_LOST = (
    Condition(reason=Reason.OWN_POSITION_OLD, phases=_TOGETHER | {Phase.ON_DECK}, is_true=is_drone_unknown),
    Condition(reason=Reason.OWN_ATTITUDE_OLD, phases=_TOGETHER | {Phase.ON_DECK}, is_true=is_attitude_unknown),
)
"""Nobody knows where the drone is."""
_OWN_LOST_REASONS = frozenset(condition.reason for condition in OWN_LOST)
_VEHICLE_UNHEARD = frozenset({Reason.VEHICLE_DATA_OLD, Reason.VEHICLE_LINK_LOST})
_UNHEARD_AFTER_CLIMB = frozenset({Reason.NO_VEHICLE_DATA, Reason.PAD_NOT_SEEN, Reason.HEARD_WITH_BREAKS})

NOT_FOLLOWED = Condition(
    reason=Reason.SETPOINT_NOT_FOLLOWED,
    phases=frozenset({Phase.FOLLOW}),
    is_true=is_not_followed,
    hold_s=lambda _, c: c.abort.tracking_hold_s,
)
"""Beside a vehicle; on the way home the model is set back to the drone."""

MISPLACED = Condition(reason=Reason.STAMPS_STEPPED, phases=_TOGETHER, is_true=have_stamps_stepped)
"""The vehicle is metres from where it seems to be, and a station beside it may be in it: the drone climbs at once."""

SORTIE_CONDITIONS = (*LOST, *OWN_LOST, NOT_FOLLOWED, MISPLACED, CARRIED_OFF)


def update_sortie(sortie: SortieMemory, phase: Phase, s: Situation, config: CompanionConfig) -> SortieMemory:
    """Return the sortie with what this step tells of the vehicle's course, the deck and the battery."""
    # Who exchanges it disarms the drone.
    battery = update_battery(sortie.battery, s.autopilot.battery_share, s.monotonic_ns) if s.autopilot.armed else UNTOLD
    if not sortie.is_out:
        return sortie if battery is sortie.battery else replace(sortie, battery=battery)
    ahead = sortie.ahead_rad
    if s.pad is not None:
        ahead = ahead_rad(StationFrame.VEHICLE if sortie.station is None else sortie.station.frame, s.pad, ahead)
    is_on_deck = phase is Phase.ON_DECK
    is_quiet = is_on_deck and is_deck_quiet(s, config.sortie.launch)
    is_found = phase is Phase.RALLY and _is_found(s, config)
    sortie = replace(
        sortie,
        ahead_rad=ahead,
        battery=battery,
        was_due=sortie.was_due or way_home_due(sortie, s, config) is not None,
        quiet_since_ns=_since(sortie.quiet_since_ns, s.monotonic_ns, holds_now=is_quiet),
        idles_since_ns=_since(sortie.idles_since_ns, s.monotonic_ns, holds_now=is_on_deck and s.autopilot.armed),
        found_since_ns=_since(sortie.found_since_ns, s.monotonic_ns, holds_now=is_found),
    )
    return replace(sortie, warning=warn_of_way_home(sortie, phase, s, config))


def _is_found(s: Situation, config: CompanionConfig) -> bool:
    return not any(condition.is_true(s, config) for condition in LOST)


def _since(since_ns: int | None, now_ns: int, *, holds_now: bool) -> int | None:
    if not holds_now:
        return None
    return now_ns if since_ns is None else since_ns


def decide_sortie(
    sortie: SortieMemory, progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig
) -> Decision | None:
    """Return the event of this step in a phase of a sortie, None without one."""
    match progress.phase:
        case Phase.TAKEOFF | Phase.ON_DECK | Phase.LIFT_OFF:
            return _take_off(sortie, progress, control, s, config)
        case Phase.FOLLOW | Phase.RETURN:
            return _stay_together(sortie, progress, s, config)
        case Phase.RALLY:
            return _find(sortie, s, config)
        case Phase.ABORT if sortie.is_out:
            return _stay_on_deck(progress, s, config)
        case Phase.WAITING | Phase.HOLD if sortie.is_out:
            return _turn_home(sortie, progress, s, config) or _go_on(sortie, progress, s, config)
        case _:
            return None


def _take_off(
    sortie: SortieMemory, progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig
) -> Decision | None:
    match progress.phase:
        case Phase.TAKEOFF:
            return call_off(progress.held, control, s, config)
        case Phase.ON_DECK:
            return _leave_deck(sortie, progress, control, s, config)
        case _:
            return _rise(progress, s, config)


def stay_out(sortie: SortieMemory, progress: Progress, decision: Decision) -> Decision:
    """Return the decision, but no retry of a landing that was never begun: the abort broke off a station.

    Nor does it matter to a station why no landing could be begun again.
    """
    is_over = progress.phase is Phase.ABORT and decision[0] in (Event.CLEAR, Event.CLEAR_TO_HOLD)
    return (Event.CLEAR_TO_HOLD, progress.cause) if is_over and sortie.station is not None else decision


def _leave_deck(
    sortie: SortieMemory, progress: Progress, control: ControlMemory, s: Situation, config: CompanionConfig
) -> Decision | None:
    lost = first_cause((*LOST, *OWN_LOST, EMPTY), progress.held, s, config)
    if lost is not None:
        return Event.CALLED_OFF, lost
    launch, view = config.sortie.launch, s.autopilot
    in_phase_s = (s.monotonic_ns - progress.since_ns) * 1e-9
    if in_phase_s > config.takeoff.refused_after_s and not control.was_in_control:
        return Event.REFUSED, Cause(Reason.CONTROL_REFUSED)
    if in_phase_s > launch.time_limit_s:
        refused = None if sortie.quiet_since_ns is None else arming_refused(progress, control, s)
        return refused or (Event.TIME_LIMIT, tell_restless(s, launch))
    is_ready = view.armed and view.in_control and shall_motors_turn(sortie, s, launch) is True
    return (Event.DECK_QUIET, Cause(Reason.DECK_QUIET)) if is_ready else None


def _rise(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    unknown = first_cause((*OWN_LOST, MISPLACED), progress.held, s, config)
    if unknown is not None:  # that it was on the deck when it was heard last is no reason to stop its motors now
        return Event.UNSAFE, unknown
    lost, launch = first_cause(LOST, progress.held, s, config), config.sortie.launch
    if lost is not None:
        return (Event.CALLED_OFF if has_not_left_deck(s, config) else Event.UNSAFE), lost
    if (s.monotonic_ns - progress.since_ns) * 1e-9 > launch.lift_off_time_limit_s:
        too_long = Cause(TOO_LONG[Phase.LIFT_OFF], (launch.lift_off_time_limit_s,))
        return (Event.CALLED_OFF if has_not_left_deck(s, config) else Event.TIME_LIMIT), too_long
    if s.approach is not None and s.approach.height_m > _RISEN_SHARE * launch.clear_height_m:
        return Event.CLEAR_OF_DECK, Cause(Reason.CLEAR_OF_DECK, (s.approach.height_m,))
    return None


def _stay_together(sortie: SortieMemory, progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    unsafe = first_cause((*OWN_LOST, NOT_FOLLOWED, MISPLACED), progress.held, s, config)
    if unsafe is not None:
        return Event.UNSAFE, unsafe
    lost = first_cause(LOST, progress.held, s, config)
    if lost is not None:
        return Event.VEHICLE_LOST, lost
    if progress.phase is Phase.FOLLOW:
        return _turn_home(sortie, progress, s, config)
    limit_s = config.sortie.return_time_limit_s
    if (s.monotonic_ns - progress.since_ns) * 1e-9 > limit_s:
        return Event.TIME_LIMIT, progress.obstacle or Cause(TOO_LONG[Phase.RETURN], (limit_s,))
    a, near_m = s.approach, config.chase.passing_distance_m
    if a is None or a.distance_m > near_m or a.height_m < chase_floor_m(config) or progress.obstacle is not None:
        return None  # it stays above a vehicle that cannot be landed on, and says why
    return Event.VEHICLE_NEAR, Cause(Reason.VEHICLE_NEAR, (a.distance_m,))


def _turn_home(sortie: SortieMemory, progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the way home before the point of no return is passed; a way that took too long is not begun again.

    Nor one that an operator has broken off after its time had come; one who ordered a hold before may not know of it.
    """
    goes = sortie.follows or progress.may_retry or progress.cause.reason in _ORDERED
    due = way_home_due(sortie, s, config) if goes and not sortie.stays_out else None
    return None if due is None else (Event.HOME_NOW, due)


def _go_on(sortie: SortieMemory, progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return to what an outage has broken off, once drone and vehicle are heard again.

    The vehicle's alone breaks off a lift-off or a landing; from beside the vehicle, or on its way home, the drone looks
    for it.
    """
    is_outage = progress.cause.reason in _OWN_LOST_REASONS or _is_vehicle_back(sortie, progress, s, config)
    if not (is_outage and progress.may_retry and s.autopilot.in_control and holds(HEARD, progress.held, s, config)):
        return None
    return (Event.FOLLOW if sortie.follows else Event.RETURN), Cause(Reason.HEARD_AGAIN)


def _is_vehicle_back(sortie: SortieMemory, progress: Progress, s: Situation, config: CompanionConfig) -> bool:
    """Return whether a vehicle that was not heard broke off a lift-off, or a landing but the last, and is heard."""
    reason, is_last = progress.cause.reason, progress.retries >= config.abort.retries_max
    was_lifting = sortie.follows and sortie.station is not None and reason in _VEHICLE_UNHEARD
    was_landing = not sortie.follows and reason in _UNHEARD_AFTER_CLIMB and not is_last
    return (was_lifting or was_landing) and _is_found(s, config)


def _stay_on_deck(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the end of a lift-off that an outage has broken off, once it is over and the drone stands on the deck.

    Not every autopilot takes off by setpoints: its motors would run until it stops them by itself.
    """
    stands = s.autopilot.armed and holds(HEARD, progress.held, s, config) and has_not_left_deck(s, config)
    return (Event.CALLED_OFF, progress.cause) if stands else None


def _find(sortie: SortieMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    since_ns = sortie.found_since_ns
    if since_ns is None or (s.monotonic_ns - since_ns) * 1e-9 < config.abort.heard_hold_s:
        return None
    return (Event.FOLLOW if sortie.follows else Event.VEHICLE_FOUND), Cause(Reason.VEHICLE_FOUND)
