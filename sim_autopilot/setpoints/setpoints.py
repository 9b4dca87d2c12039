"""Setpoints from the companion: what SET_POSITION_TARGET_LOCAL_NED asks for, and whether the stream of them is alive.

A setpoint is held as it came, never extrapolated. One that cannot be understood is dropped whole: its mask must be one
that is flown (`partial_setpoints`), and every value used must be finite.
"""

from math import cos, hypot, isfinite, pi, radians, sin

import numpy as np
from msgspec import Struct

from link.frames.geodesy import geodetic_from_enu, local_from_geodetic
from link.frames.rotations import enu_from_ned, ned_from_enu
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.core.places import (
    ABOVE_HOME,
    ABOVE_SEA,
    ABOVE_TERRAIN,
    REACH_M,
    Origin,
    local_from_world,
    world_from_local,
)
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.setpoints.partial import Axes, read_mask

_POSITION = 0b0000_0000_0000_0111
_VELOCITY = 0b0000_0000_0011_1000
_ACCELERATION = 0b0000_0001_1100_0000
_FORCE = 0b0000_0010_0000_0000
_YAW = 0b0000_0100_0000_0000
_YAW_RATE = 0b0000_1000_0000_0000


class Setpoints(Struct, frozen=True, kw_only=True, eq=False):
    """The last setpoint, when it came, and since when they have come without a gap; times in ns since boot."""

    reference: Reference | None = None
    received_ns: int = 0
    since_ns: int = 0


NO_SETPOINTS = Setpoints()


def reference_from_message(message: Message, frames: frozenset[int], origin: Origin, now: Snapshot) -> Reference | None:
    """Return what a SET_POSITION_TARGET_LOCAL_NED asks for in W, None where it asks for nothing that can be flown.

    Args:
        message: the setpoint.
        frames: MAV_FRAMEs that are understood; in MAV_FRAME_BODY_NED a position is left out, as PX4 does.
        origin: the autopilot's local frame.
        now: the drone, for what a setpoint leaves free and for the heading in MAV_FRAME_BODY_NED.
    """
    mask, frame = message.type_mask, message.coordinate_frame
    if frame not in frames or mask & _FORCE:
        return None
    body = frame == mavlink.MAV_FRAME_BODY_NED
    if body:
        mask |= _POSITION | sum(group for group in (_VELOCITY, _ACCELERATION) if mask & group)
    given = read_mask(mask)
    if given is None or not all(map(isfinite, _values_used(message, mask))):
        return None
    position = velocity = acceleration = None
    if any(given.position):
        position = np.array(_place((message.x, message.y, message.z), given.position, origin, now))
    if any(given.velocity):
        velocity = _enu(*_known((message.vx, message.vy, message.vz), given.velocity), body, now.yaw_rad)
    if any(given.acceleration):
        acceleration = _enu(*_known((message.afx, message.afy, message.afz), given.acceleration), body, now.yaw_rad)
    return Reference(
        free_position=given.free_position,
        free_velocity=given.free_velocity,
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
    velocity, acceleration = (message.vx, message.vy, message.vz), (message.afx, message.afy, message.afz)
    values = (message.x, message.y, message.z, *velocity, *acceleration)
    used = [value for bit, value in enumerate(values) if not mask >> bit & 1]
    if not mask & _YAW:
        used.append(message.yaw)
    if not mask & _YAW_RATE:
        used.append(message.yaw_rate)
    return used


def _place(ned: Vector3, given: Axes, origin: Origin, now: Snapshot) -> Vector3:
    """Return a place in W; along an axis that is not given it is the drone's own, for the others depend on it."""
    if not all(given):
        here = ned_from_enu(local_from_world(origin, now.position_enu_m))
        x, y, z = (value if one else own for value, own, one in zip(ned, here, given, strict=True))
        ned = (x, y, z)
    return world_from_local(origin, enu_from_ned(ned))


def _known(vector: Vector3, given: Axes) -> Vector3:
    """The vector with zeros where nothing is given."""
    x, y, z = (value if one else 0.0 for value, one in zip(vector, given, strict=True))
    return x, y, z


def _enu(x: float, y: float, z: float, body: bool, yaw_rad: float) -> Array:
    """ENU of a vector given in NED, or in axes forward, right, down."""
    if not body:
        return np.array((y, x, -z))
    c, s = cos(yaw_rad), sin(yaw_rad)
    return np.array((c * x + s * y, s * x - c * y, -z))


_NO_POSITION = 0b111


def local_setpoint(
    message: Message, origin: Origin, home_enu_m: Vector3, *, knows_terrain: bool = False
) -> Message | None:
    """Return the SET_POSITION_TARGET_LOCAL_NED of a global setpoint, None for a frame or a place that is not flown.

    Args:
        message: the setpoint.
        origin: the autopilot's local frame.
        home_enu_m: in W, what relative altitudes are above.
        knows_terrain: whether altitudes above the ground are flown.
    """
    above_ground = ABOVE_HOME | ABOVE_TERRAIN if knows_terrain else ABOVE_HOME
    if message.coordinate_frame not in ABOVE_SEA | above_ground:
        return None
    north = east = down = 0.0
    if message.type_mask & _NO_POSITION != _NO_POSITION:
        latitude_rad, longitude_rad = radians(message.lat_int * 1e-7), radians(message.lon_int * 1e-7)
        altitude_m = message.alt
        if message.coordinate_frame in above_ground:
            altitude_m += geodetic_from_enu(origin.world, home_enu_m)[2]
        north, east, down = ned_from_enu(local_from_geodetic(origin.frame, latitude_rad, longitude_rad, altitude_m))
        if hypot(north, east) > REACH_M:
            return None
    return mavlink.MAVLink_set_position_target_local_ned_message(
        message.time_boot_ms,
        message.target_system,
        message.target_component,
        mavlink.MAV_FRAME_LOCAL_NED,
        message.type_mask,
        north,
        east,
        down,
        *(message.vx, message.vy, message.vz, message.afx, message.afy, message.afz, message.yaw, message.yaw_rate),
    )
