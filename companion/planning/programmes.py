"""What one plan gives to the solver and what it makes of the answers, in two compiled calls.

Between the solver's calls a plan is arithmetic on small arrays, which costs more to call than to do. Plain tuples go
in and get their names inside: named ones take numba five times as long to recognise. Results are written into arrays
that go in as well: numpy makes one in a third of the time that a compiled function needs to hand one out.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array
from companion.planning.axis_qp import slopes_of
from companion.planning.compiled import compiled_kernel
from companion.planning.envelope import level_bounds, vertical_bounds
from companion.planning.horizon import turned_horizon
from companion.planning.intercept import approach
from companion.planning.qp import Problem
from companion.planning.resample import resampled_line, resampled_path

Path3 = tuple[Array, Array, Array]
"""Position, velocity and acceleration in W: (3,) each of one state, or (n, 3) each of a path."""

Sampling = tuple[NDArray[np.int64], Array]
"""`left` and `weights` of a resampler."""


class Grid(NamedTuple):
    """The constant times of a plan.

    Attributes:
        nodes_s: (n + 1,) now and the nodes.
        move_s: (m,) the durations of the blocks.
        end_s: (m,) their ends.
    """

    nodes_s: Array
    move_s: Array
    end_s: Array


class Limits(NamedTuple):
    """What may be asked of the drone; accelerations and jerks are horizontal but for the vertical ones."""

    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    vertical_acceleration_m_s2: float
    jerk_m_s3: float
    vertical_jerk_m_s3: float


class Numbers(NamedTuple):
    """Those of the configuration: `MpcConfig` says what they are."""

    axes_time_s: float
    intercept_fraction: float
    intercept_time_min_s: float
    slack_weight: float


PlainLimits = tuple[float, float, float, float, float, float, float]
"""`Limits` as a plain tuple."""

PlainGrid = tuple[Array, Array, Array]
"""`Grid` as a plain tuple."""

Statics = tuple[PlainGrid, NDArray[np.int64], tuple[float, float, float, float], tuple[Array, Array]]
"""What all plans of a law for an autopilot have in common: `Grid` as a plain tuple, the places (m + 1,) of now and of
the blocks' ends among its nodes, `Numbers` as a plain tuple, and the weights of the linear terms as `AxisCost` has
them, of the horizontal axes and of the vertical one."""

Posed = tuple[Array, Problem, Problem]
"""The problem of a plan in turned axes: the frame, the programme of both horizontal axes and that of the vertical one.

The frame (5, 3) has position, velocity and acceleration in its rows, the axes in their columns; then, in W, the place
of the target now and the direction of the major axis.
"""


@compiled_kernel
def total_of(state: Path3, target: tuple[Array, Array, Array, Array]) -> float:
    """Return a number that is not finite if any of these is not, or is too large to be a place."""
    position, velocity, acceleration, floor = target
    total = 0.0
    for axis in range(3):
        total += state[0][axis] + state[1][axis] + state[2][axis]
    for sample in range(len(floor)):
        total += floor[sample] * floor[sample]
        for axis in range(3):
            p, v, a = position[sample, axis], velocity[sample, axis], acceleration[sample, axis]
            total += p * p + v * v + a * a
    return total


@compiled_kernel
def pose(
    state: Path3,
    target: tuple[Array, Array, Array, Array],
    lead_s: float,
    limits: PlainLimits,
    leaning: tuple[float, float, float, float],
    sampling: Sampling,
    statics: Statics,
    posed: Posed,
) -> bool:
    """Write the problem of a plan.

    Args:
        state: of the virtual model now.
        target: position, velocity and acceleration (n, 3) in W, and the lowest height (n,), at its own offsets.
        lead_s: of the floor, see `envelope.vertical_bounds`; the way itself keeps to one without a lead only.
        limits: of the drone.
        leaning: the norm of the path's acceleration, then `envelope.Thrust` in W.
        sampling: from the target's offsets to the grid's `nodes_s`.
        statics: of the law.
        posed: where it is written.

    Returns:
        whether state, target and floor are finite throughout; nothing of the problem counts if not.
    """
    most, grid, numbers = Limits(*limits), Grid(*statics[0]), Numbers(*statics[2])
    node_s, end_s = grid.nodes_s[1:], grid.end_s
    path = resampled_path(target[:3], sampling[0], sampling[1])
    direction, x, turned = turned_horizon(state, path, numbers.axes_time_s)
    floor = resampled_line(target[3], sampling[0], sampling[1])
    for node in range(len(floor)):
        floor[node] -= path[0, 0, 2]
    frame, level, upright = posed
    put_frame(frame, x, path, direction)
    rates = (most.speed_m_s, most.climb_m_s, most.descent_m_s, most.acceleration_m_s2, most.vertical_acceleration_m_s2)
    lowest = floor if lead_s == 0.0 else np.full(len(floor), -math.inf)
    reference = approach(
        x[:2], grid.nodes_s, turned, lowest, rates, numbers.intercept_fraction, numbers.intercept_time_min_s
    )
    jerk = mean_jerks(turned[2], statics[1], grid.move_s)
    norms = (most.speed_m_s, leaning[0], most.jerk_m_s3)
    c, s = direction
    thrust = (leaning[1], c * leaning[2] + s * leaning[3], c * leaning[3] - s * leaning[2])
    vertical = (most.descent_m_s, most.climb_m_s, most.vertical_acceleration_m_s2, most.vertical_jerk_m_s3)
    slopes = slopes_of(statics[3][0], statics[3][1], x, reference, jerk)
    put_linear(level[0], slopes[:2], numbers.slack_weight)
    put_linear(upright[0], slopes[2:], numbers.slack_weight)
    level_bounds(x, norms, thrust, end_s, level[1:])
    vertical_bounds(x[:, 2], floor[1:], lead_s, vertical, node_s, end_s, upright[1:])
    return math.isfinite(total_of(state, target) + sampling[1][0, 0, 0])


@compiled_kernel
def put_frame(frame: Array, x: Array, path: Array, direction: tuple[float, float]) -> None:
    """Write the frame as `Posed` has it: `x` (3, 3) in turned axes, where `path` begins, and the major axis in W."""
    for axis in range(3):
        frame[0, axis], frame[1, axis], frame[2, axis] = x[0, axis], x[1, axis], x[2, axis]
        frame[3, axis] = path[0, 0, axis]
    frame[4, 0], frame[4, 1], frame[4, 2] = direction[0], direction[1], 0.0


@compiled_kernel
def put_linear(term: Array, slopes: Array, slack_weight: float) -> None:
    """Write a linear term (q,): `slopes` (k, m) of the moves of each axis, then those of the slacks."""
    axes, moves = slopes.shape
    term[:] = slack_weight
    for axis in range(axes):
        for move in range(moves):
            term[axis * moves + move] = slopes[axis, move]


@compiled_kernel
def mean_jerks(acceleration: Array, end_node: NDArray[np.int64], move_s: Array) -> Array:
    """Return the mean jerks (3, m) in the blocks of accelerations (3, n + 1) now and at the nodes."""
    jerk = np.empty((3, len(move_s)))
    for axis in range(3):
        for move in range(len(move_s)):
            change = acceleration[axis, end_node[move + 1]] - acceleration[axis, end_node[move]]
            jerk[axis, move] = change / move_s[move]
    return jerk


@compiled_kernel
def plan_of(frame: Array, level: Array, vertical: Array, maps: Array, path: Array) -> float:
    """Write a plan, and return its largest slack.

    Args:
        frame: as `Posed` has it.
        level: (2 m + s,) the moves of the major axis and of the minor one, then slacks.
        vertical: (m + s,) the moves of the vertical axis, then slacks.
        maps: (3 + m, 3 k) from the state and the moves to p, v, a at k instants.
        path: (3, k, 3) where position, velocity and acceleration in W are written.
    """
    c, s = frame[4, 0], frame[4, 1]
    moves, instants = maps.shape[0] - 3, path.shape[1]
    turned, excess = np.zeros((3, 3 * instants)), 0.0
    for axis in range(3):
        jerk = vertical if axis == 2 else level[axis * moves :]
        for source in range(3 + moves):
            share = frame[source, axis] if source < 3 else jerk[source - 3]
            for i in range(3 * instants):  # innermost, since only sums that are apart are computed side by side
                turned[axis, i] += maps[source, i] * share
    for slack in range(2 * moves, len(level)):
        excess = max(excess, level[slack])
    for slack in range(moves, len(vertical)):
        excess = max(excess, vertical[slack])
    for rate in range(3):
        is_place = 1.0 if rate == 0 else 0.0
        for instant in range(instants):
            i = rate * instants + instant
            major, minor, up = turned[0, i], turned[1, i], turned[2, i]
            path[rate, instant, 0] = c * major - s * minor + is_place * frame[3, 0]
            path[rate, instant, 1] = s * major + c * minor + is_place * frame[3, 1]
            path[rate, instant, 2] = up + is_place * frame[3, 2]
    return excess
