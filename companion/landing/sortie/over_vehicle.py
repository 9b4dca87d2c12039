"""Places relative to the vehicle as the planner takes them, and the cylinder about the vehicle; pure."""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.config.sortie import LaunchConfig
from companion.core.data import Array, FlightLimits
from companion.core.reasons import Cause, Reason
from companion.planning.guidance import ReferenceState, Target
from companion.situation.situation import Drone, Situation
from companion.sortie.memory import SortieMemory
from companion.sortie.station import KeepOut, closing_speed_m_s, turn_rates_rad_s, turned
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import placed_std_m
from link.messages import StationFrame

WAY_SHARE = 0.3
"""Of the drone's acceleration, for ways against the vehicle; the rest is for following the vehicle."""
SPEED_SHARE = 0.95
"""Of the drone's speed, for the way home; the rest makes up for gusts."""
_STDS = 2.0
_CARRIED_M_S = 3.0  # who carries a drone beside a vehicle walks
_TOGETHER_M_S = 1.5  # against it: of receivers without corrections each errs by some decimetres a second
ON_ROOF_M = 1.0
"""So far above or below the pad a drone may seem to be that stands on the vehicle: the road is farther below."""
_BELOW_M = 0.5  # so far below the lowest station the planner's floor is: it is the last thing to be met


def keep_out_of(pad: PadPath, config: CompanionConfig, *, stds: float = 0.0) -> KeepOut:
    """Return the cylinder about the vehicle that ways and stations stay out of.

    Its antenna is on the vehicle, too, which reaches from the pad's centre as far. Without a heading the path is
    the antenna's, and the pad may be at the end of the lever arm on any side of it.

    Args:
        pad: with its standard deviation.
        config: radius, margins and heights.
        stds: by so many standard deviations of the pad's place the vehicle may be nearer, higher or lower.
    """
    sortie = config.sortie
    pad_m = math.sqrt(2.0) * pad.half_width_m if math.isfinite(pad.half_width_m) else 0.0
    east_m, north_m, up_m = (stds * placed_std_m(pad)).tolist()
    arm_m, reaches_m = pad.mounting.arm_m, max(sortie.vehicle_radius_m, pad_m, pad.mounting.arm_m)
    unsure_m = max(east_m, north_m) + (arm_m if pad.yaw_rad is None else 0.0)
    return KeepOut(
        radius_m=reaches_m + sortie.keep_out_margin_m + unsure_m,
        over_m=config.descent.alignment.height_m + up_m,
        lowest_m=sortie.ground_clearance_m - pad.height_m + up_m,
    )


def keep_out_now(pad: PadPath, config: CompanionConfig) -> KeepOut:
    """Return the cylinder that the drone stays out of, as surely as the vehicle's place is known now."""
    return keep_out_of(pad, config, stds=config.sortie.keep_out_stds)


def over_vehicle(way: Array, frame: StationFrame, ahead: float, pad: PadPath, feet_offset_m: float) -> Target:
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
    # Towards the pad's centre, and of moving in what turns (Coriolis). What a turn adds that begins or ends is left
    # out, for a forecast's rate of turn is too rough for its derivative, which an arm of 7 m would multiply.
    acceleration[:, :2] -= (rates**2)[:, None] * arm
    acceleration[:, :2] += 2.0 * rates[:, None] * np.column_stack((-turned_moved[:, 1], turned_moved[:, 0]))
    return Target(
        offset_s=offset_s,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
    )


def turns_too_fast(offset_m: Array, frame: StationFrame, ahead: float, pad: PadPath, limits: FlightLimits) -> bool:
    """Return whether a place (3,) that turns with the vehicle moves faster, or on a tighter curve, than the drone can.

    Where the vehicle turns at the rate w, the place at the arm r moves by w x r and is drawn in by w^2 r beside it.
    """
    rate_rad_s, arm_m = float(turn_rates_rad_s(frame, pad)[0]), math.hypot(*offset_m[:2].tolist())
    is_faster = place_speed_m_s(offset_m, frame, ahead, pad) > max(limits.speed_max_m_s, pad.ground_speed_m_s)
    return is_faster or rate_rad_s**2 * arm_m > limits.acceleration_max_m_s2


def place_speed_m_s(offset_m: Array, frame: StationFrame, ahead: float, pad: PadPath) -> float:
    """Return how fast over ground a place (3,) moves that turns with the vehicle: outside in a bend it is faster."""
    rate_rad_s = float(turn_rates_rad_s(frame, pad)[0])
    x, y, _ = turned(offset_m, ahead).tolist()
    east_m_s, north_m_s = pad.velocity_enu_m_s[0, :2].tolist()
    return math.hypot(east_m_s - rate_rad_s * y, north_m_s + rate_rad_s * x)


def offset_now(pad: PadPath, reference: ReferenceState, s: Situation) -> Array:
    """Return (3,) of the virtual model's feet from the pad's centre, in W."""
    offset = reference.position_enu_m - pad.position_enu_m[0]
    return np.asarray(offset - np.array([0.0, 0.0, s.feet_offset_m]))


def way_speed_m_s(way_m: Array, pad: PadPath, limits: FlightLimits) -> float:
    """Return how fast the drone can follow a way (3,) against the vehicle: neither part of it outruns its limit."""
    level_m, up_m = math.hypot(*way_m[:2].tolist()), float(way_m[2])
    level_m_s = closing_speed_m_s(way_m[:2], pad.velocity_enu_m_s[0, :2], SPEED_SHARE * limits.speed_max_m_s)
    upright_m_s = limits.climb_max_m_s if up_m > 0.0 else limits.descent_max_m_s
    parts = [(m, m_s) for m, m_s in ((level_m, level_m_s), (abs(up_m), upright_m_s)) if m > 0.0]
    return min((math.hypot(level_m, up_m) * m_s / m for m, m_s in parts), default=0.0)


def floor_beside(pad: PadPath, keep_out: KeepOut, s: Situation) -> Array:
    """Return the planner's floor (n,) in W beside the vehicle or over it, the lower of both."""
    return np.asarray(pad.position_enu_m[:, 2] + s.feet_offset_m + min(keep_out.lowest_m, keep_out.over_m) - _BELOW_M)


def _deck_motions(drone: Drone, pad: PadPath, config: LaunchConfig) -> tuple[tuple[str, float, float], ...]:
    """Return what is told of each motion that a quiet deck has little of, how much it is and how much it may be."""
    climb_m_s = abs(float(drone.velocity_enu_m_s[2]) - _road_climb_m_s(pad))
    changes_m_s2 = math.hypot(*pad.acceleration_enu_m_s2[0, :2].tolist())
    return (
        ("leans by {:.2f} rad, quiet_tilt_max_rad is {:g}", math.asin(min(drone.lean, 1.0)), config.quiet_tilt_max_rad),
        ("rises or sinks at {:.1f} m/s, quiet_climb_max_m_s is {:g}", climb_m_s, config.quiet_climb_max_m_s),
        (
            "brakes, speeds up or turns with {:.1f} m/s^2, quiet_acceleration_max_m_s2 is {:g}",
            changes_m_s2,
            config.quiet_acceleration_max_m_s2,
        ),
    )


def is_deck_quiet(s: Situation, config: LaunchConfig) -> bool:
    """Return whether the deck is level, neither rises nor sinks, and the vehicle drives evenly."""
    if s.drone is None or s.pad is None:
        return False
    return all(value <= most for _, value, most in _deck_motions(s.drone, s.pad, config))


def tell_restless(s: Situation, config: LaunchConfig) -> Cause:
    """Return that the deck was never quiet for long enough, and what it does now that a quiet one does not."""
    does = "is quiet for a moment only"
    if s.drone is not None and s.pad is not None:
        motions = _deck_motions(s.drone, s.pad, config)
        does = next((told.format(value, most) for told, value, most in motions if value > most), does)
    return Cause(Reason.DECK_RESTLESS, (config.time_limit_s, does))


def shall_motors_turn(sortie: SortieMemory, s: Situation, config: LaunchConfig) -> bool | None:
    """Return whether a quiet deck is to be left, or motors that have idled on it for long to stop; None for neither.

    An autopilot that stops them by itself ends the launch, since a person may have done so as well.
    """
    if _lasts(sortie.idles_since_ns, s, config.idle_max_s):
        return False
    return True if _lasts(sortie.quiet_since_ns, s, config.quiet_hold_s) else None


def _lasts(since_ns: int | None, s: Situation, least_s: float) -> bool:
    return since_ns is not None and (s.monotonic_ns - since_ns) * 1e-9 >= least_s


def _road_climb_m_s(pad: PadPath) -> float:
    """Return how fast the road rises by its grade, which is no heave."""
    velocity = pad.velocity_enu_m_s[0, :2]
    if pad.yaw_rad is None:
        return pad.grade * pad.ground_speed_m_s
    return pad.grade * float(velocity @ np.array([math.cos(pad.yaw_rad), math.sin(pad.yaw_rad)]))


def stands_on_deck(s: Situation, distance_max_m: float, height_max_m: float) -> bool:
    """Return whether the drone is on the vehicle: there by both places, or carried along by it.

    Between receivers without corrections lie metres, but what stands and moves with a vehicle stands on it.
    """
    a = s.approach
    if a is None or s.pad is None:
        return False
    if a.distance_m < distance_max_m and abs(a.height_m) < height_max_m:
        return True
    stands = not s.autopilot.armed or s.autopilot.landed is True
    moves_m_s = s.pad.ground_speed_m_s
    east_m, north_m, up_m = (_STDS * s.pad.position_std_m[0]).tolist()
    may_be_there = a.distance_m < distance_max_m + max(east_m, north_m) and abs(a.height_m) < height_max_m + up_m
    return stands and may_be_there and moves_m_s > _CARRIED_M_S and a.speed_m_s < _TOGETHER_M_S
