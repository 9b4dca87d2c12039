"""What a launch, a station or the way home still lacks when an operator orders it; pure."""

import math

from companion.config.autopilot import Guide
from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.integrity.heights import VEHICLE_M
from companion.landing.aborts import why_unplaced
from companion.landing.conditions import is_fix_old
from companion.landing.following_height import chase_floor_m
from companion.landing.over_vehicle import SPEED_SHARE, keep_out_of
from companion.landing.sortie_aims import rally_point_enu_m
from companion.landing.sortie_decisions import home_s
from companion.situation.phases import Event
from companion.situation.situation import Situation
from companion.sortie.quiet_deck import stands_on_deck
from companion.sortie.station import is_inside
from link.messages import Station

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
        return Cause(Reason.NO_VEHICLE_DATA)
    match event:
        case Event.LAUNCH:
            return _missing_for_launch(s) or _unless_ground_is_deck(obstacle) or _rally_out_of_range(s, config)
        case Event.FOLLOW if station is not None:
            return why_no_station(station, s, config) or _out_of_reach(s, config) or _rally_out_of_range(s, config)
        case _:
            return _out_of_reach(s, config)


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
        return Cause(Reason.NO_VEHICLE_DATA)
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


def _out_of_reach(s: Situation, config: CompanionConfig) -> Cause | None:
    if s.approach is None or s.pad is None or s.limits is None:
        return Cause(Reason.NO_OWN_POSITION)
    if s.approach.distance_m > config.limits.range_max_m:
        return Cause(Reason.VEHICLE_OUT_OF_RANGE, (s.approach.distance_m, config.limits.range_max_m))
    if math.isfinite(home_s(s, config)):
        return None
    speed_m_s = math.hypot(*s.pad.velocity_enu_m_s[0, :2].tolist())
    return Cause(Reason.VEHICLE_DRIVES_OFF, (speed_m_s, SPEED_SHARE * s.limits.speed_max_m_s))
