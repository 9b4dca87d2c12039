"""The prediction matrices of one axis: a triple integrator driven by jerk that is constant over blocks.

State `x = [p, v, a]` in m, m/s, m/s^2; input the jerk `u` (m,) in m/s^3, one value per block of the horizon.
At node time t after now, exactly,
`p = p0 + v0 t + a0 t^2/2 + sum_i u_i (c3(t - b_i) - c3(t - e_i))`, `c3(x) = max(x, 0)^3 / 6`, for the block from
`b_i` to `e_i`; likewise v with `c2(x) = max(x, 0)^2 / 2` and a with `c1(x) = max(x, 0)`.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AxisModel:
    """Predictions at n nodes from the state now and m moves: `p = free_p @ x + forced_p @ u`, likewise v and a.

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
