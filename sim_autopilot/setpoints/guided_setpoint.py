"""What ArduCopter's GUIDED mode understands a SET_POSITION_TARGET_LOCAL_NED to ask for.

Each of position, velocity and acceleration counts only when none of its three is masked out. Position with velocity,
velocity, acceleration, or position alone are flown; anything else, a frame that is not known, and a used value that is
no number stop the drone. (The real one's estimate does not survive a position that is no number.)
"""

from enum import Enum
from math import cos, isfinite, pi, sin

from msgspec import Struct

from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.core.places import Origin, world_from_local
from sim_autopilot.plant.snapshot import Snapshot

_POSITION = 0b0000_0000_0000_0111
_VELOCITY = 0b0000_0000_0011_1000
_ACCELERATION = 0b0000_0001_1100_0000
_FORCE = 0b0000_0010_0000_0000
_YAW = 0b0000_0100_0000_0000
_YAW_RATE = 0b0000_1000_0000_0000
_NONE = (0.0, 0.0, 0.0)
_BODY = (mavlink.MAV_FRAME_BODY_NED, mavlink.MAV_FRAME_BODY_OFFSET_NED)


class Task(Enum):
    """What GUIDED does."""

    POSITION = 0  # flies to a place, and stops there
    FOLLOW = 1  # position with velocity
    VELOCITY = 2  # also how it stands still
    ACCELERATION = 3
    TAKEOFF = 4


class Wish(Struct, frozen=True, kw_only=True):
    """A setpoint in W; what it does not give is zero, a heading None."""

    task: Task
    position: Vector3 = _NONE
    velocity: Vector3 = _NONE
    acceleration: Vector3 = _NONE
    yaw_rad: float | None = None
    yaw_rate_rad_s: float | None = None


STOP = Wish(task=Task.VELOCITY)


def wish_from_message(message: Message, frames: frozenset[int], origin: Origin, now: Snapshot) -> Wish | None:
    """Return what a SET_POSITION_TARGET_LOCAL_NED asks for; None where it changes nothing.

    Args:
        message: the setpoint.
        frames: MAV_FRAMEs that are understood.
        origin: the local frame.
        now: the drone, for the frames that are about it.
    """
    mask, frame = message.type_mask, message.coordinate_frame
    if frame not in frames:
        return STOP
    has_position, has_velocity, has_acceleration = (not mask & group for group in (_POSITION, _VELOCITY, _ACCELERATION))
    if mask & _FORCE and has_acceleration:
        return None
    task = _task(position=has_position, velocity=has_velocity, acceleration=has_acceleration)
    if task is None:
        return STOP
    wish = Wish(
        task=task,
        position=_place(message, origin, now) if has_position else _NONE,
        velocity=_vector((message.vx, message.vy, message.vz), frame, now) if has_velocity else _NONE,
        acceleration=_vector((message.afx, message.afy, message.afz), frame, now) if has_acceleration else _NONE,
        yaw_rad=None if mask & _YAW else _yaw(message, now),
        yaw_rate_rad_s=None if mask & _YAW_RATE else -message.yaw_rate,
    )
    return wish if _is_finite(wish) else STOP


def _task(*, position: bool, velocity: bool, acceleration: bool) -> Task | None:
    if velocity:
        return Task.FOLLOW if position else Task.VELOCITY
    if position:
        return None if acceleration else Task.POSITION
    return Task.ACCELERATION if acceleration else None


def _place(message: Message, origin: Origin, now: Snapshot) -> Vector3:
    x, y, z = place = _vector((message.x, message.y, message.z), message.coordinate_frame, now)
    if message.coordinate_frame == mavlink.MAV_FRAME_LOCAL_NED:
        return world_from_local(origin, place) if all(map(isfinite, place)) else place
    east, north, up = now.position_enu_m
    return (east + x, north + y, up + z)


def _vector(ned: Vector3, frame: int, now: Snapshot) -> Vector3:
    """ENU of a vector given in NED, or in axes forward, right, down."""
    x, y, z = ned
    if frame not in _BODY:
        return (y, x, -z)
    c, s = cos(now.yaw_rad), sin(now.yaw_rad)
    return (c * x + s * y, s * x - c * y, -z)


def _yaw(message: Message, now: Snapshot) -> float:
    if message.coordinate_frame in _BODY:
        return float(now.yaw_rad - message.yaw)
    return float(pi / 2.0 - message.yaw)


def _is_finite(wish: Wish) -> bool:
    heading = (wish.yaw_rad or 0.0, wish.yaw_rate_rad_s or 0.0)
    return all(map(isfinite, (*wish.position, *wish.velocity, *wish.acceleration, *heading)))
