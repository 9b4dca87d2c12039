"""How far off its moves a drone will be: the response of an autopilot to the jerk of a plan.

With z' = A z + b a, the drone is z[0] (m) off the plan and z[1] (m/s) faster, and a is the plan's acceleration. That is
linear in the moves, so that a programme may weigh where the drone will be in place of where its setpoints are.
"""

import numpy as np
from msgspec import Struct
from scipy.linalg import expm

from companion.core.data import Array


class Following(Struct, frozen=True, kw_only=True, eq=False):
    """How a drone deviates from a plan along an axis; one of an autopilot is always the same object.

    Attributes:
        motion: A (k, k).
        asked: b (k,).
    """

    motion: Array
    asked: Array


def deviations(following: Following, node_s: Array, move_s: Array) -> tuple[Array, Array]:
    """Return the (n, m) maps from the moves to how far off the drone is, and how much faster, at `node_s` (n,).

    Args:
        following: of the autopilot.
        node_s: rising; the ends of all blocks are among them.
        move_s: (m,) durations of the blocks of constant jerk.
    """
    states, moves = len(following.asked), len(move_s)
    system = np.zeros((states + 2, states + 2))
    system[:states, :states], system[:states, states], system[states, states + 1] = following.motion, following.asked, 1
    ends_s = np.cumsum(move_s)
    course = np.zeros((states + 2, moves))
    off, faster = np.empty((len(node_s), moves)), np.empty((len(node_s), moves))
    began_s = 0.0
    for node, end_s in enumerate(node_s):
        middle_s = 0.5 * (began_s + end_s)
        course[-1] = (ends_s - move_s < middle_s) & (middle_s < ends_s)
        course = expm(system * (end_s - began_s)) @ course
        off[node], faster[node], began_s = course[0], course[1], end_s
    return off, faster
