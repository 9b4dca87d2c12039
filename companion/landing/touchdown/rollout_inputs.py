"""What the rollouts of a descent begin with, from a step's facts: course, drone and rules; pure."""

import math

import numpy as np
from msgspec import Struct

from companion.autopilots.response import ATTITUDE_LAG_S, DRAG_PER_S, STATES, Cascade
from companion.config.companion import CompanionConfig
from companion.core.data import Array
from companion.forecast.draws import STEPS_MAX
from companion.forecast.samples import DT_S, Course, Follower, Rules
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.steering.targets import way_down
from companion.landing.touchdown.levelling import level_end
from companion.situation.situation import Approach, Situation
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import cone_radius_at_pad_m, over_pad_radius_m

_OFFSETS_S = DT_S * np.arange(STEPS_MAX, dtype=np.float64)
_BELOW_M = -0.4  # to where the way down is followed: heights are not off by more
_REPORT_AGE_MAX_S = 0.25
# Of a short wait: it stops and sinks anew meanwhile, which takes as long again. Then the contact comes a second later.
_WAITS_MAX_S = 0.5
_WAITS_STEPS = math.ceil(_WAITS_MAX_S / DT_S)
_SLOW_M_S = 0.3  # slower than this a vehicle has no direction but its heading
# Lag with which an acceleration is believed: velocities at 10 Hz show a brake in 0.3 s, an accelerometer at once.
_BELIEVES_S, _BELIEVES_BY_SENSOR_S = 0.3, 0.1
_STEERS_M_S = 1.0  # slower than this a vehicle has no course that an antenna could show
_WAY_LAGS = 7.0
_SENSOR_HOLD_NS = 1_000_000_000


class WayDown(Struct, frozen=True, kw_only=True, eq=False):
    """The planned descent, without a wait.

    Attributes:
        offset_s: (m,) times from now.
        path: (3, m) height, rate and acceleration over the pad.
        contact_s: when it ends.
    """

    offset_s: Array
    path: Array
    contact_s: float

    @property
    def lasts_s(self) -> float:
        """How long it takes at most, with the longest wait."""
        return float(self.offset_s[-1])


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
    contact_s = float(_OFFSETS_S[below[0]])
    return WayDown(offset_s=_OFFSETS_S[:count], path=path[:, :count].copy(), contact_s=contact_s)


def deviation_now(memory: StepMemory, inputs: StepInputs, pad: PadPath) -> Array:
    """Return the cascade's state (4, 2) now, its lean that beyond what the pad's own acceleration takes."""
    tracking, reference = memory.model.tracking, memory.model.reference
    if reference is None or inputs.response is None:
        raise ValueError("no autopilot flies")
    state, leans_m_s2 = np.zeros((STATES, 2)), reference.acceleration_enu_m_s2[:2]
    is_led = inputs.response.cascade.is_led
    if tracking.compared_ns is not None:
        late_s = (inputs.monotonic_ns - tracking.compared_ns) * 1e-9
        state = inputs.response.carry(tracking.deviation, leans_m_s2, min(late_s, _REPORT_AGE_MAX_S))
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
    backs_up = pad.yaw_rad is not None and float(direction[0] @ ahead) < 0.0
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
        slope=(-pad.grade if backs_up else pad.grade) * direction
        + (0.0 if pad.swing is None else _at(way.offset_s, pad, pad.swing.slope)),
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


def way_time_s(cascade: Cascade, shortest_s: float) -> float:
    """Return how long the way of a rollout's planner takes, which foresees less of a late lean than the planner does.

    On a way of fewer than some seven of its lags the drone would swing, which behind the planner it does not.
    """
    return max(shortest_s, _WAY_LAGS * cascade.lean_lag_s)


def follower_of(
    memory: StepMemory,
    situation: Situation,
    inputs: StepInputs,
    config: CompanionConfig,
    *,
    relearns_hz: float,
    error_std_m_s: float,
) -> Follower:
    """Return how the drone follows, by its autopilot's gains, the planner's shortest way and the limits.

    Args:
        memory: with the gusts.
        situation: of the step.
        inputs: of the step.
        config: the companion's.
        relearns_hz: how fast the error of the vehicle's velocity becomes another one.
        error_std_m_s: its deviation along an axis.
    """
    if inputs.response is None or situation.approach is None or situation.pad is None:
        raise ValueError("no autopilot flies to a pad")
    cascade, limits = inputs.response.cascade, inputs.limits
    air_enu_m_s2 = memory.model.tracking.air_enu_m_s2
    level_m_s2, level_below_m = level_end(situation.pad, situation.approach, air_enu_m_s2, inputs, config)
    return Follower(
        stiffness_per_s2=cascade.stiffness_per_s2,
        damping_per_s=cascade.damping_per_s,
        path_share=1.0 if cascade.is_led else cascade.path_share,
        led_share=1.0 if cascade.is_led else 0.0,
        turns_hz=cascade.turns_hz,
        forgets_hz=cascade.forgets_hz,
        drag_per_s=DRAG_PER_S,
        push_std_m_s2=memory.forecast.gusts.push_std_m_s2,
        way_s=way_time_s(cascade, config.guidance.mpc.intercept_time_min_s),
        believes_s=_BELIEVES_BY_SENSOR_S if _is_told(memory.forecast.acceleration_ns, inputs) else _BELIEVES_S,
        trails_s=_trails_s(memory, situation, inputs),
        relearns_hz=relearns_hz,
        error_std_m_s=error_std_m_s,
        acceleration_max_m_s2=limits.acceleration_max_m_s2,
        jerk_max_m_s3=limits.jerk_max_m_s3,
        level_m_s2=level_m_s2,
        level_below_m=level_below_m,
    )


def _is_told(told_ns: int | None, inputs: StepInputs) -> bool:
    return told_ns is not None and inputs.monotonic_ns - told_ns < _SENSOR_HOLD_NS


def _trails_s(memory: StepMemory, situation: Situation, inputs: StepInputs) -> float:
    """Return how long after the pad the antenna passes that tells how the vehicle turns, 0 where a sensor does."""
    pad = situation.pad
    if pad is None or pad.yaw_rad is None or _is_told(memory.forecast.turning_ns, inputs):
        return 0.0
    east_m_s, north_m_s = pad.velocity_enu_m_s[0, :2].tolist()
    ahead_m_s = math.cos(pad.yaw_rad) * east_m_s + math.sin(pad.yaw_rad) * north_m_s
    return pad.mounting.ahead_m / math.copysign(max(abs(ahead_m_s), _STEERS_M_S), ahead_m_s)


def rules_of(relative: Approach, inputs: StepInputs, config: CompanionConfig) -> Rules:
    """Return what the drone waits for and breaks off on."""
    half_width_m, delay = relative.pad_half_width_m, inputs.link_delay
    return Rules(
        waits_max_s=_WAITS_MAX_S,
        waits_below_m=config.descent.wait.height_m,
        commits_below_m=config.descent.commit_height_m,
        cone_at_pad_m=cone_radius_at_pad_m(half_width_m, config),
        cone_slope=config.descent.cone.slope,
        near_speed_m_s=config.abort.near_speed_max_m_s,
        over_pad_m=over_pad_radius_m(half_width_m, config),
        stops_sinking_s=ATTITUDE_LAG_S + delay.mean_s + delay.std_s + config.abort.near_speed_hold_s,
        climbs_m_s2=inputs.limits.vertical_acceleration_max_m_s2,
        foot_radius_m=config.touchdown.foot_radius_m,
    )
