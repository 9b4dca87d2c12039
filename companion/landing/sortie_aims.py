"""Where the phases of a sortie want the drone over the horizon: lift-off, station, way home, rally; pure."""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import Array, FlightLimits
from companion.landing.conditions import is_fix_old
from companion.landing.feasibility import SPEED_SHARE_MIN
from companion.landing.memory import StepMemory
from companion.landing.targets import NO_FLOOR_M, Aim, hover_aim
from companion.planning.guidance import ReferenceState, Target
from companion.situation.phases import STATION_PHASES, Phase
from companion.situation.situation import Situation
from companion.sortie.intercept import closing_speed_m_s
from companion.sortie.memory import SortieMemory
from companion.sortie.station import KeepOut, ahead_rad, turn_rates_rad_s, turned, way_to
from companion.vehicle.pad import PadPath
from link.frames.local_frame import local_from_geodetic
from link.messages import StationFrame
from link.records import replace

WAY_SHARE = 0.3
"""Of the drone's acceleration, for ways against the vehicle; the rest is for following the vehicle."""
SPEED_SHARE = 0.95
"""Of the drone's speed, for the way home; the rest makes up for gusts."""
_BELOW_M = 0.5  # so far below the lowest station the planner's floor is: it is the last thing to be met
_CLIMB_FIRST_M = 1.0  # a drone that is lower than this under its place climbs before it flies there
_AT_RALLY_M = 3.0  # horizontally, as near as a receiver may err: there the drone comes down to the rally point


def keep_out_of(pad: PadPath, config: CompanionConfig) -> KeepOut:
    """Return the cylinder about the vehicle that ways and stations stay out of."""
    sortie = config.sortie
    pad_m = math.sqrt(2.0) * pad.half_width_m if math.isfinite(pad.half_width_m) else 0.0
    return KeepOut(
        radius_m=max(sortie.vehicle_radius_m, pad_m) + sortie.keep_out_margin_m,
        over_m=config.descent.alignment.height_m,
        lowest_m=sortie.ground_clearance_m - pad.height_m,
    )


def sortie_aim(
    memory: StepMemory, reference: ReferenceState, anchor_enu_m: Array, s: Situation, config: CompanionConfig
) -> Aim | None:
    """Return where a phase of a sortie wants the drone, None in any other; without a vehicle it stops at the anchor."""
    phase, sortie, pad = memory.progress.phase, memory.sortie, s.pad
    match phase:
        case Phase.LIFT_OFF if pad is not None:
            return lift_off_aim(sortie, pad, s.feet_offset_m)
        case Phase.FOLLOW if pad is not None:
            return station_aim(sortie, pad, reference, s, config)
        case Phase.RETURN if pad is not None:
            return return_aim(pad, reference, s, config)
        case Phase.ABORT if pad is not None and sortie.station is not None and not is_fix_old(s, config):
            return climb_aim(pad, reference, s, config)
        case Phase.RALLY:
            in_phase_s = (s.monotonic_ns - memory.progress.since_ns) * 1e-9
            return rally_aim(sortie, anchor_enu_m, reference, rally_point_enu_m(in_phase_s, s, config))
        case _:
            return hover_aim(anchor_enu_m) if phase in STATION_PHASES | {Phase.ON_DECK} else None


def lift_off_aim(sortie: SortieMemory, pad: PadPath, feet_offset_m: float) -> Aim:
    """Return the aim that rises from where on the deck the drone stood, moving and turning with the deck."""
    if sortie.station is None:
        raise ValueError("a lift-off has no place on the deck")
    wanted = np.tile(sortie.station.offset_m, (len(pad.offset_s), 1))
    target = _over_vehicle(wanted, sortie.station.frame, sortie.ahead_rad, pad, feet_offset_m)
    return Aim(target=target, floor_enu_m=np.full(len(pad.offset_s), NO_FLOOR_M))


def station_aim(
    sortie: SortieMemory, pad: PadPath, reference: ReferenceState, s: Situation, config: CompanionConfig
) -> Aim:
    """Return the aim that keeps the station, or is on the way to it round the vehicle."""
    if sortie.station is None:
        raise ValueError("nothing is followed without a station")
    frame, limits = sortie.station.frame, _limits(s, config)
    keep_out = keep_out_of(pad, config)
    ahead = ahead_rad(frame, pad, sortie.ahead_rad)
    here, wanted = turned(offset_now(pad, reference, s), -ahead), np.array(sortie.station.offset_m)
    rates = (WAY_SHARE * limits.acceleration_max_m_s2, _closing_m_s(turned(wanted - here, ahead), pad, limits))
    way = way_to(here, wanted, keep_out, pad.offset_s, rates)
    target = _over_vehicle(way, frame, ahead, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=_floor(pad, keep_out, s))


def station_speed_m_s(sortie: SortieMemory, s: Situation) -> float:
    """Return how fast over ground the station itself moves: outside in a bend it is faster than the vehicle."""
    if sortie.station is None or s.pad is None:
        return 0.0
    frame = sortie.station.frame
    x, y, _ = turned(np.array(sortie.station.offset_m), ahead_rad(frame, s.pad, sortie.ahead_rad)).tolist()
    east_m_s, north_m_s = s.pad.velocity_enu_m_s[0, :2].tolist()
    rate_rad_s = float(turn_rates_rad_s(frame, s.pad)[0])
    return math.hypot(east_m_s - rate_rad_s * y, north_m_s + rate_rad_s * x)


def limit_phase_rates(limits: FlightLimits, carried: FlightLimits, memory: StepMemory, s: Situation) -> FlightLimits:
    """Return the limits of a plan, for an autopilot that carries setpoints on.

    On the way home and to a rally it is high, above all that being carried on could meet. A station may be faster than
    the vehicle, by whose speed all else is bounded.

    Args:
        limits: of the drone.
        carried: and of what may be carried on beside the vehicle.
        memory: with the phase and the station.
        s: the facts.
    """
    phase = memory.progress.phase
    if phase in (Phase.RETURN, Phase.RALLY):
        return limits
    if phase is not Phase.FOLLOW:
        return carried
    speed_m_s = SPEED_SHARE_MIN * station_speed_m_s(memory.sortie, s)
    return replace(carried, speed_max_m_s=min(limits.speed_max_m_s, max(carried.speed_max_m_s, speed_m_s)))


def return_aim(pad: PadPath, reference: ReferenceState, s: Situation, config: CompanionConfig) -> Aim:
    """Return the aim on the straight way to above the vehicle, wherever that drives."""
    limits, keep_out = _limits(s, config), keep_out_of(pad, config)
    here, wanted = offset_now(pad, reference, s), np.array([0.0, 0.0, config.chase.height_m])
    rates = (WAY_SHARE * limits.acceleration_max_m_s2, _closing_m_s(wanted - here, pad, limits))
    way = way_to(here, wanted, keep_out, pad.offset_s, rates)
    target = _over_vehicle(way, StationFrame.NORTH, 0.0, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=_floor(pad, keep_out, s))


def climb_aim(pad: PadPath, reference: ReferenceState, s: Situation, config: CompanionConfig) -> Aim:
    """Return the aim of an abort that climbs where it is beside the vehicle, and moves along with it."""
    limits, keep_out = _limits(s, config), keep_out_of(pad, config)
    here = offset_now(pad, reference, s)
    wanted = np.array([here[0], here[1], max(float(here[2]), config.abort.height_m)])
    rates = (WAY_SHARE * limits.acceleration_max_m_s2, limits.climb_max_m_s)
    way = way_to(here, wanted, keep_out, pad.offset_s, rates)
    target = _over_vehicle(way, StationFrame.NORTH, 0.0, pad, s.feet_offset_m)
    return Aim(target=target, floor_enu_m=_floor(pad, keep_out, s))


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


def rally_point_enu_m(in_phase_s: float, s: Situation, config: CompanionConfig) -> Array | None:
    """Return (3,) where a drone waits that has looked for its vehicle for long enough; None before, or without one."""
    rally, frame = config.sortie.rally_point_deg_m, s.autopilot.frame
    if rally is None or frame is None or in_phase_s < config.sortie.expect_s:
        return None
    latitude_deg, longitude_deg, height_m = rally
    up_m = frame.origin.altitude_m + height_m
    return np.array(local_from_geodetic(frame, math.radians(latitude_deg), math.radians(longitude_deg), up_m))


def offset_now(pad: PadPath, reference: ReferenceState, s: Situation) -> Array:
    """Return (3,) of the virtual model's feet from the pad's centre, in W."""
    offset = reference.position_enu_m - pad.position_enu_m[0]
    return np.asarray(offset - np.array([0.0, 0.0, s.feet_offset_m]))


def _limits(s: Situation, config: CompanionConfig) -> FlightLimits:
    return config.limits.flight_limits() if s.limits is None else s.limits


def _closing_m_s(way_m: Array, pad: PadPath, limits: FlightLimits) -> float:
    speed_m_s = closing_speed_m_s(way_m[:2], pad.velocity_enu_m_s[0, :2], SPEED_SHARE * limits.speed_max_m_s)
    return max(speed_m_s, limits.descent_max_m_s)  # a way up or down is one, too


def _floor(pad: PadPath, keep_out: KeepOut, s: Situation) -> Array:
    return np.asarray(pad.position_enu_m[:, 2] + s.feet_offset_m + min(keep_out.lowest_m, keep_out.over_m) - _BELOW_M)


def _over_vehicle(way: Array, frame: StationFrame, ahead: float, pad: PadPath, feet_offset_m: float) -> Target:
    """Return the target of offsets (n, 3) that move and turn with the vehicle.

    Args:
        way: ahead, left and up of the pad's centre.
        frame: that it turns with.
        ahead: where ahead is now, rad.
        pad: its path.
        feet_offset_m: of the reported position above the feet.
    """
    offset_s = pad.offset_s
    rates = turn_rates_rad_s(frame, pad)
    steps = np.diff(offset_s)
    angles = ahead + np.concatenate(([0.0], np.cumsum(0.5 * (rates[:-1] + rates[1:]) * steps)))
    c, s = np.cos(angles), np.sin(angles)
    arm = np.column_stack((c * way[:, 0] - s * way[:, 1], s * way[:, 0] + c * way[:, 1]))
    across = np.column_stack((-arm[:, 1], arm[:, 0]))
    moved = np.gradient(way, offset_s, axis=0)
    turned_moved = np.column_stack((c * moved[:, 0] - s * moved[:, 1], s * moved[:, 0] + c * moved[:, 1]))
    position, velocity = pad.position_enu_m.copy(), pad.velocity_enu_m_s.copy()
    acceleration = pad.acceleration_enu_m_s2.copy()
    position[:, :2] += arm
    position[:, 2] += way[:, 2] + feet_offset_m
    velocity[:, :2] += turned_moved + rates[:, None] * across
    velocity[:, 2] += moved[:, 2]
    acceleration[:, :2] -= (rates**2)[:, None] * arm
    return Target(
        offset_s=offset_s,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
    )
