"""What one plan gives to the solver and what it makes of the answers, in three compiled calls.

Between the solver's calls a plan is arithmetic on small arrays, which costs more to call than to do. Plain tuples go
in and get their names inside: named ones take numba five times as long to recognise. The split of the acceleration
norm is the angle at which the sum of the times that the two horizontal axes need to the target is least.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.data import Array
from companion.planning.axis_qp import linear_term
from companion.planning.envelope import major_bounds, minor_bounds, vertical_bounds
from companion.planning.horizon import turned_horizon
from companion.planning.intercept import approach
from companion.planning.kept import kept
from companion.planning.resample import resampled_line, resampled_path

Path3 = tuple[Array, Array, Array]
"""Position, velocity and acceleration in W: (3,) each of one state, or (n, 3) each of a path."""

Sampling = tuple[NDArray[np.int64], Array]
"""`left` and `weights` of a resampler."""

Maps = tuple[Array, Array]
"""From state and moves to the motion."""


class Grid(NamedTuple):
    """The constant times of a plan.

    Attributes:
        nodes_s: (n + 1,) now and the nodes.
        move_s: (m,) the durations of the blocks.
        forced_v: (n, m) velocity at the nodes per jerk in the blocks.
        end_node: (m + 1,) the places of their ends, and that of now, among `nodes_s`.
    """

    nodes_s: Array
    move_s: Array
    forced_v: Array
    end_node: NDArray[np.int64]


class Limits(NamedTuple):
    """What may be asked of the drone; accelerations are horizontal but for the vertical one."""

    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    vertical_acceleration_m_s2: float
    jerk_m_s3: float


class Numbers(NamedTuple):
    """Those of the configuration: `MpcConfig` says what they are."""

    axes_time_s: float
    intercept_fraction: float
    intercept_time_min_s: float
    lateral_speed_fraction: float


PlainLimits = tuple[float, float, float, float, float, float]
"""`Limits` as a plain tuple."""

PlainGrid = tuple[Array, Array, Array, NDArray[np.int64]]
"""`Grid` as a plain tuple."""

Statics = tuple[PlainGrid, tuple[float, float, float, float], tuple[Array, Array, Array], tuple[Array, Array]]
"""What all plans of a law have in common: `Grid` and `Numbers` as plain tuples, the weights of the linear terms as
`AxisProblem.weights` has them, and the slacks' gradients (q - m,) of a horizontal axis and of the vertical one."""


class Posed(NamedTuple):
    """The problem of a plan, in turned axes.

    Attributes:
        origin_enu_m: (3,) the target's position now.
        direction: of the major axis in W.
        state: (3, 3) position, velocity, acceleration (rows) per axis (columns).
        linear_terms: (q,) of the major, the minor and the vertical axis's programme.
        major: its lower and upper bounds (c,).
        vertical: the same.
        is_finite: whether state, target and floor were finite throughout; nothing else counts if not.
    """

    origin_enu_m: Array
    direction: tuple[float, float]
    state: Array
    linear_terms: tuple[Array, Array, Array]
    major: tuple[Array, Array]
    vertical: tuple[Array, Array]
    is_finite: bool


@kept
def total_of(target: tuple[Array, Array, Array, Array]) -> float:
    """Return a number that is not finite if any of the target's is not, or is too large to be a place."""
    position, velocity, acceleration, floor = target
    total = 0.0
    for sample in range(len(floor)):
        total += floor[sample] * floor[sample]
        for axis in range(3):
            p, v, a = position[sample, axis], velocity[sample, axis], acceleration[sample, axis]
            total += p * p + v * v + a * a
    return total


@kept
def pose(
    state: Path3, target: tuple[Array, Array, Array, Array], limits: PlainLimits, sampling: Sampling, statics: Statics
) -> Posed:
    """Return the problem of a plan, all but the bounds of its minor axis.

    Args:
        state: of the virtual model now.
        target: position, velocity and acceleration (n, 3) in W, and the lowest height (n,), at its own offsets.
        limits: of the drone.
        sampling: from the target's offsets to the grid's `nodes_s`.
        statics: of the law.
    """
    most = Limits(*limits)
    grid, numbers, weights, (level, upright) = Grid(*statics[0]), Numbers(*statics[1]), statics[2], statics[3]
    node_s, end_s = grid.nodes_s[1:], np.cumsum(grid.move_s)
    path = resampled_path(target[:3], sampling[0], sampling[1])
    direction, x, turned = turned_horizon(state, path, most.speed_m_s, most.acceleration_m_s2, numbers.axes_time_s)
    floor = resampled_line(target[3], sampling[0], sampling[1]) - path[0, 0, 2]
    rates = np.array(
        (most.speed_m_s, most.climb_m_s, most.descent_m_s, most.acceleration_m_s2, most.vertical_acceleration_m_s2)
    )
    split, push, reference = approach(
        x[:2], grid.nodes_s, turned, floor, rates, numbers.intercept_fraction, numbers.intercept_time_min_s
    )
    ends = turned[2][:, grid.end_node]
    jerk = (ends[:, 1:] - ends[:, :-1]) / grid.move_s
    norms = np.array((most.speed_m_s, most.acceleration_m_s2, most.jerk_m_s3))
    way = np.array((split, push[1], numbers.lateral_speed_fraction))
    vertical = (most.descent_m_s, most.climb_m_s, most.vertical_acceleration_m_s2, most.jerk_m_s3)
    return Posed(
        path[0, 0].copy(),
        direction,
        x,
        (
            linear_term(weights, level, x[:, 0], reference[:, 0], jerk[0]),
            linear_term(weights, level, x[:, 1], reference[:, 1], jerk[1]),
            linear_term(weights, upright, x[:, 2], reference[:, 2], jerk[2]),
        ),
        major_bounds(x, turned[1, 1], ends[1], way, norms, node_s, end_s),
        vertical_bounds(x[:, 2], floor[1:], vertical, node_s, end_s),
        math.isfinite(total_of(target) + np.sum(path) + np.sum(x)),
    )


@kept
def bound_minor(x: Array, major_jerk: Array, limits: PlainLimits, plain_grid: PlainGrid) -> tuple[Array, Array]:
    """Return the bounds (c,) of the minor axis beside the major one's plan; see `envelope.minor_bounds`."""
    most, grid = Limits(*limits), Grid(*plain_grid)
    norms = np.array((most.speed_m_s, most.acceleration_m_s2, most.jerk_m_s3))
    return minor_bounds(x, major_jerk, grid.forced_v, norms, grid.nodes_s[1:], grid.move_s, np.cumsum(grid.move_s))


@kept
def path_of(
    origin_m: Array, direction: tuple[float, float], x: Array, moves: tuple[Array, Array, Array], maps: Maps
) -> tuple[Array, float]:
    """Return position, velocity and acceleration (3, k, 3) in W of a plan, and its largest slack.

    Args:
        origin_m: (3,) in W.
        direction: of the major axis in W.
        x: (3, 3) the turned state.
        moves: of each axis, the first m of (q,); slacks behind them.
        maps: (3, k, 3) from the state and (3, k, m) from the moves to p, v, a at k instants.
    """
    free, forced = maps
    c, s = direction
    path = np.empty((3, free.shape[1], 3))
    for rate in range(3):
        for node in range(free.shape[1]):
            major, minor, up = 0.0, 0.0, 0.0
            for before in range(3):
                major += free[rate, node, before] * x[before, 0]
                minor += free[rate, node, before] * x[before, 1]
                up += free[rate, node, before] * x[before, 2]
            for move in range(forced.shape[2]):
                major += forced[rate, node, move] * moves[0][move]
                minor += forced[rate, node, move] * moves[1][move]
                up += forced[rate, node, move] * moves[2][move]
            path[rate, node] = c * major - s * minor, s * major + c * minor, up
            if rate == 0:
                path[rate, node] += origin_m
    excess = 0.0
    for axis in range(3):
        for slack in moves[axis][forced.shape[2] :]:
            excess = max(excess, slack)
    return path, excess
