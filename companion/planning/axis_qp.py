"""The cost of a plan on one axis: track a reference over the horizon.

Minimise half of the integral of `e'Qe + r (u - u_ref)^2`, `e` the error of [p, v, a], plus `e'Pe` at the horizon's end
with P of the infinite-horizon problem (algebraic Riccati equation). What bounds the plan is in `constraints` and
`envelope`. All matrices are built once; a plan only makes vectors, in compiled calls.

The prediction matrices are those of a triple integrator driven by jerk that is constant over blocks. State `x = [p, v,
a]` in m, m/s, m/s^2; input the jerk `u` (m,) in m/s^3, one value per block of the horizon. At node time t after now,
exactly, `p = p0 + v0 t + a0 t^2/2 + sum_i u_i (c3(t - b_i) - c3(t - e_i))`, `c3(x) = max(x, 0)^3 / 6`, for the block
from `b_i` to `e_i`. v has `c2(x) = max(x, 0)^2 / 2` in place of `c3`, and a has `c1(x) = max(x, 0)`.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are

from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.planning.compiled import compiled_kernel
from companion.planning.following import Following, deviations


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisModel:
    """Predictions at n nodes from the state now and m moves: `p = free_p @ x + forced_p @ u`; v and a have their own.

    Attributes:
        move_s: (m,) durations of the blocks.
        node_s: (n,) times of the nodes, the last the horizon.
        end_s: (m,) times of the ends of the blocks.
        end_node: (m + 1,) their places, and that of now, among now and the nodes.
        free_p: (n, 3).
        free_v: (n, 3).
        free_a: (n, 3).
        forced_p: (n, m).
        forced_v: (n, m).
        forced_a: (n, m).
    """

    move_s: Array
    node_s: Array
    end_s: Array
    end_node: NDArray[np.intp]
    free_p: Array
    free_v: Array
    free_a: Array
    forced_p: Array
    forced_v: Array
    forced_a: Array


def make_axis_model(move_s: Array, node_spacing_max_s: float) -> AxisModel:
    """Return the prediction matrices for blocks of `move_s` (m,), long ones split evenly into several nodes."""
    ends = np.cumsum(move_s)
    parts = [math.ceil(float(move) / node_spacing_max_s - 1e-9) for move in move_s]
    nodes = [np.linspace(end - move, end, k + 1)[1:] for end, move, k in zip(ends, move_s, parts, strict=True)]
    node_s = np.concatenate(nodes)
    free_p, free_v, free_a = free_response(node_s)
    forced_p, forced_v, forced_a = forced_response(node_s, move_s)
    return AxisModel(
        move_s=np.asarray(move_s, dtype=np.float64),
        node_s=node_s,
        end_s=ends,
        end_node=np.cumsum([0, *parts]),
        free_p=free_p,
        free_v=free_v,
        free_a=free_a,
        forced_p=forced_p,
        forced_v=forced_v,
        forced_a=forced_a,
    )


def free_response(t_s: Array) -> tuple[Array, Array, Array]:
    """Return the (n, 3) maps from the state now to position, velocity and acceleration at `t_s` (n,) without jerk."""
    one, zero = np.ones_like(t_s), np.zeros_like(t_s)
    position = np.stack([one, t_s, t_s**2 / 2.0], axis=1)
    velocity = np.stack([zero, one, t_s], axis=1)
    acceleration = np.stack([zero, zero, one], axis=1)
    return position, velocity, acceleration


def forced_response(t_s: Array, move_s: Array) -> tuple[Array, Array, Array]:
    """Return the (n, m) maps from the moves to position, velocity and acceleration at `t_s` (n,)."""
    ends = np.cumsum(move_s)
    since_end = np.maximum(t_s[:, None] - ends, 0.0)
    since_begin = np.maximum(t_s[:, None] - (ends - move_s), 0.0)
    position = (since_begin**3 - since_end**3) / 6.0
    velocity = (since_begin**2 - since_end**2) / 2.0
    return position, velocity, since_begin - since_end


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisCost:
    """The constant matrices of the cost.

    Attributes:
        H: (m, m) Hessian over the moves.
        weights: (3 + 3 n + 1, m) gradient with respect to the moves: per position, velocity and acceleration of the
            state, per position, velocity and acceleration of the reference at each node, and per jerk reference.
    """

    H: Array
    weights: Array


@compiled_kernel
def slopes_of(level: Array, upright: Array, x: Array, reference: Array, jerk: Array) -> Array:
    """Return the linear terms (3, m) of the axes' costs over the moves.

    Args:
        level: weights of the horizontal axes, as `AxisCost` has them.
        upright: weights of the vertical axis.
        x: (3, 3) the state: position, velocity, acceleration; axis.
        reference: (3, 3, n) of position, velocity, acceleration; axis; node.
        jerk: (3, m) the reference of the moves.
    """
    moves, nodes = level.shape[1], reference.shape[2]
    slopes = np.empty((3, moves))
    for axis in range(3):
        weights = upright if axis == 2 else level
        for move in range(moves):
            slope = weights[0, move] * x[0, axis] + weights[1, move] * x[1, axis] + weights[2, move] * x[2, axis]
            slopes[axis, move] = slope - weights[-1, move] * jerk[axis, move]
    for rate in range(3):
        for node in range(nodes):
            for axis in range(3):
                wanted = reference[rate, axis, node]
                weights = upright if axis == 2 else level
                for move in range(moves):  # innermost, since only sums that are apart are computed side by side
                    slopes[axis, move] -= weights[3 + rate * nodes + node, move] * wanted
    return slopes


def make_axis_cost(model: AxisModel, config: MpcConfig, following: Following | None = None) -> AxisCost:
    """Return the constant matrices for `model` with the weights of `config`.

    Args:
        model: the predictions of a plan.
        config: the weights.
        following: of the drone whose position and velocity are weighed; None weighs the plan's own.
    """
    off, faster = (0.0, 0.0) if following is None else deviations(following, model.node_s, model.move_s)
    forced = np.concatenate((model.forced_p + off, model.forced_v + faster, model.forced_a))
    free = np.concatenate((model.free_p, model.free_v, model.free_a))
    weight = _cost_of_states(model, config)
    move_weight = config.jerk_weight * model.move_s
    H = forced.T @ weight @ forced + np.diag(move_weight)
    return AxisCost(H=0.5 * (H + H.T), weights=np.vstack(((forced.T @ weight @ free).T, weight @ forced, move_weight)))


def _cost_of_states(model: AxisModel, config: MpcConfig) -> Array:
    """Return the (3 n, 3 n) weight of all node states: trapezoidal running cost and the terminal one."""
    nodes = len(model.node_s)
    step = np.diff(model.node_s, prepend=0.0)
    span = 0.5 * (step + np.append(step[1:], 0.0))
    running = (config.position_weight, config.velocity_weight, config.acceleration_weight)
    weight = np.diag(np.concatenate([q * span for q in running]))
    last = np.array([nodes - 1, 2 * nodes - 1, 3 * nodes - 1])
    weight[np.ix_(last, last)] += terminal_cost(config)
    return weight


def terminal_cost(config: MpcConfig) -> Array:
    """Return P (3, 3) of the infinite-horizon cost of an error of [p, v, a] without bounds."""
    drift = np.diag([1.0, 1.0], k=1)
    jerk = np.array([[0.0], [0.0], [1.0]])
    weights = np.diag([config.position_weight, config.velocity_weight, config.acceleration_weight])
    cost: Array = solve_continuous_are(drift, jerk, weights, np.array([[config.jerk_weight]]))
    return cost
