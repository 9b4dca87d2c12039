"""Answers to an operator's commands: what is accepted in which phase, and why not."""

import math

from companion.config.autopilot import Guide
from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason, sentence
from companion.integrity.frames import tell_unheard
from companion.integrity.heights import VEHICLE_M
from companion.integrity.stamps import named_by_stamps
from companion.landing.decisions.aborts import why_unplaced
from companion.landing.decisions.conditions import is_fix_old
from companion.landing.sortie.aims import rally_point_enu_m
from companion.landing.sortie.over_vehicle import keep_out_of, stands_on_deck
from companion.landing.sortie.riding import has_not_left_deck, rides_along, tell_riding
from companion.landing.sortie.way_home import out_of_reach
from companion.landing.steering.following_height import chase_floor_m
from companion.situation.phases import Event, Phase, next_phase
from companion.situation.situation import Situation
from companion.sortie.station import is_inside
from link.messages import Command, CommandReply, Order, Station

SORTIE_EVENTS = frozenset({Event.LAUNCH, Event.FOLLOW, Event.RETURN})
_DECK_HEIGHT_M = 0.5  # of the feet off the pad: receivers of some decimetres know a height so well


def missing_for_sortie(
    event: Event, station: Station | None, s: Situation, config: CompanionConfig, obstacle: Cause | None
) -> Cause | None:
    """Return the first thing that stands against an order of a sortie, None when nothing does.

    Args:
        event: launch, follow or return.
        station: of a follow.
        s: the facts.
        config: all numbers.
        obstacle: why no landing can be done.
    """
    if config.autopilot.guide is Guide.PRECLAND:
        return Cause(Reason.GUIDES_ONLY)
    if s.pad is None or is_fix_old(s, config):
        return named_by_stamps(obstacle) or tell_unheard(s, config)
    match event:
        case Event.LAUNCH:
            return _missing_for_launch(s) or _unless_ground_is_deck(obstacle) or _rally_out_of_range(s, config)
        case Event.FOLLOW if station is not None:
            return why_no_station(station, s, config) or out_of_reach(s, config) or _rally_out_of_range(s, config)
        case _:
            return out_of_reach(s, config)


def is_above_vehicle(s: Situation, config: CompanionConfig) -> bool:
    """Return whether a chase can begin where the drone is: near the vehicle, and clear of its roof."""
    a = s.approach
    return a is not None and a.distance_m < config.chase.passing_distance_m and a.height_m >= chase_floor_m(config)


def why_no_station(station: Station, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return why no drone may be at a station: too far away, in the vehicle, or too low beside it."""
    distance_m = math.hypot(*station.offset_m)
    if distance_m > config.sortie.offset_max_m:
        return Cause(Reason.STATION_TOO_FAR, (distance_m, config.sortie.offset_max_m))
    if s.pad is None:
        return tell_unheard(s, config)
    keep_out = keep_out_of(s.pad, config)
    if not is_inside(station.offset_m, keep_out):
        return None
    return Cause(Reason.STATION_IN_VEHICLE, (keep_out.radius_m, keep_out.lowest_m, keep_out.over_m))


def _missing_for_launch(s: Situation) -> Cause | None:
    if s.autopilot.armed and s.autopilot.landed is False:
        return Cause(Reason.NOT_ON_DECK)
    unplaced = why_unplaced(s)
    if unplaced is not None:
        return unplaced
    return None if stands_on_deck(s, VEHICLE_M, _DECK_HEIGHT_M) else Cause(Reason.NOT_ON_DECK)


def _unless_ground_is_deck(obstacle: Cause | None) -> Cause | None:
    """Return what stands in a landing's way; to a drone whose ground was the deck the road seems elsewhere."""
    return None if obstacle is not None and obstacle.reason is Reason.ROAD_ELSEWHERE else obstacle


def _rally_out_of_range(s: Situation, config: CompanionConfig) -> Cause | None:
    rally = rally_point_enu_m(s, config)
    if rally is None or s.drone is None:
        return None
    distance_m = math.hypot(*(rally - s.drone.position_enu_m)[:2].tolist())
    most_m = config.limits.range_max_m
    return Cause(Reason.RALLY_TOO_FAR, (distance_m, most_m)) if distance_m > most_m else None


_EVENTS = {
    Command.START: Event.START,
    Command.START_ANYWAY: Event.START,  # the question that it skips is asked before the step
    Command.ABORT: Event.ABORT,
    Command.HOLD: Event.HOLD,
    Command.LAUNCH: Event.LAUNCH,
    Command.FOLLOW: Event.FOLLOW,
    Command.RETURN: Event.RETURN,
}


def answer(
    order: Order,
    phase: Phase,
    situation: Situation,
    config: CompanionConfig,
    obstacle: Cause | None = None,
    *,
    called_home: Cause | None = None,
    is_arming: bool = False,
    is_disarming: bool = False,
) -> tuple[Event | None, CommandReply]:
    """Return the event that the order amounts to, None when it changes no phase, and the reply.

    Args:
        order: the operator's.
        phase: now.
        situation: now.
        config: all numbers.
        obstacle: why no landing can be done, None when one can.
        called_home: that the battery lasts just for the way home, None while it lasts longer.
        is_arming: the motors may turn although nothing has told so yet.
        is_disarming: they are ordered to stop, and nothing has told so yet.
    """
    event = _event_of(order, phase, situation, config, may_turn=situation.autopilot.armed or is_arming)
    is_start = order.command in (Command.START, Command.START_ANYWAY)
    if phase in (Phase.ABORT, Phase.HOLD) and event in (Event.ABORT, Event.HOLD):
        return None, _ACCEPTED  # the climb goes on, but to no retry, and a hold stays one whatever is heard again
    stays = phase is Phase.FOLLOW and event is Event.FOLLOW  # at another station
    if next_phase(phase, event) is phase and not stays:
        return None, _refuse(Cause(Reason.NOTHING_TO_DO, (order.command.value, phase.value)))
    missing = None
    if is_start or event is Event.LAUNCH:
        missing = _missing_for_start(situation, obstacle)
    if is_start:
        riding = tell_riding(situation, config) if rides_along(situation, config) else None
        missing = (Cause(Reason.MOTORS_STOPPING) if is_disarming else None) or missing or riding or obstacle
    if event in (Event.FOLLOW, Event.RETURN) and not _flies(situation):
        missing = Cause(Reason.NOT_FLOWN, (order.command.value,))
    if event in SORTIE_EVENTS:
        missing = missing or missing_for_sortie(event, order.station, situation, config, obstacle)
        missing = missing or (called_home if event is Event.FOLLOW else None)
    return (None, _refuse(missing)) if missing is not None else (event, _ACCEPTED)


def _event_of(order: Order, phase: Phase, s: Situation, config: CompanionConfig, *, may_turn: bool) -> Event:
    event = _EVENTS[order.command]
    is_start = event is Event.START
    stands = not may_turn or phase is Phase.ON_DECK or (phase is Phase.LIFT_OFF and has_not_left_deck(s, config))
    if phase in (Phase.TAKEOFF, Phase.ON_DECK, Phase.LIFT_OFF) and event in (Event.ABORT, Event.HOLD) and stands:
        return Event.CALLED_OFF  # on the ground there is nothing to hold
    if phase is Phase.HOLD and is_start and not _flies(s):
        return Event.START_AGAIN  # broken off before it has left the ground: control and motors are asked for again
    if phase is Phase.FOLLOW and is_start and not is_above_vehicle(s, config):
        return Event.RETURN
    return event


def _flies(s: Situation) -> bool:
    """Return whether the drone has its motors on, is not on the ground, and follows the companion."""
    return s.autopilot.in_control and s.autopilot.armed and s.autopilot.landed is not True


_ACCEPTED = CommandReply(accepted=True, reason="")


def _refuse(why: Cause) -> CommandReply:
    return CommandReply(accepted=False, reason=sentence(why))


def _missing_for_start(situation: Situation, obstacle: Cause | None) -> Cause | None:
    """Return the first thing that is missing for a start, None when nothing is.

    The autopilot tells its receiver's height once a second. One that has lacked it for long is an obstacle; one that
    lacks it as yet has just started.
    """
    view, drone = situation.autopilot, situation.drone
    missing = {
        Reason.NO_AUTOPILOT: not view.link_up,
        Reason.NO_ORIGIN: view.frame is None or (not view.receiver.knows_geoid and obstacle is None),
        Reason.HEIGHTS_APART: not view.receiver.knows_geoid,
        Reason.NO_OWN_POSITION: drone is None,
        Reason.NO_OWN_ATTITUDE: drone is not None and not drone.attitude_known,
        Reason.IN_FAILSAFE: view.failsafe,
        Reason.MOTORS_KILLED: view.killed,
    }
    return next((Cause(reason) for reason, is_missing in missing.items() if is_missing), None)
