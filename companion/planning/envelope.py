"""The bounds of the two programmes' rows: the flight limits, widened where a state already breaks them.

Bounds are widened just enough for such a state to come back as fast as it can. The widened speed bound is the speed
that is left when acceleration is turned against the velocity with nearly all of the jerk and then held at nearly all of
the acceleration limit; the widened acceleration bound falls with the jerk; the lowered floor is the height reached by
pulling up with nearly all of the jerk and of the acceleration, at no more than the climb limit. The floor bounds the
height that the rate carries on: what sinks slows down towards it.

A norm `|w| <= c` of both horizontal axes is a polygon: `n w <= b` along `DIRECTIONS` unit vectors n, both ways. The
polygons of acceleration and jerk are inscribed in the circle, corners on the axes: an axis may use the whole norm, no
direction more. The polygon of the speed is about the circle, its sides on the axes, so that nothing of a speed that the
drone already has must be given up as the axes turn. What the drone leans for is within a circle, too: the path's
acceleration and what holds against the air, together. So drag leaves less to go faster, more to brake, and to turn
nearly all. All functions are compiled.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel

Bounds = tuple[Array, Array]  # the lower and the upper ones of a programme's rows, written in place

DIRECTIONS = 8
"""Of a polygon with twice as many sides: an inscribed one is 1.9 % within its circle at most."""

INSCRIBED = math.cos(0.5 * math.pi / DIRECTIONS)
"""How near the sides of the inscribed polygon are, of the radius."""

SPEED_NORMALS = np.stack(
    [(math.cos(k * math.pi / DIRECTIONS), math.sin(k * math.pi / DIRECTIONS)) for k in range(DIRECTIONS)]
)
"""(d, 2) of the polygon of the speed."""

PUSH_NORMALS = np.stack(
    [
        (math.cos((k + 0.5) * math.pi / DIRECTIONS), math.sin((k + 0.5) * math.pi / DIRECTIONS))
        for k in range(DIRECTIONS)
    ]
)
"""(d, 2) of those of acceleration and jerk."""

AUTHORITY = 0.98
"""Share of the limits that the way back uses, so that the solver has room to follow it."""

LEFT_MIN_SHARE = 0.2
"""Of the tilt limit: with less no plan brakes, and a steady wind that needs more is not flown in."""

Thrust = tuple[float, float, float]
"""The largest horizontal thrust by mass, and that which holds against the air, along both axes (m/s^2)."""

_TINY = 1e-12


@compiled_kernel
def velocity_left(velocity: float, acceleration: float, braking: float, jerk: float, t_s: float) -> float:
    """Return the velocity at `t_s` when the acceleration goes to `-braking` at `jerk` and stays there."""
    turning = min(t_s, max((acceleration + braking) / jerk, 0.0))
    turned = velocity + (acceleration - 0.5 * jerk * turning) * turning
    return turned + min(-braking, acceleration) * (t_s - turning)


@compiled_kernel
def braked(state: Array, braking_m_s2: float, jerk_m_s3: float, t_s: Array) -> Array:
    """Return the horizontal velocity (n, 2) at `t_s` when the acceleration is turned against it, until it is at rest.

    Args:
        state: (3, k) position, velocity and acceleration; the first two axes are horizontal.
        braking_m_s2: that it goes to.
        jerk_m_s3: by which it goes there.
        t_s: (n,).
    """
    vx, vy, ax, ay = state[1, 0], state[1, 1], state[2, 0], state[2, 1]
    speed = max(math.hypot(vx, vy), _TINY)
    bx, by = -braking_m_s2 * vx / speed, -braking_m_s2 * vy / speed
    turn_s = max(math.hypot(bx - ax, by - ay) / jerk_m_s3, _TINY)
    left = np.empty((len(t_s), 2))
    for i in range(len(t_s)):
        turning, held = min(t_s[i], turn_s), max(t_s[i] - turn_s, 0.0)
        eased = 0.5 * turning * turning / turn_s
        left[i, 0] = vx + ax * turning + (bx - ax) * eased + bx * held
        left[i, 1] = vy + ay * turning + (by - ay) * eased + by * held
        if left[i, 0] * vx + left[i, 1] * vy < 0.0:
            left[i, :] = 0.0
    return left


@compiled_kernel
def reachable_floor(
    floor_m: Array, x: Array, pull_m_s2: float, climb_m_s: float, jerk_m_s3: float, lead_s: float, t_s: Array
) -> Array:
    """Return the floor (n,) at `t_s`, at most `floor_m` (n,), that `x` (3,), led by `lead_s`, can keep above."""
    pull, jerk = AUTHORITY * pull_m_s2, AUTHORITY * jerk_m_s3
    climb = max(AUTHORITY * climb_m_s, x[1])
    height, before, then = x[0], x[1], 0.0
    floor = np.empty_like(floor_m)
    for i in range(len(t_s)):
        velocity = min(-velocity_left(-x[1], -x[2], pull, jerk, t_s[i]), climb)
        height += 0.5 * (velocity + before) * (t_s[i] - then)
        before, then = velocity, t_s[i]
        floor[i] = min(floor_m[i], height + lead_s * velocity)
    return floor


@compiled_kernel
def pushes_left(push_m_s2: float, thrust: Thrust) -> Array:
    """Return the bounds (2, d) of the acceleration along `PUSH_NORMALS`, and against them.

    Args:
        push_m_s2: the norm of the acceleration alone.
        thrust: within which it is together with what holds against the air.
    """
    most, holds_x, holds_y = thrust
    left = np.empty((2, len(PUSH_NORMALS)))
    for side in range(len(PUSH_NORMALS)):
        holds = PUSH_NORMALS[side, 0] * holds_x + PUSH_NORMALS[side, 1] * holds_y
        left[0, side] = min(INSCRIBED * push_m_s2, max(INSCRIBED * most - holds, LEFT_MIN_SHARE * most))
        left[1, side] = min(INSCRIBED * push_m_s2, max(INSCRIBED * most + holds, LEFT_MIN_SHARE * most))
    return left


@compiled_kernel
def push_along(left: Array, x: float, y: float) -> float:
    """Return how much acceleration the bounds (2, d) of `pushes_left` leave along the unit vector (x, y)."""
    most = math.inf
    for side in range(len(PUSH_NORMALS)):
        along = PUSH_NORMALS[side, 0] * x + PUSH_NORMALS[side, 1] * y
        most = min(most, (left[0, side] if along > 0.0 else left[1, side]) / max(abs(along), _TINY))
    return most


@compiled_kernel
def level_bounds(state: Array, norms: tuple[float, float, float], thrust: Thrust, end_s: Array, rows: Bounds) -> None:
    """Write the bounds of the rows of `constraints.level_rows`.

    Args:
        state: (3, k) position, velocity and acceleration; the first two axes are horizontal.
        norms: of speed, acceleration and jerk.
        thrust: see `pushes_left`.
        end_s: (m,) the ends of the blocks.
        rows: (c,) each, where they are written.
    """
    lower, upper = rows
    speed, jerk = norms[0], INSCRIBED * norms[2]
    moves = len(end_s)
    row = len(PUSH_NORMALS) * moves
    lower[:], upper[:] = -math.inf, math.inf
    lower[:row], upper[:row] = -jerk, jerk
    pushes, fast = pushes_left(norms[1], thrust), max(math.hypot(state[1, 0], state[1, 1]), _TINY)
    braking = min(INSCRIBED * norms[1], push_along(pushes, -state[1, 0] / fast, -state[1, 1] / fast))
    left = braked(state, AUTHORITY * braking, AUTHORITY * jerk, end_s)
    for way in (1.0, -1.0):
        for side in range(len(SPEED_NORMALS)):
            nx, ny = SPEED_NORMALS[side, 0], SPEED_NORMALS[side, 1]
            velocity = way * (nx * state[1, 0] + ny * state[1, 1])
            acceleration = way * (nx * state[2, 0] + ny * state[2, 1])
            for move in range(moves):
                most = max(speed, way * (nx * left[move, 0] + ny * left[move, 1]))
                upper[row + move] = most - velocity - acceleration * end_s[move]
            row += moves
    size = max(math.hypot(state[2, 0], state[2, 1]), _TINY)
    for against in range(2):
        for side in range(len(PUSH_NORMALS)):
            along = PUSH_NORMALS[side, 0] * state[2, 0] + PUSH_NORMALS[side, 1] * state[2, 1]
            acceleration = (1.0 - 2.0 * against) * along
            for move in range(moves):
                eased = max(1.0 - AUTHORITY * jerk * end_s[move] / size, 0.0)
                upper[row + move] = max(pushes[against, side], eased * acceleration) - acceleration
            row += moves
    lower[row:] = 0.0


@compiled_kernel
def vertical_bounds(
    x: Array,
    floor_m: Array,
    lead_s: float,
    limits: tuple[float, float, float, float],
    node_s: Array,
    end_s: Array,
    rows: Bounds,
) -> None:
    """Write the bounds of the rows of `constraints.vertical_rows` in state `x` (3,).

    Args:
        x: (3,) position, velocity and acceleration.
        floor_m: (n,) the lowest position; it is lowered to what can be kept.
        lead_s: as `constraints.vertical_rows` has it.
        limits: of descent, climb, acceleration and jerk.
        node_s: (n,).
        end_s: (m,).
        rows: (c,) each, where they are written.
    """
    lower, upper = rows
    pull, jerk = limits[2], limits[3]
    moves, nodes = len(end_s), len(node_s)
    lower[:], upper[:] = -math.inf, math.inf
    lower[:moves], upper[:moves] = -jerk, jerk
    row = moves
    for side in range(2):
        way = 2.0 * side - 1.0
        velocity, acceleration = way * x[1], way * x[2]
        for node in range(nodes):
            t_s = node_s[node]
            left = velocity_left(velocity, acceleration, AUTHORITY * pull, AUTHORITY * jerk, t_s)
            upper[row + node] = max(limits[side], left) - velocity - acceleration * t_s
        row += nodes
    for side in range(2):
        acceleration = (2.0 * side - 1.0) * x[2]
        for move in range(moves):
            eased = acceleration - AUTHORITY * jerk * end_s[move]
            upper[row + move] = max(pull, eased) - acceleration
        row += moves
    floor = reachable_floor(floor_m, x, pull, limits[1], jerk, lead_s, node_s)
    for node in range(nodes):
        t_s = node_s[node]
        lower[row + node] = floor[node] - x[0] - (x[1] + 0.5 * x[2] * t_s) * t_s - lead_s * (x[1] + x[2] * t_s)
    lower[row + nodes :] = 0.0
