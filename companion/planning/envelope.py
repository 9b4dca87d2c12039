"""The bounds of the axes' programmes: what each axis may use of the flight limits, and widened where it must be.

The major axis leaves what the minor one needs for the target's own motion; the minor one gets what the major one's plan
leaves of each norm. Bounds are widened just enough for a state that already breaks them to come back as fast as it can.

The widened speed bound is the speed that is left when acceleration is turned around with nearly all of the jerk and
then held at nearly all of the acceleration limit; the widened acceleration bound falls with the jerk; the lowered
floor is the height reached by pulling up likewise, at no more than the climb limit. A floor with a lead bounds the
height that the rate carries on: what sinks slows down towards it. All functions are compiled.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.planning.compiled import compiled_kernel

Three = tuple[float, float, float]

Bounds = tuple[Array, Array]  # the lower and the upper ones of a programme's rows, written in place

AUTHORITY = 0.98
"""Share of the limits that the way back uses, so that the solver has room to follow it."""


@compiled_kernel
def velocity_left(velocity: float, acceleration: float, braking: float, jerk: float, t_s: float) -> float:
    """Return the velocity at `t_s` when the acceleration goes to `-braking` at `jerk` and stays there."""
    turning = min(t_s, max((acceleration + braking) / jerk, 0.0))
    turned = velocity + (acceleration - 0.5 * jerk * turning) * turning
    return turned + min(-braking, acceleration) * (t_s - turning)


@compiled_kernel
def velocity_ceiling(
    bound_m_s: Array, velocity_m_s: float, acceleration_m_s2: float, braking_m_s2: float, jerk_m_s3: float, t_s: Array
) -> Array:
    """Return the upper bound (n,) at `t_s`, at least `bound_m_s` (n,), that a state can keep."""
    braking, jerk = AUTHORITY * braking_m_s2, AUTHORITY * jerk_m_s3
    ceiling = np.empty_like(bound_m_s)
    for i in range(len(t_s)):
        left = velocity_left(velocity_m_s, acceleration_m_s2, braking, jerk, t_s[i])
        ceiling[i] = max(bound_m_s[i], left)
    return ceiling


@compiled_kernel
def acceleration_ceiling(bound_m_s2: Array, acceleration_m_s2: float, jerk_m_s3: float, t_s: Array) -> Array:
    """Return the upper bound (n,) at `t_s`, at least `bound_m_s2` (n,), that a state can keep."""
    ceiling = np.empty_like(bound_m_s2)
    for i in range(len(t_s)):
        ceiling[i] = max(bound_m_s2[i], acceleration_m_s2 - AUTHORITY * jerk_m_s3 * t_s[i])
    return ceiling


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


MINOR_SHARE_MIN = 0.05
"""Share of a norm limit that the minor axis gets even where the major one's plan leaves nothing."""

MINOR_PUSH_FACTOR = 1.1
"""How much more than its way's acceleration the minor axis gets, for the smoothing of the plan."""


@compiled_kernel
def left(norm: float, used: Array) -> Array:
    """Return what is left of a norm limit beside `used` (k,)."""
    rest, least = np.empty_like(used), (MINOR_SHARE_MIN * norm) ** 2
    for i in range(len(used)):
        rest[i] = math.sqrt(max(norm * norm - used[i] * used[i], least))
    return rest


@compiled_kernel
def major_share(
    minor: Array, target_v: Array, target_a: Array, way: Three, norms: Three, node_s: Array, end_s: Array
) -> tuple[Array, Array, Array]:
    """Return speed (n,), acceleration and jerk (m,) that the major axis may use beside what the minor one needs.

    That is the target's own motion and the way's acceleration, and at first what the minor axis moves at now.

    Args:
        minor: (3,) position, velocity and acceleration of the minor axis.
        target_v: (n + 1,) the target's velocity along it, now and at the nodes.
        target_a: (m + 1,) the target's acceleration along it, now and at the ends of the blocks.
        way: split of the acceleration norm, rad; acceleration of the minor axis's way; share of the speed limit
            that the minor axis gets at least.
        norms: of speed, acceleration and jerk.
        node_s: (n,).
        end_s: (m,).
    """
    speed, push, jerk = np.empty_like(node_s), np.empty_like(end_s), np.empty_like(end_s)
    for move in range(len(end_s)):
        push[move] = abs(target_a[move + 1]) + MINOR_PUSH_FACTOR * way[1]
        jerk[move] = math.cos(way[0]) * norms[2]
    least = push.min()
    for node in range(len(node_s)):
        slowing = 0.5 * least * max(node_s[node] - 0.2, 0.0)
        excess = max(abs(minor[1]) - abs(target_v[0]) - slowing, way[2] * norms[0])
        speed[node] = abs(target_v[node + 1]) + excess
    for move in range(len(end_s)):
        easing = abs(minor[2]) - 0.5 * math.sin(way[0]) * norms[2] * end_s[move]
        push[move] = max(easing, push[move])
    return left(norms[0], speed), left(norms[1], push), jerk


@compiled_kernel
def minor_share(
    major: Array, jerk: Array, forced_v: Array, norms: Three, node_s: Array, move_s: Array
) -> tuple[Array, Array, Array]:
    """Return speed (n,), acceleration and jerk (m,) that the major axis's plan leaves of the norms.

    Args:
        major: (3,) position, velocity and acceleration of the major axis.
        jerk: its plan, the first m of (q,).
        forced_v: (n, m) its velocity per jerk.
        norms: of speed, acceleration and jerk.
        node_s: (n,).
        move_s: (m,).
    """
    velocity, push, gained = np.empty_like(node_s), np.empty_like(move_s), 0.0
    for node in range(len(node_s)):
        velocity[node] = major[1] + major[2] * node_s[node]
        for move in range(len(move_s)):
            velocity[node] += forced_v[node, move] * jerk[move]
    for move in range(len(move_s)):
        gained += move_s[move] * jerk[move]
        push[move] = major[2] + gained
    return left(norms[0], velocity), left(norms[1], push), left(norms[2], jerk[: len(move_s)])


@compiled_kernel
def bound_rows(
    x: Array,
    down: Array,
    up: Array,
    push: Array,
    jerk: Array,
    floor: Array,
    lead_s: float,
    node_s: Array,
    end_s: Array,
    rows: Bounds,
) -> None:
    """Write the bounds of moves, slacks, velocity, acceleration and the floor, widened.

    Args:
        x: (3,) position, velocity and acceleration of the axis.
        down: (n,) the largest velocity downwards.
        up: (n,) the largest velocity upwards.
        push: (m,) the largest acceleration.
        jerk: (m,) the largest jerk.
        floor: (n,) the lowest position, or empty.
        lead_s: for how long the rate carries on what the floor bounds.
        node_s: (n,).
        end_s: (m,).
        rows: (c,) each, where they are written.
    """
    lower, upper = rows
    v, a, braking, turning = x[1], x[2], push.min(), jerk.min()
    moves, nodes = len(jerk), len(node_s)
    velocity = moves + (3 if len(floor) else 2)
    acceleration = velocity + 2 * nodes
    for row in range(len(lower)):
        lower[row], upper[row] = -math.inf, math.inf
    for move in range(moves):
        lower[move], upper[move] = -jerk[move], jerk[move]
    for slack in range(moves, velocity):
        lower[slack] = 0.0
    slowest = velocity_ceiling(down, -v, -a, braking, turning, node_s)
    fastest = velocity_ceiling(up, v, a, braking, turning, node_s)
    for node in range(nodes):
        free = v + a * node_s[node]
        lower[velocity + node] = -slowest[node] - free
        upper[velocity + nodes + node] = fastest[node] - free
    least, most = acceleration_ceiling(push, -a, turning, end_s), acceleration_ceiling(push, a, turning, end_s)
    for move in range(moves):
        lower[acceleration + move] = -least[move] - a
        upper[acceleration + moves + move] = most[move] - a
    for node in range(len(floor)):
        fallen = x[0] + (v + 0.5 * a * node_s[node]) * node_s[node]
        lower[acceleration + 2 * moves + node] = floor[node] - fallen - lead_s * (v + a * node_s[node])


@compiled_kernel
def major_bounds(
    state: Array, target_v: Array, target_a: Array, way: Three, norms: Three, node_s: Array, end_s: Array, rows: Bounds
) -> None:
    """Write the bounds of the major axis; `state` (3, 3) has the axes in its columns, see `major_share`."""
    speed, push, jerk = major_share(state[:, 1], target_v, target_a, way, norms, node_s, end_s)
    bound_rows(state[:, 0], speed, speed, push, jerk, np.empty(0), 0.0, node_s, end_s, rows)


@compiled_kernel
def minor_bounds(
    state: Array,
    major_jerk: Array,
    forced_v: Array,
    norms: Three,
    node_s: Array,
    move_s: Array,
    end_s: Array,
    rows: Bounds,
) -> None:
    """Write the bounds of the minor axis; `state` (3, 3) has the axes in its columns, see `minor_share`."""
    speed, push, jerk = minor_share(state[:, 0], major_jerk, forced_v, norms, node_s, move_s)
    bound_rows(state[:, 1], speed, speed, push, jerk, np.empty(0), 0.0, node_s, end_s, rows)


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
    """Write the bounds of the vertical axis in state `x` (3,).

    Args:
        x: (3,) position, velocity and acceleration.
        floor_m: (n,) the lowest position; it is lowered to what can be kept.
        lead_s: as `bound_rows` has it.
        limits: of descent, climb, acceleration and jerk.
        node_s: (n,).
        end_s: (m,).
        rows: (c,) each, where they are written.
    """
    descent, climb, pull, most = limits
    floor = reachable_floor(floor_m, x, pull, climb, most, lead_s, node_s)
    down, up = np.full(len(node_s), descent), np.full(len(node_s), climb)
    bound_rows(x, down, up, np.full(len(end_s), pull), np.full(len(end_s), most), floor, lead_s, node_s, end_s, rows)
