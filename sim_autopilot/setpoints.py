"""Setpoints from the companion: what SET_POSITION_TARGET_LOCAL_NED asks for, and whether the stream of them is alive.

A setpoint is held as it came, never extrapolated. One that cannot be understood is dropped whole: masks take each of
position, velocity and acceleration all or not at all, and every value used must be finite.
"""

from dataclasses import dataclass
from math import cos, isfinite, pi, sin

import numpy as np

from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.data import Array, Reference

_POSITION = 0b0000_0000_0000_0111
_VELOCITY = 0b0000_0000_0011_1000
_ACCELERATION = 0b0000_0001_1100_0000
_FORCE = 0b0000_0010_0000_0000
_YAW = 0b0000_0100_0000_0000
_YAW_RATE = 0b0000_1000_0000_0000
_GROUPS = (_POSITION, _VELOCITY, _ACCELERATION)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Setpoints:
    """The last setpoint, when it came, and since when they have come without a gap; times in ns since boot."""

    reference: Reference | None = None
    received_ns: int = 0
    since_ns: int = 0


NO_SETPOINTS = Setpoints()


def reference_from_message(
    message: Message, frames: frozenset[int], origin_enu_m: Vector3, yaw_rad: float
) -> Reference | None:
    """Return what a SET_POSITION_TARGET_LOCAL_NED asks for in W, None where it asks for nothing that can be flown.

    Args:
        message: the setpoint.
        frames: MAV_FRAMEs that are understood; in MAV_FRAME_BODY_NED a position is left out, as PX4 does.
        origin_enu_m: of the autopilot's local frame in W.
        yaw_rad: the drone's present heading, for MAV_FRAME_BODY_NED.
    """
    mask, frame = message.type_mask, message.coordinate_frame
    if frame not in frames or mask & _FORCE or any(mask & group not in (0, group) for group in _GROUPS):
        return None
    body = frame == mavlink.MAV_FRAME_BODY_NED
    if body:
        mask |= _POSITION
    if mask & (_POSITION | _VELOCITY | _ACCELERATION) == _POSITION | _VELOCITY | _ACCELERATION:
        return None
    if not all(map(isfinite, _values_used(message, mask))):
        return None
    position = velocity = acceleration = None
    if not mask & _POSITION:
        east, north, up = origin_enu_m
        position = np.array((east + message.y, north + message.x, up - message.z))
    if not mask & _VELOCITY:
        velocity = _enu(message.vx, message.vy, message.vz, body, yaw_rad)
    if not mask & _ACCELERATION:
        acceleration = _enu(message.afx, message.afy, message.afz, body, yaw_rad)
    return Reference(
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
        yaw_rad=None if mask & _YAW else pi / 2.0 - message.yaw,
        yaw_rate_rad_s=None if mask & _YAW_RATE else -message.yaw_rate,
    )


def with_setpoint(setpoints: Setpoints, reference: Reference, boot_ns: int, loss_s: float) -> Setpoints:
    """Return the memory after a setpoint that came at `boot_ns`."""
    unbroken = are_fresh(setpoints, boot_ns, loss_s)
    return Setpoints(reference=reference, received_ns=boot_ns, since_ns=setpoints.since_ns if unbroken else boot_ns)


def are_fresh(setpoints: Setpoints, boot_ns: int, loss_s: float) -> bool:
    """Return whether the last setpoint is not older than `loss_s`."""
    return setpoints.reference is not None and (boot_ns - setpoints.received_ns) * 1e-9 <= loss_s


def are_streaming(setpoints: Setpoints, boot_ns: int, loss_s: float, stream_s: float) -> bool:
    """Return whether setpoints are fresh and have been for `stream_s`."""
    return are_fresh(setpoints, boot_ns, loss_s) and (boot_ns - setpoints.since_ns) * 1e-9 >= stream_s


def _values_used(message: Message, mask: int) -> list[float]:
    used: list[float] = []
    if not mask & _POSITION:
        used += (message.x, message.y, message.z)
    if not mask & _VELOCITY:
        used += (message.vx, message.vy, message.vz)
    if not mask & _ACCELERATION:
        used += (message.afx, message.afy, message.afz)
    if not mask & _YAW:
        used.append(message.yaw)
    if not mask & _YAW_RATE:
        used.append(message.yaw_rate)
    return used


def _enu(x: float, y: float, z: float, body: bool, yaw_rad: float) -> Array:
    """ENU of a vector given in NED, or in axes forward, right, down."""
    if not body:
        return np.array((y, x, -z))
    c, s = cos(yaw_rad), sin(yaw_rad)
    return np.array((c * x + s * y, s * x - c * y, -z))
