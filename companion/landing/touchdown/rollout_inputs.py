"""What the rollouts of a descent begin with, from a step's facts: course, drone, rules, and what may be wrong; pure."""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import ATTITUDE_LAG_S, DRAG_PER_S, STATES, ResponseModel
from companion.config.companion import CompanionConfig
from companion.core.data import Array, Mixture, VehicleEstimate
from companion.forecast.draws import MODE, STEPS_MAX, Draws
from companion.forecast.samples import DT_S, Course, Follower, Rules
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.steering.targets import way_down
from companion.landing.touchdown.levelling import level_end
from companion.situation.situation import Approach, Situation
from companion.vehicle.hindsight import Driving
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import cone_radius_at_pad_m, frames_apart_m2, over_pad_radius_m

_OFFSETS_S = DT_S * np.arange(STEPS_MAX, dtype=np.float64)
_BELOW_M = -0.4  # to where the way down is followed: heights are not off by more
_REPORT_AGE_MAX_S = 0.25
# Of a short wait: it stops and sinks anew meanwhile, which takes as long again. Then the contact comes a second later.
_WAITS_MAX_S = 0.5
_WAITS_STEPS = math.ceil(_WAITS_MAX_S / DT_S)
_SLOW_M_S = 0.3  # slower than this a vehicle has no direction but its heading
_SLOPE_FROM_M_S = 1.0  # from here on a vertical speed tells the grade
_PLACE_STD_MIN_M = 0.02  # of a receiver with corrections
_CHANGE_S = 0.1  # between two changes of speed that `Driving` keeps
_PRIOR_DRIVEN_S = 2.0  # what the estimator believes of drivers counts as one such change, which is over 2 s
_OWN_HEIGHT_STD_M = 0.05  # of the drone's height beside the vehicle's: receivers with corrections, or a range finder
_OWN_CLIMB_STD_M_S = 0.1  # of its rate, gusts included
# What a deck's velocity turns out to be sooner than this before the contact the drone makes up for: setpoints and data
# are late by 0.15 s, and half of the vertical acceleration is there after another 0.15 s.
_CLIMB_FOLLOWED_S = 0.5
# Lag with which an acceleration is believed: velocities at 10 Hz show a brake in 0.3 s, an accelerometer at once.
_BELIEVES_S, _BELIEVES_BY_SENSOR_S = 0.3, 0.1
_BANDWIDTH_TIMES = 4.0  # rest to rest in a time is what a linear law of this over that time takes
_SENSOR_HOLD_NS = 1_000_000_000


class WayDown(Struct, frozen=True, kw_only=True, eq=False):
    """The planned descent, without a wait: (m,) times from now; (3, m) height, rate and acceleration over the pad."""

    offset_s: Array
    path: Array

    @property
    def lasts_s(self) -> float:
        """How long it takes at most, with the longest wait."""
        return float(self.offset_s[-1])


class Errors(Struct, frozen=True, kw_only=True, eq=False):
    """What may be wrong in each of n samples: as `samples.Samples` has it, and how late a setpoint is, in deviations.

    Attributes:
        vehicle: (n, 3, 2).
        deviation: (n, 4, 2).
        vertical: (n, 2).
        late: (n,) standard normal.
    """

    vehicle: Array
    deviation: Array
    vertical: Array
    late: Array


def way_to_contact(memory: StepMemory, situation: Situation, config: CompanionConfig) -> WayDown | None:
    """Return the descent of a drone that goes on, None of one that has farther to go than is looked ahead."""
    reference, pad, relative = memory.model.reference, situation.pad, situation.approach
    if reference is None or pad is None or relative is None:
        return None
    climbs_m_s2 = float(reference.acceleration_enu_m_s2[2] - pad.acceleration_enu_m_s2[0, 2])
    state = (relative.height_m, relative.climb_m_s, climbs_m_s2)
    limits = situation.limits or config.limits.flight_limits()
    path = way_down(state, _OFFSETS_S, limits, config.descent)
    below = np.flatnonzero(path[0, : STEPS_MAX - _WAITS_STEPS] < _BELOW_M)
    if not len(below):
        return None
    count = int(below[0]) + 1 + _WAITS_STEPS
    return WayDown(offset_s=_OFFSETS_S[:count], path=path[:, :count].copy())


def deviation_now(memory: StepMemory, inputs: StepInputs, pad: PadPath) -> Array:
    """Return the cascade's state (4, 2) now, its lean that beyond what the pad's own acceleration takes."""
    tracking, reference = memory.model.tracking, memory.model.reference
    if reference is None or inputs.response is None:
        raise ValueError("no autopilot flies")
    state, leans_m_s2 = np.zeros((STATES, 2)), reference.acceleration_enu_m_s2[:2]
    is_led = inputs.response.cascade.is_led
    if tracking.compared_ns is not None:
        late_s = (inputs.monotonic_ns - tracking.compared_ns) * 1e-9
        state = inputs.response.carry(tracking.deviation, min(late_s, _REPORT_AGE_MAX_S))
    elif not is_led:
        state[2] = leans_m_s2
    if is_led:
        state[2] += leans_m_s2
    state[2] -= pad.acceleration_enu_m_s2[0, :2]
    return state


def course_of(memory: StepMemory, relative: Approach, pad: PadPath, way: WayDown, deviation: Array) -> Course:
    """Return what is expected: the pad as it is forecast, and the virtual model beside it."""
    reference = memory.model.reference
    if reference is None:
        raise ValueError("nothing is flown")
    velocity = _at(way.offset_s, pad, pad.velocity_enu_m_s)
    acceleration = _at(way.offset_s, pad, pad.acceleration_enu_m_s2)
    speed_m_s = np.hypot(velocity[:, 0], velocity[:, 1])
    heading_rad = 0.0 if pad.yaw_rad is None else pad.yaw_rad
    ahead = np.array([math.cos(heading_rad), math.sin(heading_rad)])
    moves = speed_m_s > _SLOW_M_S
    direction = np.where(moves[:, None], velocity[:, :2] / np.maximum(speed_m_s, _SLOW_M_S)[:, None], ahead)
    grade = float(velocity[0, 2]) / float(speed_m_s[0]) if speed_m_s[0] > _SLOPE_FROM_M_S else 0.0
    model = np.empty((3, 2))
    model[0] = np.array(relative.position_enu_m[:2]) - deviation[0]
    model[1] = np.array(relative.velocity_enu_m_s[:2]) - deviation[1]
    model[2] = reference.acceleration_enu_m_s2[:2] - acceleration[0, :2]
    return Course(
        direction=direction,
        speed_m_s=speed_m_s,
        along_m_s2=direction[:, 0] * acceleration[:, 0] + direction[:, 1] * acceleration[:, 1],
        left_m_s2=direction[:, 0] * acceleration[:, 1] - direction[:, 1] * acceleration[:, 0],
        way_down=way.path,
        slope=grade * direction + (0.0 if pad.swing is None else _at(way.offset_s, pad, pad.swing.slope)),
        shake_enu=_shake_at(way.offset_s, pad),
        air_enu_m_s2=memory.model.tracking.air_enu_m_s2.copy(),
        model=model,
    )


def _at(offset_s: Array, pad: PadPath, values: Array) -> Array:
    """Return `values` (n, k) of the pad's path at other offsets, (m, k)."""
    return np.column_stack([np.interp(offset_s, pad.offset_s, column) for column in values.T])


def _shake_at(offset_s: Array, pad: PadPath) -> Array:
    """Return place and velocity of the pad's swing that is not followed, (2, m, 2)."""
    if pad.swing is None:
        return np.zeros((2, len(offset_s), 2))
    return np.stack([_at(offset_s, pad, values) for values in pad.swing.shake_enu[:2]])


def draw_errors(then: VehicleEstimate, pad: PadPath, response: ResponseModel, numbers: Draws) -> Errors:
    """Return what may be wrong.

    Args:
        then: the vehicle at its newest datum.
        pad: now; where its place is known less well than the antenna's, that is the heading's.
        response: of the autopilot.
        numbers: random ones.
    """
    normals = numbers.normals
    vehicle = _draw_vehicle(then, pad, normals[:, :9], numbers.uniforms[:, MODE])
    heaves_m_s = 0.0 if pad.swing is None else np.interp(_CLIMB_FOLLOWED_S, pad.offset_s, pad.swing.climb_std_m_s)
    own = normals[:, 17:19] * np.array([_OWN_HEIGHT_STD_M, math.hypot(_OWN_CLIMB_STD_M_S, heaves_m_s)])
    return Errors(
        vehicle=np.ascontiguousarray(vehicle.reshape(-1, 3, 3)[:, :, :2]),
        deviation=np.einsum("ij,njk->nik", _root(response.covariance), normals[:, 9:17].reshape(-1, STATES, 2)),
        vertical=own - np.column_stack([vehicle[:, 2], -vehicle[:, 5]]),
        late=normals[:, 19],
    )


def _draw_vehicle(then: VehicleEstimate, pad: PadPath, normals: Array, uniforms: Array) -> Array:
    """Return how far place, velocity and acceleration (n, 9) are off, each sample drawn from one of the models.

    A model that is hardly likely holds for few samples. As a part of one covariance it would widen them all.
    """
    mixture = then.mixture
    if mixture is None:
        mixture = Mixture(weight=np.ones(1), off=np.zeros((1, 9)), covariance=then.covariance[None])
    apart_m2 = frames_apart_m2(pad)
    # By so much is the pad's place less well known than the antenna's.
    turned_m2 = np.maximum(pad.position_std_m[0] ** 2 - then.covariance.diagonal()[:3], 0.0)
    of_model = np.searchsorted(np.cumsum(mixture.weight)[:-1], uniforms)
    vehicle = np.empty_like(normals)
    for model, (off, stated) in enumerate(zip(mixture.off, mixture.covariance, strict=True)):
        covariance = stated.copy()
        for axis in range(3):
            stated_m2 = covariance[axis, axis] + turned_m2[axis]
            covariance[axis, axis] = max(stated_m2 - apart_m2, _PLACE_STD_MIN_M**2)
        drawn = of_model == model
        vehicle[drawn] = off + normals[drawn] @ _root(covariance).T
    return vehicle


def as_driven(vehicle: Array, driving: Driving, direction: Array, *, stands: bool) -> Array:
    """Return what the vehicle may be off its estimate with what is known of how it is driven.

    One that stands has neither a velocity nor an acceleration until it departs. One that drives is as uneven along its
    way as it has been, rather than as the estimator takes all drivers to be.

    Args:
        vehicle: (n, 3, 2) as `Errors` has it.
        driving: the last 15 s.
        direction: (2,) unit vector along its way.
        stands: whether it does.
    """
    off = vehicle.copy()
    if stands:
        off[:, 1:] = 0.0
        return off
    along = off[:, 2] @ direction
    believed_m2_s4, seen_s = float(np.mean(np.square(along))), _CHANGE_S * len(driving.changes)
    squares = _PRIOR_DRIVEN_S * believed_m2_s4 + seen_s * driving.unevenness_m_s2**2
    shown_m2_s4 = squares / (_PRIOR_DRIVEN_S + seen_s)
    less = 1.0 - math.sqrt(min(shown_m2_s4 / max(believed_m2_s4, 1e-9), 1.0))
    off[:, 2] -= less * along[:, None] * direction
    return off


def _root(covariance: Array) -> Array:
    """Return a matrix whose product with its transpose is `covariance`, which rounding may have made indefinite."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def follower_of(memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig) -> Follower:
    """Return how the drone follows, by its autopilot's gains, the planner's weights and the limits of the flight."""
    if inputs.response is None or situation.approach is None:
        raise ValueError("no autopilot flies")
    cascade, limits = inputs.response.cascade, inputs.limits
    level_m_s2, level_below_m = level_end(situation.pad, situation.approach, inputs, config)
    told_ns = memory.forecast.acceleration_ns
    is_told = told_ns is not None and inputs.monotonic_ns - told_ns < _SENSOR_HOLD_NS
    return Follower(
        stiffness_per_s2=cascade.stiffness_per_s2,
        damping_per_s=cascade.damping_per_s,
        path_share=1.0 if cascade.is_led else cascade.path_share,
        led_share=1.0 if cascade.is_led else 0.0,
        turns_hz=cascade.turns_hz,
        forgets_hz=cascade.integral_per_s2 / cascade.velocity_per_s,
        drag_per_s=DRAG_PER_S,
        push_std_m_s2=memory.forecast.gusts.push_std_m_s2,
        bandwidth_hz=_BANDWIDTH_TIMES / config.guidance.mpc.intercept_time_min_s,
        believes_s=_BELIEVES_BY_SENSOR_S if is_told else _BELIEVES_S,
        acceleration_max_m_s2=limits.acceleration_max_m_s2,
        jerk_max_m_s3=limits.jerk_max_m_s3,
        level_m_s2=level_m_s2,
        level_below_m=level_below_m,
    )


def rules_of(relative: Approach, inputs: StepInputs, config: CompanionConfig) -> Rules:
    """Return what the drone waits for and breaks off on."""
    half_width_m, delay = relative.pad_half_width_m, inputs.link_delay
    return Rules(
        waits_max_s=_WAITS_MAX_S,
        waits_below_m=config.descent.wait.height_m,
        commits_below_m=config.descent.commit_height_m,
        waiting_speed_m_s=config.descent.wait.speed_m_s,
        waiting_brake_m_s2=config.descent.wait.speed_change_max_m_s2,
        cone_at_pad_m=cone_radius_at_pad_m(half_width_m, config),
        cone_slope=config.descent.cone.slope,
        near_speed_m_s=config.abort.near_speed_max_m_s,
        over_pad_m=over_pad_radius_m(half_width_m, config),
        stops_sinking_s=ATTITUDE_LAG_S + delay.mean_s + delay.std_s + config.abort.near_speed_hold_s,
        climbs_m_s2=inputs.limits.vertical_acceleration_max_m_s2,
        foot_radius_m=config.touchdown.foot_radius_m,
    )
