"""ArduCopter's precision landing: LANDING_TARGET steers the LAND mode.

State: the target's position and velocity in W (m, m/s), by an alpha-beta filter over the sightings; without the option
for moving targets the velocity is zero. It counts for 2 s after a sighting. Farther away than PLND_XY_DIST_MAX the
drone does not sink. Source: ArduPilot, AC_PrecLand and LAND's vertical control.
"""

from dataclasses import dataclass
from math import hypot, isfinite, tan

import numpy as np

from link.frames.rotations import enu_from_ned, flu_from_frd, quaternion_from_roll_pitch_yaw, rotate
from link.mavlink.dialect import Message, mavlink
from link.messages import Quaternion, Vector3
from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.core.land_settings import PrecisionSettings
from sim_autopilot.core.limits import PathLimits
from sim_autopilot.core.places import REACH_M, Origin, world_from_local
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.setpoints.path import Motion, Plane, carry_on, correction_speed, lead_to_position

_LOST_S = 2.0
_POSITION_GAIN, _VELOCITY_GAIN = 0.4, 0.1
"""Of a critically damped alpha-beta filter, roughly: beta = alpha^2 / (2 - alpha)."""
_GAP_MAX_S = 0.5
"""After a longer one the filter restarts."""
_SOONEST_S = 0.005
_SLOW_FROM_M, _SLOW_TO_M = 0.35, 2.0
_SLOW_M_S = 0.1
_ACCEPTED_M = 0.15
_LOOK_S = 0.3
"""How far ahead the height that is asked for lies, so that a held descent does not begin with a jump."""
_FAR_M = 1e3


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """The pad as it was at `seen_ns` since boot, in W, and the path on which the drone goes there."""

    seen_ns: int
    position_enu_m: Vector3
    velocity_enu_m_s: Plane = (0.0, 0.0)
    path: Motion | None = None


def place_seen(message: Message, now: Snapshot, range_m: float) -> Vector3 | None:
    """Return where a LANDING_TARGET says that the pad is, in W; None where it says nothing that is used.

    Args:
        message: with a position and its distance, or with angles, in MAV_FRAME_BODY_FRD or MAV_FRAME_LOCAL_FRD.
        now: the drone.
        range_m: to the ground, of the range finder, for angles without a distance.
    """
    if message.frame not in {mavlink.MAV_FRAME_BODY_FRD, mavlink.MAV_FRAME_LOCAL_FRD}:
        return None
    if message.position_valid == 1:
        if not message.distance > 0.0:
            return None
        arm_frd = (message.x, message.y, message.z)
    else:
        ahead, right = -tan(message.angle_y), tan(message.angle_x)
        size = hypot(ahead, right, 1.0)
        down = message.distance / size if message.distance > 0.0 else range_m
        arm_frd = (ahead * down, right * down, down)
    if not all(map(isfinite, arm_frd)) or hypot(*arm_frd) > _FAR_M:
        return None
    turned = message.frame == mavlink.MAV_FRAME_BODY_FRD
    x, y, z = rotate(now.orientation_wxyz if turned else _heading(now), flu_from_frd(arm_frd))
    px, py, pz = now.position_enu_m
    return px + x, py + y, pz + z


def place_told(message: Message, origin: Origin) -> Vector3 | None:
    """Return the place in W of a LANDING_TARGET in the autopilot's local frame, as PX4 takes it; None of any other."""
    place = message.x, message.y, message.z
    if message.position_valid != 1 or message.frame != mavlink.MAV_FRAME_LOCAL_NED or not all(map(isfinite, place)):
        return None
    return world_from_local(origin, enu_from_ned(place)) if hypot(*place) < REACH_M else None


def with_sighting(target: Target | None, place: Vector3, now_ns: int, settings: PrecisionSettings) -> Target:
    """Return the target after it was seen at `place`."""
    elapsed_s = _GAP_MAX_S if target is None else (now_ns - target.seen_ns) * 1e-9
    if target is None or elapsed_s >= _GAP_MAX_S:
        return Target(seen_ns=now_ns, position_enu_m=place, path=None if target is None else target.path)
    if elapsed_s < _SOONEST_S:
        return target
    (x, y, _), (vx, vy) = target.position_enu_m, target.velocity_enu_m_s
    x, y = x + vx * elapsed_s, y + vy * elapsed_s
    ex, ey = place[0] - x, place[1] - y
    gain = _VELOCITY_GAIN / elapsed_s if settings.moving else 0.0
    return replace(
        target,
        seen_ns=now_ns,
        position_enu_m=(x + _POSITION_GAIN * ex, y + _POSITION_GAIN * ey, place[2]),
        velocity_enu_m_s=(vx + gain * ex, vy + gain * ey),
    )


def is_acquired(target: Target | None, boot_ns: int) -> bool:
    """Return whether the target was seen lately."""
    return target is not None and (boot_ns - target.seen_ns) * 1e-9 <= _LOST_S


def steer_to_target(  # noqa: PLR0917 (over what, from what, who, as told, within what, how long)
    target: Target, reference: Reference, now: Snapshot, settings: PrecisionSettings, limits: PathLimits, dt_s: float
) -> tuple[Target, Reference]:
    """Return the target with its path `dt_s` later, and LAND's `reference` moved over it until then."""
    age_s = (now.boot_ns - target.seen_ns) * 1e-9
    (x, y, z), (vx, vy) = target.position_enu_m, target.velocity_enu_m_s
    px, py, pz = now.position_enu_m
    wanted = Motion(position=(x + vx * age_s, y + vy * age_s, pz), velocity=(vx, vy, 0.0))
    path = target.path or Motion(position=now.position_enu_m, velocity=now.velocity_enu_m_s)
    path = lead_to_position(path, wanted, limits, correction_speed(limits), dt_s)
    away_m = hypot(wanted.position[0] - px, wanted.position[1] - py)
    flown = _sink(reference, path, away_m, pz - z, now, settings)
    return replace(target, path=carry_on(path, dt_s)), flown


def _sink(  # noqa: PLR0917 (from what, where, how far, how high, who, as told)
    reference: Reference, path: Motion, away_m: float, above_m: float, now: Snapshot, settings: PrecisionSettings
) -> Reference:
    down = 0.0 if reference.velocity_enu_m_s is None else float(reference.velocity_enu_m_s[2])
    height_m = now.position_enu_m[2] if reference.position_enu_m is None else float(reference.position_enu_m[2])
    if away_m > settings.sinks_within_m > 0.0:
        down = 0.0
    elif _SLOW_FROM_M < above_m < _SLOW_TO_M:
        most_m_s = 0.5 * abs(down)
        down = min(-_SLOW_M_S, -most_m_s + away_m * most_m_s / _ACCEPTED_M)
    if above_m > _SLOW_FROM_M:
        height_m = max(height_m, now.position_enu_m[2] + down * _LOOK_S)
    return replace(
        reference,
        position_enu_m=np.array((*path.position[:2], height_m)),
        velocity_enu_m_s=np.array((*path.velocity[:2], down)),
        acceleration_enu_m_s2=np.array((*path.acceleration[:2], 0.0)),
    )


def _heading(now: Snapshot) -> Quaternion:
    return quaternion_from_roll_pitch_yaw(0.0, 0.0, now.yaw_rad)
