"""Where a station wants the drone over the horizon, and how fast it may be there; pure.

A new station is reached on a way that is laid from where the drone was when it was told to go. A place moves along the
way, and the drone is led to this place with all that it can. The place does not wait for a drone that falls behind in
a brake or a bend: a way that restarted wherever the drone is would lead it back with `WAY_SHARE` of that.
"""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import Array, FlightLimits
from companion.landing.memory import StepMemory
from companion.landing.over_vehicle import (
    WAY_SHARE,
    floor_beside,
    keep_out_now,
    offset_now,
    over_vehicle,
    way_speed_m_s,
)
from companion.landing.targets import Aim
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from companion.sortie.memory import SortieMemory, Way
from companion.sortie.station import KeepOut, ahead_rad, is_clear, keep_outside, turn_rates_rad_s, turned, way_to
from companion.vehicle.pad import PadPath
from link.records import replace

_STEP_MAX_S = 0.1  # a longer pause does not let the place jump


def advance_way(memory: StepMemory, s: Situation, limits: FlightLimits, config: CompanionConfig) -> StepMemory:
    """Return the memory with the place on the way to the station moved on to this step.

    It begins where the drone is: for a new station, and when the drone has been pushed to where the vehicle is between
    it and its place.
    """
    sortie, reference, pad = memory.sortie, memory.model.reference, s.pad
    if memory.progress.phase is not Phase.FOLLOW or sortie.station is None or reference is None or pad is None:
        return memory if sortie.way is None else replace(memory, sortie=replace(sortie, way=None))
    keep_out, ahead = keep_out_now(pad, config), ahead_rad(sortie.station.frame, pad, sortie.ahead_rad)
    here, way = turned(offset_now(pad, reference, s), -ahead), sortie.way
    if way is None or way.station != sortie.station or not is_clear(here, way.place_m, keep_out):
        way = Way(station=sortie.station, place_m=here, at_ns=s.monotonic_ns)
    dt_s = min((s.monotonic_ns - way.at_ns) * 1e-9, _STEP_MAX_S)
    wanted, keep_out, rates = _ends_at(way, ahead, pad, limits, config)
    place = way_to(way.place_m, wanted, keep_out, np.array([0.0, dt_s]), rates)[-1]
    way = replace(way, place_m=np.asarray(place), at_ns=s.monotonic_ns)
    return replace(memory, sortie=replace(sortie, way=way))


def station_aim(sortie: SortieMemory, pad: PadPath, s: Situation, limits: FlightLimits, config: CompanionConfig) -> Aim:
    """Return the aim that keeps the station, or is on the way to it round the vehicle."""
    if sortie.way is None:
        raise ValueError("nothing is followed without a way to its station")
    frame = sortie.way.station.frame
    ahead = ahead_rad(frame, pad, sortie.ahead_rad)
    wanted, keep_out, rates = _ends_at(sortie.way, ahead, pad, limits, config)
    way = way_to(sortie.way.place_m, wanted, keep_out, pad.offset_s, rates)
    target = over_vehicle(way, frame, ahead, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=floor_beside(pad, keep_out, s))


def _ends_at(
    way: Way, ahead: float, pad: PadPath, limits: FlightLimits, config: CompanionConfig
) -> tuple[Array, KeepOut, tuple[float, float]]:
    """Return the end (3,) of the way, what it leads round, and the acceleration and the speed on it."""
    keep_out = keep_out_now(pad, config)
    wanted = keep_outside(np.array(way.station.offset_m), keep_out)
    speed_m_s = way_speed_m_s(turned(wanted - way.place_m, ahead), pad, limits)
    return wanted, keep_out, (WAY_SHARE * limits.acceleration_max_m_s2, speed_m_s)


def station_speed_m_s(sortie: SortieMemory, s: Situation) -> float:
    """Return how fast over ground the station itself moves: outside in a bend it is faster than the vehicle."""
    if sortie.station is None or s.pad is None:
        return 0.0
    frame = sortie.station.frame
    x, y, _ = turned(np.array(sortie.station.offset_m), ahead_rad(frame, s.pad, sortie.ahead_rad)).tolist()
    east_m_s, north_m_s = s.pad.velocity_enu_m_s[0, :2].tolist()
    rate_rad_s = float(turn_rates_rad_s(frame, s.pad)[0])
    return math.hypot(east_m_s - rate_rad_s * y, north_m_s + rate_rad_s * x)
