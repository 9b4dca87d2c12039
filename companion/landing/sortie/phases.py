"""Initial values of a sortie's phases, and when a sortie begins and ends; pure."""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import Array
from companion.integrity.contradictions import contradicts_itself
from companion.landing.sortie.way_home import home_s
from companion.landing.state.memory import StepMemory
from companion.landing.steering.targets import HORIZON_OFFSETS_S, stopping_point
from companion.situation.phases import FLYING_PHASES, STATION_PHASES, Phase
from companion.situation.situation import Situation
from companion.sortie.memory import SortieMemory
from companion.sortie.station import ahead_rad, turned
from link.messages import Command, Order, Station, StationFrame
from link.records import replace

_LOOK_AHEAD_S = float(HORIZON_OFFSETS_S[-1])  # so far ahead the vehicle is forecast

_OUTWARD = frozenset({Phase.LIFT_OFF, Phase.FOLLOW})
_HOMEWARD = frozenset({Phase.RETURN, Phase.CHASE})


def take_order(sortie: SortieMemory, order: Order) -> SortieMemory:
    """Return the sortie after an accepted order."""
    match order.command:
        case Command.FOLLOW:
            return replace(sortie, is_out=True, station=order.station, was_due=False, stays_out=False)
        case Command.LAUNCH | Command.RETURN:
            return replace(sortie, is_out=True, was_due=False, stays_out=False)
        case Command.HOLD | Command.ABORT:
            return replace(sortie, stays_out=sortie.was_due)
        case Command.START | Command.START_ANYWAY:
            return replace(sortie, was_due=False, stays_out=False)


def begin_phase_of_sortie(
    memory: StepMemory, before: Phase, situation: Situation, config: CompanionConfig
) -> StepMemory:
    """Return the memory with what a sortie's phase needs at its beginning; `before` led to the present one."""
    phase = memory.progress.phase
    if phase in _OUTWARD | _HOMEWARD:
        memory = replace(memory, sortie=replace(memory.sortie, follows=phase in _OUTWARD))
    sortie = memory.sortie
    match phase:
        case Phase.ON_DECK:
            return _without_ground(memory)
        case Phase.FOLLOW if before is Phase.LIFT_OFF:
            over_pad = Station(offset_m=(0.0, 0.0, config.chase.height_m))
            return replace(memory, sortie=replace(sortie, station=over_pad))
        case Phase.RALLY:
            return _to_rally(memory, situation, config)
        case Phase.CHASE if before in STATION_PHASES or sortie.station is not None:
            return _to_land(memory, situation)
        case _ if phase is Phase.TAKEOFF or phase not in FLYING_PHASES:
            return replace(memory, sortie=SortieMemory(battery=sortie.battery))
        case _:
            return memory


def _to_land(memory: StepMemory, situation: Situation) -> StepMemory:
    """Return the memory of a landing that begins here, from where the range counts: home is the vehicle."""
    if situation.drone is None:
        return memory
    places = replace(memory.places, waiting_point_enu_m=situation.drone.position_enu_m)
    return replace(memory, sortie=replace(memory.sortie, station=None), places=places)


def clear_of_vehicle(anchor_enu_m: Array, memory: StepMemory, situation: Situation, config: CompanionConfig) -> Array:
    """Return where a sortie's drone stops: no lower than above the roof that may drive up to it, where it is known."""
    if not memory.sortie.is_out or memory.progress.phase is not Phase.HOLD or contradicts_itself(situation, config):
        return anchor_enu_m
    return np.array([*anchor_enu_m[:2], _clear_up_m(float(anchor_enu_m[2]), situation, config)])


def _clear_up_m(up_m: float, s: Situation, config: CompanionConfig) -> float:
    """Return the height in W of a drone that is above the roof, not below `up_m`."""
    if s.pad is None:
        return up_m
    return max(up_m, float(s.pad.position_enu_m[0, 2]) + s.feet_offset_m + config.chase.height_m)


def _without_ground(memory: StepMemory) -> StepMemory:
    """Return the memory of a drone on the deck: what it has stood on is no ground."""
    vehicle = replace(memory.vehicle, is_road_elsewhere=None)
    return replace(memory, vehicle=vehicle, places=replace(memory.places, ground_enu_m=None))


def over_deck(sortie: SortieMemory, s: Situation, config: CompanionConfig) -> SortieMemory:
    """Return the sortie with its first station, that of the lift-off: over where on the deck the drone stands."""
    if s.approach is None or s.pad is None:
        return sortie
    ahead = ahead_rad(StationFrame.VEHICLE, s.pad, sortie.ahead_rad)
    x, y, _ = turned(np.array(s.approach.position_enu_m), -ahead).tolist()
    station = Station(offset_m=(x, y, config.sortie.launch.clear_height_m))
    return replace(sortie, station=station, ahead_rad=ahead)


def _to_rally(memory: StepMemory, s: Situation, config: CompanionConfig) -> StepMemory:
    """Return the memory with where the vehicle was last forecast to pass when the drone can be there.

    Nobody knows that, nor the roof's height, of a vehicle whose data contradict themselves: the drone stops, and rises
    by as much as clears the vehicle that it was beside.
    """
    reference, pad = memory.model.reference, s.pad
    if reference is None:
        return memory
    anchor, place = stopping_point(reference), None
    if contradicts_itself(s, config):
        clear_m = float(reference.position_enu_m[2]) + config.chase.height_m
        anchor = np.array([*anchor[:2], max(float(anchor[2]), clear_m)])
    elif pad is not None:
        ahead_s = home_s(s, config) - config.limits.landing_time_s
        ahead_s = max(ahead_s if math.isfinite(ahead_s) else 0.0, _LOOK_AHEAD_S)
        way = (pad.position_enu_m[0] + pad.velocity_enu_m_s[0] * ahead_s - reference.position_enu_m)[:2]
        within = min(config.limits.range_max_m / max(math.hypot(*way.tolist()), 1.0), 1.0)
        place = reference.position_enu_m[:2] + within * way
        place = np.array([*place, _clear_up_m(float(reference.position_enu_m[2]), s, config)])
    sortie = replace(memory.sortie, place_enu_m=place, found_since_ns=None)
    return replace(memory, sortie=sortie, places=replace(memory.places, anchor_enu_m=anchor))
