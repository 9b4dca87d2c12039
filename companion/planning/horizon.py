"""One plan's problem in turned axes: the state and the references relative to the target's position now.

Axis 0 is the major horizontal axis, where most of the motion is needed, axis 1 the minor one, axis 2 is up.
Each norm limit is split: the major axis gets what is left of it beside a share for the minor one.
"""

import math
from dataclasses import dataclass

import numpy as np

from companion.data import Array, FlightLimits
from companion.planning.condensed import AxisModel
from companion.planning.config import MpcConfig
from companion.planning.guidance import PlanRequest
from companion.planning.intercept import plan_intercept
from companion.planning.resample import make_resampler

RATE_RESERVE = 0.05
"""Share of a speed limit that an intercept may use even when the target leaves less."""

ACCELERATION_RESERVE = 0.3
"""Share of an acceleration limit that an intercept may use even when the target's own acceleration leaves less."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Horizon:
    """What the programmes of the three axes are made from.

    Attributes:
        origin_enu_m: (3,) the target's position now.
        turn: (3, 3) from W to the turned axes.
        state: (3, 3) position, velocity, acceleration (rows) per axis (columns).
        position_m: (3, n) reference per axis and node.
        velocity_m_s: (3, n).
        acceleration_m_s2: (3, n).
        jerk_m_s3: (3, m) the target's mean jerk in each block.
        floor_m: (n,) relative to the origin.
        speed_major_m_s: the major axis's share of the speed limit.
        acceleration_major_m_s2: its share of the acceleration limit.
    """

    origin_enu_m: Array
    turn: Array
    state: Array
    position_m: Array
    velocity_m_s: Array
    acceleration_m_s2: Array
    jerk_m_s3: Array
    floor_m: Array
    speed_major_m_s: float
    acceleration_major_m_s2: float


def make_horizon(request: PlanRequest, model: AxisModel, nodes_s: tuple[float, ...], config: MpcConfig) -> Horizon:
    """Return the problem of `request`; `nodes_s` are 0 and the nodes of `model`."""
    resampler = make_resampler(tuple(request.target.offset_s.tolist()), nodes_s)
    position, velocity, acceleration = resampler.apply(request.target)
    origin = position[0]
    state = request.state
    error, rate = state.position_enu_m - origin, state.velocity_enu_m_s - velocity[0]
    turn = turn_to_major(error, rate, config.axes_time_s)
    target_p, target_v, target_a = turn @ (position - origin).T, turn @ velocity.T, turn @ acceleration.T
    limits = request.limits
    speed_minor = abs(float(target_v[1, 0])) + config.lateral_speed_fraction * limits.speed_max_m_s
    push_minor = max(config.lateral_fraction * limits.acceleration_max_m_s2, float(np.abs(target_a[1]).max()))
    speed_major, push_major = (
        left_of(limits.speed_max_m_s, speed_minor),
        left_of(limits.acceleration_max_m_s2, push_minor),
    )
    push = np.array([push_major, min(push_minor, push_major), limits.vertical_acceleration_max_m_s2])
    upward = np.array([speed_major, left_of(limits.speed_max_m_s, abs(float(target_v[0, 0]))), limits.climb_max_m_s])
    downward = np.array([upward[0], upward[1], limits.descent_max_m_s])
    way = plan_intercept(
        turn @ error,
        turn @ rate,
        np.maximum(config.intercept_fraction * push - np.abs(target_a[:, 0]), ACCELERATION_RESERVE * push),
        -np.maximum(downward + target_v[:, 0], RATE_RESERVE * downward),
        np.maximum(upward - target_v[:, 0], RATE_RESERVE * upward),
    )
    way_p, way_v, way_a = way.at(model.node_s)
    ends = np.concatenate((target_a[:, :1], target_a[:, 1:][:, model.block_end]), axis=1)
    return Horizon(
        origin_enu_m=origin,
        turn=turn,
        state=np.stack((error, state.velocity_enu_m_s, state.acceleration_enu_m_s2)) @ turn.T,
        position_m=target_p[:, 1:] + way_p,
        velocity_m_s=target_v[:, 1:] + way_v,
        acceleration_m_s2=target_a[:, 1:] + way_a,
        jerk_m_s3=np.diff(ends, axis=1) / model.move_s,
        floor_m=(resampler.linear @ request.floor_enu_m)[1:] - origin[2],
        speed_major_m_s=speed_major,
        acceleration_major_m_s2=push_major,
    )


def left_of(norm: float, used: float) -> float:
    """Return what one axis may use of a norm limit beside `used` on the other; never less than a fifth."""
    return max(math.sqrt(max(norm * norm - used * used, 0.0)), 0.2 * norm)


def turn_to_major(error_m: Array, rate_m_s: Array, time_s: float) -> Array:
    """Return the rotation (3, 3) about up that lays axis 0 along the greatest horizontal need of motion.

    The need is the principal direction of `e e' + time^2 w w'`, e relative position and w relative velocity.
    """
    ex, ey = float(error_m[0]), float(error_m[1])
    wx, wy = time_s * float(rate_m_s[0]), time_s * float(rate_m_s[1])
    angle = 0.5 * math.atan2(2.0 * (ex * ey + wx * wy), ex * ex - ey * ey + wx * wx - wy * wy)
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
