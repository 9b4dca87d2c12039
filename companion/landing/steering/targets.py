"""Where each phase wants the drone over the horizon, and how low it may go; pure numerics in W.

All heights of the drone are of the point whose position the autopilot reports; `feet_offset_m` below it are
its feet, which stand on the pad after the landing.
"""

import math

import numpy as np
from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.config.descent import DescentConfig
from companion.config.planning import GuidanceKind, LandingStyle
from companion.core.data import Array, FlightLimits
from companion.landing.steering.following_height import chase_floor_m, chase_height_m, clear_height_m
from companion.planning.descent_path import descent_path
from companion.planning.guidance import ReferenceState, Target
from companion.situation.phases import Phase
from companion.vehicle.pad import PadPath

HORIZON_OFFSETS_S: Array = np.arange(0.0, 4.01, 0.2)
NO_FLOOR_M = -1e4
_AT_REST: Array = np.zeros((len(HORIZON_OFFSETS_S), 3))
_NO_FLOOR: Array = np.full(len(HORIZON_OFFSETS_S), NO_FLOOR_M)
_DESCENT_SHARE = 0.5  # of the vertical acceleration; the rest is for following the pad
_DESCENT_JERK_MAX_M_S3 = 10.0  # that acceleration within 0.15 s: sooner brings nothing, and who has less needs it all
_SHORT_SHARE = 0.5  # of the distance at which the alignment begins: a chase that aims shorter might not come there
_BRAKING_M_S2 = 2.0  # of a drone that stops where it is
_REST_M = 0.005
_REST_MOTION = 0.01  # m/s and m/s^2


class Aim(Struct, frozen=True, kw_only=True, eq=False):
    """What the planner is given: the target and its floor (n,), as `PlanRequest` has them."""

    target: Target
    floor_enu_m: Array
    touched_enu_m: Array | None = None
    is_hover: bool = False


def hover_aim(point_enu_m: Array) -> Aim:
    """Return the aim that stays at `point_enu_m` (3,)."""
    position = np.empty_like(_AT_REST)
    position[:] = point_enu_m
    target = Target(
        offset_s=HORIZON_OFFSETS_S,
        position_enu_m=position,
        velocity_enu_m_s=_AT_REST,
        acceleration_enu_m_s2=_AT_REST,
    )
    return Aim(target=target, floor_enu_m=_NO_FLOOR, is_hover=True)


def is_at_rest(reference: ReferenceState, aim: Aim) -> bool:
    """Return whether the virtual model hovers where the aim wants it for the whole horizon."""
    if not aim.is_hover:
        return False
    off = _largest(reference.position_enu_m - aim.target.position_enu_m[0])
    moving = _largest(reference.velocity_enu_m_s) + _largest(reference.acceleration_enu_m_s2)
    return off < _REST_M and moving < _REST_MOTION


def _largest(vector: Array) -> float:
    return float(max(map(abs, vector.tolist())))


def stopping_point(reference: ReferenceState) -> Array:
    """Return (3,) where the virtual model comes to rest when it brakes evenly, horizontally and vertically apart.

    Along the velocity as a whole a fast flight with a little sink would end metres lower.
    """
    velocity = reference.velocity_enu_m_s
    horizontal_m_s, vertical_m_s = math.hypot(*velocity[:2].tolist()), abs(float(velocity[2]))
    speed = np.array([horizontal_m_s, horizontal_m_s, vertical_m_s])
    return np.asarray(reference.position_enu_m + velocity * speed / (2.0 * _BRAKING_M_S2))


def pad_aim(
    phase: Phase,
    pad: PadPath,
    reference: ReferenceState,
    feet_offset_m: float,
    config: CompanionConfig,
    *,
    limits: FlightLimits,
    lowest_m: float | None = None,
) -> Aim:
    """Return the aim that follows the pad as `phase` (chase, align, descend, touchdown or abort) asks.

    Args:
        phase: one of those.
        pad: its path over the horizon.
        reference: the virtual model now.
        feet_offset_m: of the reported position above the feet.
        config: heights and rates.
        limits: of the flight.
        lowest_m: of the feet above the pad, where a descent waits; None for one that goes on.
    """
    if phase in (Phase.DESCEND, Phase.TOUCHDOWN):
        state = (
            float(reference.position_enu_m[2] - pad.position_enu_m[0, 2]) - feet_offset_m,
            float(reference.velocity_enu_m_s[2] - pad.velocity_enu_m_s[0, 2]),
            float(reference.acceleration_enu_m_s2[2] - pad.acceleration_enu_m_s2[0, 2]),
        )
        if config.guidance.kind is not GuidanceKind.MPC:
            state = _without_preview(state, config.descent, lowest_m)
        height, rate, acceleration = way_down(state, pad.offset_s, limits, config.descent, lowest_m)
    else:
        height, rate, acceleration = _height_m(phase, pad, reference, config), 0.0, 0.0
    position, velocity, accelerated = (
        path.copy() for path in (pad.position_enu_m, pad.velocity_enu_m_s, pad.acceleration_enu_m_s2)
    )
    if phase is Phase.CHASE and config.guidance.style is LandingStyle.STAGED:
        position[:, :2] += _short_enu_m(pad, reference, config)
    position[:, 2] += feet_offset_m + height
    velocity[:, 2] += rate
    accelerated[:, 2] += acceleration
    target = Target(
        offset_s=pad.offset_s,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=accelerated,
    )
    floor = pad.position_enu_m[:, 2] + feet_offset_m + _clearance_m(phase, pad, config)
    touched = _touched_enu_m(pad, height, target, feet_offset_m, config) if phase is Phase.DESCEND else None
    return Aim(target=target, floor_enu_m=floor, touched_enu_m=touched)


def _touched_enu_m(
    pad: PadPath, height_m: Array, target: Target, feet_offset_m: float, config: CompanionConfig
) -> Array:
    """Return (n,) the bound of a descent, as `PlanRequest` has it, by which the plan sinks onto the pad gently.

    It looks ahead to a deck that comes up faster than the drone can follow once it does. Where the way down goes on
    below the pad, so that the contact is firm, it may sink as that does.
    """
    time_s = config.guidance.mpc.touch_time_s
    sinks_m_s = pad.velocity_enu_m_s[:, 2] - config.touchdown.sink_max_m_s
    bound = pad.position_enu_m[:, 2] + feet_offset_m + time_s * sinks_m_s
    presses = target.position_enu_m[:, 2] + time_s * target.velocity_enu_m_s[:, 2]
    return np.where(height_m < 0.0, np.minimum(bound, presses), bound)


def _short_enu_m(pad: PadPath, reference: ReferenceState, config: CompanionConfig) -> Array:
    """Return (2,) by how far a chase aims short of the pad: it may be that much nearer than it is said to be.

    What is then seen to be farther away is reached a moment later; for what is nearer there may be no jerk left.
    """
    off = reference.position_enu_m[:2] - pad.position_enu_m[0, :2]
    short_m = min(float(np.max(pad.position_std_m[0, :2])), _SHORT_SHARE * config.descent.alignment.begin_distance_m)
    return np.asarray(off * (short_m / max(math.hypot(*off.tolist()), short_m, _REST_M)))


def _without_preview(
    state: tuple[float, float, float], descent: DescentConfig, lowest_m: float | None
) -> tuple[float, float, float]:
    """Return height, rate and acceleration for a law that looks at the present alone: the rate that is wanted there."""
    wanted_m_s = max(descent.sink.gain_hz * state[0], descent.sink.contact_rate_m_s)
    sinks = lowest_m is None or state[0] > lowest_m
    return state[0], -min(wanted_m_s, descent.sink.rate_max_m_s) if sinks else 0.0, 0.0


def way_down(
    state: tuple[float, float, float],
    offset_s: Array,
    limits: FlightLimits,
    descent: DescentConfig,
    lowest_m: float | None = None,
) -> Array:
    """Return height over the pad, its rate and its acceleration (3, n) of a descent that the virtual model can fly.

    Args:
        state: height, rate and acceleration now.
        offset_s: (n,) after now, rising.
        limits: of the flight.
        descent: its rates.
        lowest_m: where it waits; None for one that goes on, to below the pad.
    """
    lowest_m = -descent.sink.press_depth_m if lowest_m is None else lowest_m
    most_m_s2 = _DESCENT_SHARE * limits.vertical_acceleration_max_m_s2
    if not _brakes_in_time(state, most_m_s2, descent.sink.contact_rate_m_s):
        most_m_s2 = limits.vertical_acceleration_max_m_s2
    return descent_path(
        state,
        (descent.sink.gain_hz, descent.sink.rate_max_m_s, descent.sink.contact_rate_m_s, lowest_m),
        (most_m_s2, min(limits.vertical_jerk_max_m_s3, _DESCENT_JERK_MAX_M_S3)),
        offset_s,
    )


def _brakes_in_time(state: tuple[float, float, float], most_m_s2: float, contact_m_s: float) -> bool:
    """Return whether `most_m_s2` brakes the sink in time for the contact; a road that begins to climb takes more."""
    height_m, rate_m_s, _ = state
    return rate_m_s >= -contact_m_s or rate_m_s**2 - contact_m_s**2 <= 2.0 * most_m_s2 * max(height_m, 0.0)


def _height_m(phase: Phase, pad: PadPath, reference: ReferenceState, config: CompanionConfig) -> float:
    """Return the wanted height over the pad of a phase that does not land."""
    match phase:
        case Phase.ABORT:
            return clear_height_m(config.abort.height_m, pad, config) + pad.crest_above_m
        case Phase.ALIGN:
            return config.descent.alignment.height_m + pad.frame_offset.higher_m
        case _ if config.guidance.style is LandingStyle.DIRECT:
            return 0.0
        case _:
            return chase_height_m(pad, reference, config)


def _clearance_m(phase: Phase, pad: PadPath, config: CompanionConfig) -> float:
    """Return how far the feet stay above where the pad is said to be: nothing where it is to be touched."""
    match phase:
        case Phase.DESCEND | Phase.TOUCHDOWN:
            return NO_FLOOR_M
        case Phase.CHASE if config.guidance.style is LandingStyle.DIRECT:
            return NO_FLOOR_M
        case Phase.ALIGN:
            return 0.6 * config.descent.alignment.height_m + pad.frame_offset.higher_m
        case _:
            return chase_floor_m(config) + pad.frame_offset.higher_m
