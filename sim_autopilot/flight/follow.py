"""Following somebody who tells by FOLLOW_TARGET where he is: PX4's follow-me.

State: the leader's position and velocity in W (m, m/s) as last told, their smoothed counterparts (critically enough
damped second order, without lag at constant speed), the course that he was last seen to move on, and the angle at
which the drone stands about him, which turns no faster than FLW_TGT_MAX_VEL along the circle. Above the height that
it keeps it goes straight up or down first. Source: PX4 parameter reference, FLW_TGT_*, and its follow-me documentation.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

import numpy as np

from link.frames.rotations import wrap_angle
from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.core.pilot_settings import FollowSettings
from sim_autopilot.plant.snapshot import Snapshot

_LOST_S = 3.0
"""Without a word he is believed to have stopped."""
_BANDWIDTH_RAD_S, _DAMPING = 1.0, 0.7071
_MOVES_M_S = 1.0
"""Slower than this he has no course of his own: it stays."""
_LEVEL_M = 3.0
"""Farther from its height than this the drone only climbs or sinks."""
_TURNS_BEYOND_M = 1.0
"""Nearer to him than this the heading stays."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Leader:
    """Who is followed: where he was said to be at `told_ns` since boot, in W, and how he moves."""

    told_ns: int
    position_enu_m: Vector3
    velocity_enu_m_s: Vector3


@dataclass(frozen=True, slots=True, kw_only=True)
class Chase:
    """What the mode remembers of the leader: smoothed, his course (of W, North at first) and the drone's angle."""

    position_enu_m: Vector3
    velocity_enu_m_s: Vector3
    course_rad: float = pi / 2.0
    angle_rad: float = pi / 2.0


def with_word(
    before: Leader | None, position_enu_m: Vector3, velocity_enu_m_s: Vector3, boot_ns: int, smoothing: float
) -> Leader:
    """Return the leader after he told where he is, in W."""
    if before is not None:
        expected = _carry_on(before, boot_ns).position_enu_m
        pairs = zip(position_enu_m, expected, strict=True)
        x, y, z = (told + smoothing * (guess - told) for told, guess in pairs)
        position_enu_m = (x, y, z)
    return Leader(told_ns=boot_ns, position_enu_m=position_enu_m, velocity_enu_m_s=velocity_enu_m_s)


def chase_leader(
    chase: Chase | None,
    leader: Leader,
    now: Snapshot,
    home_enu_m: Vector3,
    *,
    settings: FollowSettings,
    elapsed_s: float,
) -> tuple[Chase, Reference]:
    """Return what the mode remembers `elapsed_s` later, and what the drone is to follow until then."""
    leader = _carry_on(leader, now.boot_ns)
    if chase is None:
        chase = Chase(position_enu_m=leader.position_enu_m, velocity_enu_m_s=leader.velocity_enu_m_s)
    chase = _turn(_smooth(chase, leader, elapsed_s), leader, settings, elapsed_s)
    x, y, z = chase.position_enu_m
    height_m = (z if settings.with_him else home_enu_m[2]) + settings.height_m
    east, north = x - now.position_enu_m[0], y - now.position_enu_m[1]
    yaw_rad = atan2(north, east) if hypot(east, north) > _TURNS_BEYOND_M else None
    if abs(height_m - now.position_enu_m[2]) > _LEVEL_M:
        place, velocity = (*now.position_enu_m[:2], height_m), (0.0, 0.0, 0.0)
    else:
        r = settings.distance_m
        place = (x + r * cos(chase.angle_rad), y + r * sin(chase.angle_rad), height_m)
        velocity = (*chase.velocity_enu_m_s[:2], 0.0)
    reference = Reference(
        position_enu_m=np.array(place),
        velocity_enu_m_s=np.array(velocity),
        acceleration_enu_m_s2=None,
        yaw_rad=yaw_rad,
    )
    return chase, reference


def _carry_on(leader: Leader, boot_ns: int) -> Leader:
    """Where he is by now, if he has gone on as he said; after a long silence he stands."""
    since_s = (boot_ns - leader.told_ns) * 1e-9
    moved_s = min(since_s, _LOST_S)
    x, y, z = (at + speed * moved_s for at, speed in zip(leader.position_enu_m, leader.velocity_enu_m_s, strict=True))
    velocity = leader.velocity_enu_m_s if since_s < _LOST_S else (0.0, 0.0, 0.0)
    return Leader(told_ns=boot_ns, position_enu_m=(x, y, z), velocity_enu_m_s=velocity)


def _smooth(chase: Chase, leader: Leader, elapsed_s: float) -> Chase:
    position, velocity = np.array(chase.position_enu_m), np.array(chase.velocity_enu_m_s)
    off = np.array(leader.position_enu_m) - position
    acceleration = _BANDWIDTH_RAD_S**2 * off + 2.0 * _DAMPING * _BANDWIDTH_RAD_S * (leader.velocity_enu_m_s - velocity)
    velocity += acceleration * elapsed_s
    x, y, z = (position + velocity * elapsed_s).tolist()
    vx, vy, vz = velocity.tolist()
    return replace(chase, position_enu_m=(x, y, z), velocity_enu_m_s=(vx, vy, vz))


def _turn(chase: Chase, leader: Leader, settings: FollowSettings, elapsed_s: float) -> Chase:
    vx, vy, _ = chase.velocity_enu_m_s
    moves = min(hypot(vx, vy), hypot(*leader.velocity_enu_m_s[:2])) >= _MOVES_M_S
    course_rad = atan2(vy, vx) if moves else chase.course_rad
    most_rad = settings.along_m_s / settings.distance_m * elapsed_s
    missing_rad = wrap_angle(course_rad - settings.angle_rad - chase.angle_rad)
    angle_rad = wrap_angle(chase.angle_rad + max(-most_rad, min(most_rad, missing_rad)))
    return replace(chase, course_rad=course_rad, angle_rad=angle_rad)
