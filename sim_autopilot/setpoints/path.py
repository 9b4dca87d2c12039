"""A path with bounded jerk that is led to a target by its error: how ArduCopter turns setpoints into a flyable motion.

State: position p, velocity v, acceleration a; the target has p_t, v_t, a_t. Each instant

    v_wanted = s(p_t - p; j / 2A, A / 2), at most V, plus v_t
    a_wanted = s(v_wanted - v; j / A, j), at most A, plus a_t
    a moves towards a_wanted by at most j dt

with the square-root law `s(e; k, b) = k e` up to `b / k^2` and `sqrt(2 b (e - b / 2k^2))` beyond. V, A and j are the
limits of speed, acceleration and jerk: V and A bound corrections only, never what the target brings along. Horizontally
the vectors are limited by their length, and of the acceleration at least 1 / sqrt(2) is left across the wanted motion.
Source: the behaviour of ArduPilot's AP_Math control functions; the equations are theirs, the code is not.
"""

from math import copysign, hypot, sqrt

from msgspec import Struct

from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.limits import PathLimits

Plane = tuple[float, float]


class Motion(Struct, frozen=True, kw_only=True):
    """Position (m), velocity (m/s) and acceleration (m/s2) in W."""

    position: Vector3
    velocity: Vector3 = (0.0, 0.0, 0.0)
    acceleration: Vector3 = (0.0, 0.0, 0.0)


class PathSpeed(Struct, frozen=True, kw_only=True):
    """How fast a position error is corrected at most."""

    horizontal_m_s: float
    climb_m_s: float
    descent_m_s: float


class Blocked(Struct, frozen=True, kw_only=True):
    """Where the drone cannot follow: the acceleration that it asked for in vain, and its own place and speed."""

    direction: Plane
    position: Vector3
    velocity: Vector3


def square_root_law(error: float, slope_per_s: float, limit: float, dt_s: float) -> float:
    """Return the rate at which `error` is made smaller, never so fast that one step overshoots."""
    size = abs(error)
    linear = limit / (slope_per_s * slope_per_s)
    rate = slope_per_s * size if size <= linear else sqrt(2.0 * limit * (size - 0.5 * linear))
    return copysign(min(rate, size / dt_s), error)


def carry_on(motion: Motion, dt_s: float, blocked: Blocked | None = None) -> Motion:
    """Return `motion` after `dt_s` of its own velocity and acceleration, not farther into what is `blocked`."""
    x, y, z = motion.position
    u, v, w = motion.velocity
    a, b, c = motion.acceleration
    move = (u * dt_s + 0.5 * a * dt_s * dt_s, v * dt_s + 0.5 * b * dt_s * dt_s)
    gain = (a * dt_s, b * dt_s)
    if blocked is not None:
        ahead = (x - blocked.position[0], y - blocked.position[1])
        faster = (ahead[0] + u - blocked.velocity[0], ahead[1] + v - blocked.velocity[1])
        move = _unless_towards(move, ahead, blocked.direction)
        gain = _unless_towards(gain, faster, blocked.direction)
    return replace(
        motion,
        position=(x + move[0], y + move[1], z + w * dt_s + 0.5 * c * dt_s * dt_s),
        velocity=(u + gain[0], v + gain[1], w + c * dt_s),
    )


def _unless_towards(change: Plane, error: Plane, direction: Plane) -> Plane:
    towards = _dot(change, direction) > 0.0 and _dot(error, direction) > 0.0
    return (0.0, 0.0) if towards else change


def lead_to_position(path: Motion, target: Motion, limits: PathLimits, speed: PathSpeed, dt_s: float) -> Motion:
    """Return `path` with the acceleration that leads it to `target`; `speed` bounds the correction."""
    horizontal, slope = limits.acceleration_m_s2, 0.5 * limits.jerk_m_s3 / limits.acceleration_m_s2
    error = (target.position[0] - path.position[0], target.position[1] - path.position[1])
    correction = _clip(_law(error, slope, 0.5 * horizontal, dt_s), speed.horizontal_m_s)
    rising = limits.vertical_acceleration_m_s2
    height = target.position[2] - path.position[2]
    climb = square_root_law(height, 0.5 * limits.vertical_jerk_m_s3 / rising, 0.5 * rising, dt_s)
    climb = max(-speed.descent_m_s, min(speed.climb_m_s, climb))
    u, v, w = target.velocity
    wanted = replace(target, velocity=(u + correction[0], v + correction[1], w + climb))
    return lead_to_velocity(path, wanted, limits, dt_s)


def lead_to_velocity(path: Motion, target: Motion, limits: PathLimits, dt_s: float) -> Motion:
    """Return `path` with the acceleration that leads it to the target's velocity."""
    most, jerk = limits.acceleration_m_s2, limits.jerk_m_s3
    wanted = (target.velocity[0], target.velocity[1])
    error = (wanted[0] - path.velocity[0], wanted[1] - path.velocity[1])
    correction = _corner(_law(error, jerk / most, jerk, dt_s), wanted, most)
    most_up, jerk_up = limits.vertical_acceleration_m_s2, limits.vertical_jerk_m_s3
    up = square_root_law(target.velocity[2] - path.velocity[2], jerk_up / most_up, jerk_up, dt_s)
    up = max(-most_up, min(most_up, up))
    a, b, c = target.acceleration
    return lead_to_acceleration(path, (a + correction[0], b + correction[1], c + up), limits, dt_s)


def lead_to_acceleration(path: Motion, wanted: Vector3, limits: PathLimits, dt_s: float) -> Motion:
    """Return `path` with its acceleration brought nearer to `wanted`, as fast as the jerk allows."""
    a, b, c = path.acceleration
    step = _clip((wanted[0] - a, wanted[1] - b), limits.jerk_m_s3 * dt_s)
    most_up = limits.vertical_jerk_m_s3 * dt_s
    return replace(path, acceleration=(a + step[0], b + step[1], c + max(-most_up, min(most_up, wanted[2] - c))))


def correction_speed(limits: PathLimits) -> PathSpeed:
    """Return the bounds of corrections beside a velocity that is given."""
    return PathSpeed(horizontal_m_s=limits.speed_m_s, climb_m_s=limits.climb_m_s, descent_m_s=limits.descent_m_s)


def straight_speed(path: Motion, goal: Vector3, limits: PathLimits) -> PathSpeed:
    """Return the bounds with which a path runs straight to `goal`: no axis faster than the slowest one allows."""
    x, y, z = (g - p for g, p in zip(goal, path.position, strict=True))
    level = hypot(x, y)
    length = hypot(level, z)
    if length == 0.0:
        return PathSpeed(horizontal_m_s=0.0, climb_m_s=0.0, descent_m_s=0.0)
    vertical_max = limits.climb_m_s if z > 0.0 else limits.descent_m_s
    along = min(
        limits.speed_m_s * length / level if level > 0.0 else vertical_max,
        vertical_max * length / abs(z) if z != 0.0 else limits.speed_m_s,
    )
    vertical = along * abs(z) / length
    return PathSpeed(horizontal_m_s=along * level / length, climb_m_s=vertical, descent_m_s=vertical)


def _law(error: Plane, slope_per_s: float, limit: float, dt_s: float) -> Plane:
    size = hypot(*error)
    if size == 0.0:
        return (0.0, 0.0)
    scale = square_root_law(size, slope_per_s, limit, dt_s) / size
    return (error[0] * scale, error[1] * scale)


def _corner(wanted: Plane, velocity: Plane, most: float) -> Plane:
    """`wanted` of length `most` at most, its part across `velocity` kept up to 1 / sqrt(2) of that."""
    speed = hypot(*velocity)
    if speed == 0.0:
        return _clip(wanted, most)
    ahead = (velocity[0] / speed, velocity[1] / speed)
    along = _dot(wanted, ahead)
    across = (wanted[0] - along * ahead[0], wanted[1] - along * ahead[1])
    if along * along <= _dot(across, across):
        return _clip(wanted, most)
    across = _clip(across, most / sqrt(2.0))
    left = sqrt(most * most - _dot(across, across))
    along = max(-left, min(left, along))
    return (across[0] + along * ahead[0], across[1] + along * ahead[1])


def _clip(vector: Plane, most: float) -> Plane:
    size = hypot(*vector)
    if size <= most:
        return vector
    return (vector[0] * most / size, vector[1] * most / size)


def _dot(one: Plane, other: Plane) -> float:
    return one[0] * other[0] + one[1] * other[1]
