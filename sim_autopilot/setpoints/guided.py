"""ArduCopter's GUIDED mode: a shaped path that setpoints lead, and the take-off that is a part of the mode."""

from enum import Enum
from math import atan2, hypot

import numpy as np
from msgspec import Struct

from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.core.limits import PathLimits
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.setpoints.guided_attitude import AttitudeWish, attitude_flown, level_out
from sim_autopilot.setpoints.guided_setpoint import STOP, Task, Wish
from sim_autopilot.setpoints.path import (
    Blocked,
    Motion,
    Plane,
    carry_on,
    correction_speed,
    lead_to_acceleration,
    lead_to_position,
    lead_to_velocity,
    straight_speed,
)

_SPOOL_S = 1.6
"""From the command until the throttle begins to rise; with TKOFF_SLEW_TIME 2 s it lifts off 3.6 s after the command."""
_AHEAD_MIN_M_S = 1.0
"""Slower than this the nose does not turn along the way."""
_AHEAD_MIN_M = 2.0
"""To a place nearer than this it does not turn."""
_PRESS_M = 1.0
"""How far the path runs ahead of a drone that cannot sink."""
_COMPLETE_SHARE = 0.1
"""A take-off is complete when the path climbs by less than this part of its limit, and is as near as that brakes in."""


class Stage(Enum):
    """Of a take-off."""

    NONE = 0
    RUN_UP = 1  # on the ground still
    CLIMB = 2


class Guided(Struct, frozen=True, kw_only=True):
    """What GUIDED remembers; times in ns since boot.

    Attributes:
        wish: the setpoint, its position and velocity carried on since it came.
        updated_ns: when that was.
        path: what is flown.
        yaw_rad: the heading that is kept to while nothing else is asked for.
        stage: of the take-off under way.
        attitude: flown in place of the wish; its height is the path's.
        speed_m_s: that was asked for, horizontally; None is the parameters'.
    """

    wish: Wish
    updated_ns: int
    path: Motion
    yaw_rad: float
    stage: Stage = Stage.NONE
    attitude: AttitudeWish | None = None
    speed_m_s: float | None = None


def begin_guided(now: Snapshot) -> Guided:
    """Return the memory of a mode that has just been entered: it stops."""
    return Guided(wish=STOP, updated_ns=now.boot_ns, path=_path_from(now), yaw_rad=now.yaw_rad)


def with_wish(guided: Guided, wish: Wish, now: Snapshot) -> Guided:
    """Return the memory after a setpoint; another kind of task begins its path where the drone is."""
    goes_on = wish.task is guided.wish.task and guided.attitude is None
    path = guided.path if goes_on else _path_from(now)
    return replace(guided, wish=wish, updated_ns=now.boot_ns, path=path, stage=Stage.NONE, attitude=None)


def with_attitude(guided: Guided, attitude: AttitudeWish, now: Snapshot) -> Guided:
    """Return the memory after an attitude setpoint; the first of them holds the height that the drone has."""
    path = _path_from(now) if guided.attitude is None else guided.path
    return replace(guided, attitude=attitude, updated_ns=now.boot_ns, path=path, stage=Stage.NONE)


def with_takeoff(guided: Guided, height_m: float, now: Snapshot) -> Guided:
    """Return the memory after the command to take off to the height `height_m` in W."""
    x, y, _ = now.position_enu_m
    wish = Wish(task=Task.TAKEOFF, position=(x, y, height_m), yaw_rad=now.yaw_rad)
    path = _path_from(now)
    return replace(guided, wish=wish, updated_ns=now.boot_ns, path=path, stage=Stage.RUN_UP, attitude=None)


def with_destination(guided: Guided, place: Vector3, now: Snapshot) -> Guided:
    """Return the memory after the command to fly to `place` in W, the nose ahead."""
    x, y, _ = (to - at for to, at in zip(place, now.position_enu_m, strict=True))
    ahead = atan2(y, x) if hypot(x, y) > _AHEAD_MIN_M else None
    return with_wish(guided, Wish(task=Task.POSITION, position=place, yaw_rad=ahead), now)


def with_guided_speed(guided: Guided, speed_m_s: float) -> Guided:
    """Return the memory after the command to fly at most at `speed_m_s`, which lasts as long as the mode."""
    return replace(guided, speed_m_s=speed_m_s)


def with_heading(guided: Guided, yaw_rad: float) -> Guided:
    """Return the memory after the command to turn to `yaw_rad` (of W), which lasts until the next setpoint."""
    return replace(guided, wish=replace(guided.wish, yaw_rad=yaw_rad, yaw_rate_rad_s=None))


def is_rising(guided: Guided) -> bool:
    """Return whether a take-off has left the ground and is not complete."""
    return guided.stage is Stage.CLIMB


def has_run_up(guided: Guided, now: Snapshot, limits: PathLimits) -> bool:
    """Return whether a drone that was told to take off, or to rise by its attitude setpoint, leaves the ground now."""
    if guided.attitude is not None:
        return guided.attitude.rises
    since_s = (now.boot_ns - guided.updated_ns) * 1e-9
    return guided.stage is Stage.RUN_UP and since_s >= _SPOOL_S + limits.throttle_slew_s


def lift(guided: Guided, now: Snapshot) -> Guided:
    """Return the memory of a take-off that leaves the ground."""
    return replace(guided, stage=Stage.NONE if guided.attitude else Stage.CLIMB, path=_path_from(now))


def on_the_ground(guided: Guided, now: Snapshot) -> Guided:
    """Return the memory of a drone that stands: its path begins here."""
    return replace(guided, path=_path_from(now), yaw_rad=now.yaw_rad)


def next_guided(
    guided: Guided, now: Snapshot, limits: PathLimits, dt_s: float, missed: Plane | None
) -> tuple[Guided, Reference]:
    """Return the memory `dt_s` later, and what to follow until then; the path waits where acceleration is `missed`."""
    wish = guided.wish
    silent = (now.boot_ns - guided.updated_ns) * 1e-9 > limits.timeout_s
    if guided.attitude is not None:
        return _next_attitude(guided, level_out(now) if silent else guided.attitude, now, dt_s)
    if silent and wish.task is not Task.TAKEOFF:
        wish = _without_motion(wish)
    if guided.speed_m_s is not None:
        limits = replace(limits, speed_m_s=guided.speed_m_s)
    path = _lead(guided.path, wish, limits, dt_s)
    yaw_rad = _heading(guided, wish, now)
    reference = Reference(
        position_enu_m=np.array(path.position),
        velocity_enu_m_s=np.array(path.velocity),
        acceleration_enu_m_s2=np.array(path.acceleration),
        yaw_rad=yaw_rad,
        yaw_rate_rad_s=wish.yaw_rate_rad_s,
    )
    blocked = Blocked(direction=missed, position=now.position_enu_m, velocity=now.velocity_enu_m_s) if missed else None
    path = _not_below(carry_on(path, dt_s, blocked), now)
    guided = replace(
        guided,
        wish=_carry_on(wish, dt_s),
        path=path,
        yaw_rad=now.yaw_rad if yaw_rad is None else yaw_rad,
        stage=Stage.NONE if is_rising(guided) and _has_risen(path, wish, limits) else guided.stage,
    )
    return guided, reference


def _next_attitude(guided: Guided, attitude: AttitudeWish, now: Snapshot, dt_s: float) -> tuple[Guided, Reference]:
    height_m = now.position_enu_m[2] + max(-_PRESS_M, min(_PRESS_M, guided.path.position[2] - now.position_enu_m[2]))
    reference = attitude_flown(attitude, height_m, now)
    if attitude.thrust_m_s2 is not None:
        height_m = now.position_enu_m[2]
    x, y, _ = now.position_enu_m
    path = replace(_path_from(now), position=(x, y, height_m + attitude.climb_m_s * dt_s))
    return replace(guided, path=path, yaw_rad=now.yaw_rad), reference


def _path_from(now: Snapshot) -> Motion:
    return Motion(position=now.position_enu_m, velocity=now.velocity_enu_m_s)


def _without_motion(wish: Wish) -> Wish:
    task = Task.VELOCITY if wish.task is Task.ACCELERATION else wish.task
    still = (0.0, 0.0, 0.0)
    return replace(wish, task=task, velocity=still, acceleration=still, yaw_rate_rad_s=None)


def _lead(path: Motion, wish: Wish, limits: PathLimits, dt_s: float) -> Motion:
    target = Motion(position=wish.position, velocity=wish.velocity, acceleration=wish.acceleration)
    match wish.task:
        case Task.VELOCITY:
            return lead_to_velocity(path, target, limits, dt_s)
        case Task.ACCELERATION:
            return lead_to_acceleration(path, wish.acceleration, limits, dt_s)
        case Task.POSITION:
            return lead_to_position(path, target, limits, straight_speed(path, wish.position, limits), dt_s)
        case Task.FOLLOW | Task.TAKEOFF:
            return lead_to_position(path, target, limits, correction_speed(limits), dt_s)


def _carry_on(wish: Wish, dt_s: float) -> Wish:
    if wish.task is not Task.FOLLOW and wish.task is not Task.VELOCITY:
        return wish
    target = Motion(position=wish.position, velocity=wish.velocity, acceleration=wish.acceleration)
    moved = carry_on(target, dt_s)
    yaw_rad = wish.yaw_rad
    if yaw_rad is not None and wish.yaw_rate_rad_s is not None:
        yaw_rad += wish.yaw_rate_rad_s * dt_s
    return replace(wish, position=moved.position, velocity=moved.velocity, yaw_rad=yaw_rad)


def _heading(guided: Guided, wish: Wish, now: Snapshot) -> float | None:
    if wish.yaw_rad is not None:
        return wish.yaw_rad
    if wish.yaw_rate_rad_s is not None:
        return None
    east, north, _ = now.velocity_enu_m_s
    return atan2(north, east) if hypot(east, north) > _AHEAD_MIN_M_S else guided.yaw_rad


def _not_below(path: Motion, now: Snapshot) -> Motion:
    x, y, z = path.position
    return replace(path, position=(x, y, max(z, now.position_enu_m[2] - _PRESS_M)))


def _has_risen(path: Motion, wish: Wish, limits: PathLimits) -> bool:
    slow_m_s = _COMPLETE_SHARE * limits.climb_m_s
    near_m = 0.5 * slow_m_s**2 / limits.vertical_acceleration_m_s2
    return path.velocity[2] < slow_m_s and path.position[2] >= wish.position[2] - near_m
