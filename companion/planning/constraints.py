"""The constraint matrices of a plan's two programmes: one for both horizontal axes, one for the vertical axis.

Variables: the jerk of each block, of the major axis and then of the minor one, or of the vertical axis; then one slack
>= 0 each for speed, acceleration and, in the vertical programme, height, with an exact penalty. The jerk's bounds are
hard, all others soft: with finite numbers a programme is always feasible.

What `envelope` says of norms is along unit vectors, both ways.
"""

import numpy as np
from scipy.linalg import block_diag

from companion.core.data import Array
from companion.planning.axis_qp import AxisCost, AxisModel
from companion.planning.envelope import PUSH_NORMALS, SPEED_NORMALS

LEVEL_SLACKS, VERTICAL_SLACKS = 2, 3


def level_hessian(cost: AxisCost, slack_weight: float) -> Array:
    """Return H (2 m + 2, 2 m + 2) of the horizontal programme."""
    return np.asarray(block_diag(cost.H, cost.H, slack_weight * np.eye(LEVEL_SLACKS)))


def vertical_hessian(cost: AxisCost, slack_weight: float) -> Array:
    """Return H (m + 3, m + 3) of the vertical programme."""
    return np.asarray(block_diag(cost.H, slack_weight * np.eye(VERTICAL_SLACKS)))


def level_rows(model: AxisModel) -> Array:
    """Return A (c, 2 m + 2): along each normal the jerk; along each and against it speed and acceleration; slacks.

    Speed and acceleration are bounded at the ends of the blocks.
    """
    moves = len(model.move_s)
    at_ends = model.end_node[1:] - 1
    speed = np.vstack([_along(normal, model.forced_v[at_ends], 0) for normal in _both_ways(SPEED_NORMALS)])
    push = np.vstack([_along(normal, model.forced_a[at_ends], 1) for normal in _both_ways(PUSH_NORMALS)])
    jerk = np.vstack([np.hstack((n[0] * np.eye(moves), n[1] * np.eye(moves))) for n in PUSH_NORMALS])
    jerk = np.hstack((jerk, np.zeros((len(jerk), LEVEL_SLACKS))))
    return np.ascontiguousarray(np.vstack((jerk, speed, push, _slacks(2 * moves, LEVEL_SLACKS))))


def vertical_rows(model: AxisModel, floor_lead_s: float) -> Array:
    """Return A (c, m + 3): the jerk; speed down and up; acceleration down and up; the floor; slacks.

    Args:
        model: the predictions.
        floor_lead_s: the floor bounds the position that is carried on by its rate for this long.
    """
    moves = len(model.move_s)
    ends = model.forced_a[model.end_node[1:] - 1]
    blocks = [
        np.eye(moves, moves + VERTICAL_SLACKS),
        _widened(-model.forced_v, VERTICAL_SLACKS, 0, -1.0),
        _widened(model.forced_v, VERTICAL_SLACKS, 0, -1.0),
        _widened(-ends, VERTICAL_SLACKS, 1, -1.0),
        _widened(ends, VERTICAL_SLACKS, 1, -1.0),
        _widened(model.forced_p + floor_lead_s * model.forced_v, VERTICAL_SLACKS, 2, 1.0),
        _slacks(moves, VERTICAL_SLACKS),
    ]
    return np.ascontiguousarray(np.vstack(blocks))


def _both_ways(normals: Array) -> Array:
    return np.vstack((normals, -normals))


def _along(normal: Array, rows: Array, slack: int) -> Array:
    """Return rows (k, 2 m + 2) of both axes along a normal (2,), from those of one axis (k, m)."""
    return _widened(np.hstack((normal[0] * rows, normal[1] * rows)), LEVEL_SLACKS, slack, -1.0)


def _widened(rows: Array, slacks: int, slack: int, sign: float) -> Array:
    columns = np.zeros((len(rows), slacks))
    columns[:, slack] = sign
    return np.hstack((rows, columns))


def _slacks(moves: int, slacks: int) -> Array:
    return np.eye(slacks, moves + slacks, k=moves)
