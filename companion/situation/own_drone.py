"""What the drone's own reports say of where it is, how it leans, and what it sees below; pure."""

import math

import numpy as np

from companion.config.touchdown import TouchdownConfig
from companion.core.data import OwnState, RangeReading
from companion.situation.situation import Drone
from link.frames.rotations import rotate

_RANGE_AGE_MAX_S = 0.3
_LAST_SEEN_AGE_MAX_S = 3.0  # own heights wander by some millimetres a second
_UPRIGHT_MIN = 0.5  # cosine of a tilt beyond which a range finder does not look down, and no gear stands


def drone_now(own: OwnState | None, t_ns: int, yaw_rad: float, age_max_s: float) -> Drone | None:
    """Return the drone at `t_ns`, carried forward at its reported velocity; None when the report is too old.

    An attitude comes with the report of a place. Where the two together are too old, the later one is missed.
    """
    if own is None:
        return None
    age_s = (t_ns - own.t_ns) * 1e-9
    is_attitude_known = age_s + own.attitude_age_s <= age_max_s
    if abs(age_s) > age_max_s or (not is_attitude_known and age_s >= own.attitude_age_s):
        return None
    velocity = np.array(own.velocity_enu_m_s)
    position = np.array(own.position_enu_m) + velocity * age_s
    lean, lean_rate_hz = _lean(own)
    return Drone(
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        yaw_rad=yaw_rad,
        age_s=age_s,
        acceleration_up_m_s2=own.acceleration_up_m_s2,
        jolt_m_s2=own.jolt_m_s2,
        attitude_known=is_attitude_known,
        lean=lean,
        lean_rate_hz=lean_rate_hz,
    )


def _lean(own: OwnState) -> tuple[float, float]:
    """Return the sine of the tilt, and the rate by which it grows, 1/s."""
    roll_rad_s, pitch_rad_s, _ = own.angular_velocity_flu_rad_s
    x, y, _ = rotate(own.orientation_wxyz, (0.0, 0.0, 1.0))
    vx, vy, _ = rotate(own.orientation_wxyz, (pitch_rad_s, -roll_rad_s, 0.0))
    lean = math.hypot(x, y)
    return lean, (x * vx + y * vy) / lean if lean > 0.0 else 0.0


def lowest_foot(drone: Drone | None, touchdown: TouchdownConfig) -> tuple[float, float]:
    """Return how far the lowest foot of a leaning drone is below those of a level one, m, and gets farther, m/s.

    While a foot stands on the pad, the thrust and the pad bring the drone upright: its own place sinks by as much.
    """
    if drone is None:
        return 0.0, 0.0
    upright = math.sqrt(max(1.0 - drone.lean**2, _UPRIGHT_MIN**2))
    below_m = touchdown.foot_radius_m * drone.lean - touchdown.gear_height_m * (1.0 - upright)
    arm_m = touchdown.foot_radius_m - touchdown.gear_height_m * drone.lean / upright
    return below_m, arm_m * drone.lean_rate_hz


def range_height_m(own: OwnState | None, seen: RangeReading | None, sensor_height_m: float, t_ns: int) -> float | None:
    """Return the height of the drone's feet above what its range finder sees below.

    Args:
        own: the drone's newest report, for its tilt.
        seen: the newest reading.
        sensor_height_m: of the range finder above the feet.
        t_ns: now.
    """
    if own is None or seen is None or abs(t_ns - seen.t_ns) * 1e-9 > _RANGE_AGE_MAX_S:
        return None
    _, _, upright = rotate(own.orientation_wxyz, (0.0, 0.0, 1.0))
    return seen.distance_m * upright - sensor_height_m if upright > _UPRIGHT_MIN else None


def range_carried_m(drone: Drone | None, seen: RangeReading | None, sensor_height_m: float, t_ns: int) -> float | None:
    """Return the last height of the drone's feet that was seen, less what the drone has sunk since.

    A range finder sees nothing nearer than its range begins, and where the drone stands it may never see again.

    Args:
        drone: now.
        seen: the last reading within the range.
        sensor_height_m: of the range finder above the feet.
        t_ns: now.
    """
    if drone is None or seen is None or seen.own is None or abs(t_ns - seen.t_ns) * 1e-9 > _LAST_SEEN_AGE_MAX_S:
        return None
    return seen.distance_m - sensor_height_m + float(drone.position_enu_m[2]) - seen.own.position_enu_m[2]
