"""Where the phases of a sortie want the drone over the horizon: lift-off, station, way home, rally; pure.

The first station is reached on a way that is laid from where the drone was when it was told to go, each other one from
the place on the way before. A place moves along the way, and the drone is led to this place with all that it can. The
place does not wait for a drone that falls behind in a brake or a bend: a way that restarted wherever the drone is would
lead it back with `WAY_SHARE` of that.
"""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import STEP_MAX_S, Array, FlightLimits
from companion.landing.decisions.conditions import is_fix_old
from companion.landing.sortie.in_the_way import kept_station_m
from companion.landing.sortie.over_vehicle import (
    WAY_SHARE,
    floor_beside,
    keep_out_now,
    keep_out_of,
    offset_now,
    over_vehicle,
    place_speed_m_s,
    turns_too_fast,
    way_speed_m_s,
)
from companion.landing.sortie.rise_over_vehicle import rise_over_vehicle
from companion.landing.state.memory import StepMemory
from companion.landing.steering.following_height import unseen_height_m
from companion.landing.steering.targets import NO_FLOOR_M, Aim, hover_aim
from companion.planning.guidance import ReferenceState
from companion.situation.phases import STATION_PHASES, Phase
from companion.situation.situation import Situation
from companion.sortie.memory import SortieMemory, Way
from companion.sortie.station import KeepOut, ahead_rad, is_clear, keep_outside, turned, way_to
from companion.vehicle.pad import PadPath
from link.frames.geodesy import local_from_geodetic
from link.messages import StationFrame
from link.records import replace


def advance_way(memory: StepMemory, s: Situation, limits: FlightLimits, config: CompanionConfig) -> StepMemory:
    """Return the memory with the place on the way to the station moved on to this step.

    It begins where the drone is: for the first station, for one in another frame, and when the drone has been pushed to
    where the vehicle is between it and its place.
    """
    sortie, reference, pad = memory.sortie, memory.model.reference, s.pad
    if memory.progress.phase is not Phase.FOLLOW or sortie.station is None or reference is None or pad is None:
        return memory if sortie.way is None else replace(memory, sortie=replace(sortie, way=None))
    way = _way_now(sortie, offset_now(pad, reference, s), pad, limits, now_ns=s.monotonic_ns, config=config)
    dt_s = min((s.monotonic_ns - way.at_ns) * 1e-9, STEP_MAX_S)
    wanted, keep_out, rates = _ends_at(way, sortie.ahead_rad, pad, limits, config)
    place = way_to(way.place_m, wanted, keep_out, np.array([0.0, dt_s]), rates)[-1]
    way = replace(way, place_m=np.asarray(place), at_ns=s.monotonic_ns)
    return replace(memory, sortie=replace(sortie, way=way))


def _way_now(
    sortie: SortieMemory,
    here_enu_m: Array,
    pad: PadPath,
    limits: FlightLimits,
    *,
    now_ns: int,
    config: CompanionConfig,
) -> Way:
    """Return the way with its end now: the last one, or one that begins where the drone is, `here_enu_m` (3,).

    Where the vehicle would swing the place on it, or its end, faster than the drone can fly, the way is laid without
    turning along, as that home is: the place would leave the drone behind, farther at each turn.
    """
    station, way, keep_out = sortie.station, sortie.way, keep_out_now(pad, config)
    if station is None:
        raise ValueError("nothing is followed without a station")
    end_m = kept_station_m(station, sortie.ahead_rad, pad, limits, config)
    ahead = ahead_rad(station.frame, pad, sortie.ahead_rad)
    here_m = turned(here_enu_m, -ahead)
    place_m = way.place_m if way is not None and way.frame is station.frame else here_m
    is_outrun = any(turns_too_fast(one, station.frame, ahead, pad, limits) for one in (place_m, end_m))
    frame = StationFrame.NORTH if is_outrun else station.frame
    begins_m = turned(here_enu_m, -ahead_rad(frame, pad, sortie.ahead_rad))
    if way is not None and way.frame is frame and is_clear(begins_m, way.place_m, keep_out):
        return replace(way, station=station, end_m=end_m)
    return Way(station=station, frame=frame, end_m=end_m, place_m=begins_m, at_ns=now_ns)


def station_aim(sortie: SortieMemory, pad: PadPath, s: Situation, limits: FlightLimits, config: CompanionConfig) -> Aim:
    """Return the aim that keeps the station, or is on the way to it round the vehicle."""
    if sortie.way is None:
        raise ValueError("nothing is followed without a way to its station")
    wanted, keep_out, rates = _ends_at(sortie.way, sortie.ahead_rad, pad, limits, config)
    way = way_to(sortie.way.place_m, wanted, keep_out, pad.offset_s, rates)
    ahead = ahead_rad(sortie.way.frame, pad, sortie.ahead_rad)
    target = over_vehicle(way, sortie.way.frame, ahead, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=floor_beside(pad, keep_out, s))


def _ends_at(
    way: Way, before_rad: float, pad: PadPath, limits: FlightLimits, config: CompanionConfig
) -> tuple[Array, KeepOut, tuple[float, float]]:
    """Return the end (3,) of the way in its frame, what it leads round, and the acceleration and the speed on it."""
    ahead = ahead_rad(way.frame, pad, before_rad)
    wanted = turned(way.end_m, ahead_rad(way.station.frame, pad, before_rad) - ahead)
    speed_m_s = way_speed_m_s(turned(wanted - way.place_m, ahead), pad, limits)
    return wanted, keep_out_now(pad, config), (WAY_SHARE * limits.acceleration_max_m_s2, speed_m_s)


def station_speed_m_s(sortie: SortieMemory, s: Situation) -> float:
    """Return how fast over ground the station itself moves."""
    if sortie.station is None or s.pad is None:
        return 0.0
    frame = sortie.station.frame
    ahead = ahead_rad(frame, s.pad, sortie.ahead_rad)
    return place_speed_m_s(np.array(sortie.station.offset_m), frame, ahead, s.pad)


_CLIMB_FIRST_M = 1.0  # a drone that is lower than this under its place climbs before it flies there
_AT_RALLY_M = 3.0  # horizontally, as near as a receiver may err: there the drone comes down to the rally point


def sortie_aim(memory: StepMemory, s: Situation, limits: FlightLimits, config: CompanionConfig) -> Aim | None:
    """Return where a phase of a sortie wants the drone, None in any other; without a vehicle it stops at the anchor.

    Args:
        memory: with the phase.
        s: the facts.
        config: of the companion.
        limits: of the plan that is to follow the aim: a way that is faster is not flown straight.
    """
    phase, sortie, pad = memory.progress.phase, memory.sortie, s.pad
    reference, anchor_enu_m = memory.model.reference, memory.places.anchor_enu_m
    if reference is None or anchor_enu_m is None:
        raise ValueError(f"phase {phase.value} flies without a reference")
    if phase is Phase.RALLY:
        return rally_aim(sortie, anchor_enu_m, reference, rally_point_now(memory, s, config))
    if pad is None:
        return hover_aim(anchor_enu_m) if phase in STATION_PHASES | {Phase.ON_DECK} else None
    match phase:
        case Phase.ON_DECK:
            return deck_aim(pad, reference, s)
        case Phase.LIFT_OFF:
            return lift_off_aim(sortie, pad, s.feet_offset_m)
        case Phase.FOLLOW:
            aim, keep_out = station_aim(sortie, pad, s, limits, config), keep_out_now(pad, config)
        case Phase.RETURN:
            aim, keep_out = return_aim(pad, reference, s, config, limits=limits), keep_out_of(pad, config)
        case Phase.ABORT if sortie.station is not None and not is_fix_old(s, config):
            aim, keep_out = climb_aim(pad, reference, s, config, limits=limits), keep_out_now(pad, config)
        case _:
            return None
    return rise_over_vehicle(
        aim,
        memory.model.plan,
        s.drone,
        pad,
        keep_out,
        monotonic_ns=s.monotonic_ns,
        feet_offset_m=s.feet_offset_m,
        config=config,
    )


def deck_aim(pad: PadPath, reference: ReferenceState, s: Situation) -> Aim:
    """Return the aim that stays where on the deck the drone stands, so that nothing pulls it back to where it was."""
    stays = np.tile(offset_now(pad, reference, s), (len(pad.offset_s), 1))
    target = over_vehicle(stays, StationFrame.NORTH, 0.0, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=np.full(len(pad.offset_s), NO_FLOOR_M))


def lift_off_aim(sortie: SortieMemory, pad: PadPath, feet_offset_m: float) -> Aim:
    """Return the aim that rises from where on the deck the drone stood, moving and turning with the deck."""
    if sortie.station is None:
        raise ValueError("a lift-off has no place on the deck")
    wanted = np.tile(sortie.station.offset_m, (len(pad.offset_s), 1))
    target = over_vehicle(wanted, sortie.station.frame, sortie.ahead_rad, pad, feet_offset_m)
    return Aim(target=target, floor_enu_m=np.full(len(pad.offset_s), NO_FLOOR_M))


def return_aim(
    pad: PadPath, reference: ReferenceState, s: Situation, config: CompanionConfig, *, limits: FlightLimits
) -> Aim:
    """Return the aim on the straight way to above the vehicle, wherever that drives.

    It ends as high as a chase begins over a pad that is as vague: that is clear of the vehicle wherever it is.
    """
    keep_out = keep_out_of(pad, config)
    height_m = unseen_height_m(config.chase.height_m, pad, config)
    here, wanted = offset_now(pad, reference, s), np.array([0.0, 0.0, height_m])
    rates = (WAY_SHARE * limits.acceleration_max_m_s2, way_speed_m_s(wanted - here, pad, limits))
    way = way_to(here, wanted, keep_out, pad.offset_s, rates)
    target = over_vehicle(way, StationFrame.NORTH, 0.0, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=floor_beside(pad, keep_out, s))


def climb_aim(
    pad: PadPath, reference: ReferenceState, s: Situation, config: CompanionConfig, *, limits: FlightLimits
) -> Aim:
    """Return the aim of an abort that climbs where it is beside the vehicle, and moves along with it."""
    keep_out = keep_out_now(pad, config)
    here = offset_now(pad, reference, s)
    wanted = keep_outside(np.array([here[0], here[1], max(float(here[2]), config.abort.height_m)]), keep_out)
    rates = (WAY_SHARE * limits.acceleration_max_m_s2, limits.climb_max_m_s)
    way = way_to(here, wanted, keep_out, pad.offset_s, rates)
    target = over_vehicle(way, StationFrame.NORTH, 0.0, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=floor_beside(pad, keep_out, s))


def rally_aim(sortie: SortieMemory, anchor_enu_m: Array, reference: ReferenceState, rally_enu_m: Array | None) -> Aim:
    """Return the aim at where the vehicle is to pass, which it climbs to before it flies there, or at the rally point.

    On the way to the rally point it is no lower than before, and comes down there.

    Args:
        sortie: with the place where the vehicle is to pass.
        anchor_enu_m: (3,) where the drone can stop.
        reference: the virtual model now.
        rally_enu_m: (3,) where the drone is to wait by now; None while it looks for the vehicle.
    """
    here, place = reference.position_enu_m, anchor_enu_m if sortie.place_enu_m is None else sortie.place_enu_m
    if rally_enu_m is not None:
        is_there = math.hypot(*(rally_enu_m - here)[:2].tolist()) < _AT_RALLY_M
        return hover_aim(rally_enu_m if is_there else np.array([*rally_enu_m[:2], max(rally_enu_m[2], place[2])]))
    if float(here[2]) < float(place[2]) - _CLIMB_FIRST_M:
        return hover_aim(np.array([*anchor_enu_m[:2], place[2]]))
    return hover_aim(place)


def rally_point_enu_m(s: Situation, config: CompanionConfig) -> Array | None:
    """Return (3,) where a drone waits that does not find its vehicle; None without such a place."""
    rally, frame = config.sortie.rally_point_deg_m, s.autopilot.frame
    if rally is None or frame is None:
        return None
    latitude_deg, longitude_deg, height_m = rally
    up_m = frame.origin.altitude_m + height_m
    return np.array(local_from_geodetic(frame, math.radians(latitude_deg), math.radians(longitude_deg), up_m))


def rally_point_now(memory: StepMemory, s: Situation, config: CompanionConfig) -> Array | None:
    """Return (3,) the rally point, for a drone that has looked for its vehicle for long enough; None before.

    Nor is one flown to that a vehicle has led the drone out of the range of.
    """
    rally, place = rally_point_enu_m(s, config), memory.sortie.place_enu_m
    place = memory.places.anchor_enu_m if place is None else place
    if rally is None or place is None or (s.monotonic_ns - memory.progress.since_ns) * 1e-9 < config.sortie.expect_s:
        return None
    return rally if math.hypot(*(rally - place)[:2].tolist()) <= config.limits.range_max_m else None
