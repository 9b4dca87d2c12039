"""The facts of one step that the phases decide on, put together from the estimate, the pad and the drone."""

from dataclasses import dataclass

import numpy as np

from companion.autopilots.driver import AutopilotView
from companion.data import Array, OwnState
from companion.pad import PadPath
from companion.planning.guidance import ReferenceState
from link.messages import Vector3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drone:
    """The drone now, carried forward from its last report.

    Attributes:
        position_enu_m: (3,) in W.
        velocity_enu_m_s: (3,) in W.
        yaw_rad: heading of B about W's z.
        age_s: of the report.
    """

    position_enu_m: Array
    velocity_enu_m_s: Array
    yaw_rad: float
    age_s: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Situation:
    """What is known in this step; None where it is not.

    Attributes:
        t_ns: now, UTC.
        autopilot: as its messages tell.
        drone: now.
        pad: now and over the horizon.
        feet_offset_m: of the drone's reported position above its feet.
        fix_age_s: since the newest accepted fix was taken.
        vehicle_alive: its liveliness token; None when it never showed one.
        reference: the virtual model that the setpoints follow.
        tracking_error_m: distance of the drone from where it was asked to be at that time.
        waiting_point_enu_m: (3,) in W.
    """

    t_ns: int
    autopilot: AutopilotView
    drone: Drone | None
    pad: PadPath | None
    feet_offset_m: float
    fix_age_s: float | None
    vehicle_alive: bool | None
    reference: ReferenceState | None
    tracking_error_m: float
    waiting_point_enu_m: Array | None

    @property
    def relative_position_enu_m(self) -> Array | None:
        """(3,) of the drone's feet from the pad's centre, in W."""
        if self.drone is None or self.pad is None:
            return None
        feet = self.drone.position_enu_m - np.array([0.0, 0.0, self.feet_offset_m])
        return np.asarray(feet - self.pad.position_enu_m[0])

    @property
    def relative_velocity_enu_m_s(self) -> Array | None:
        """(3,) of the drone against the pad, in W."""
        if self.drone is None or self.pad is None:
            return None
        return np.asarray(self.drone.velocity_enu_m_s - self.pad.velocity_enu_m_s[0])


@dataclass(frozen=True, slots=True, kw_only=True)
class Approach:
    """The drone against the pad in four numbers."""

    distance_m: float  # horizontal
    speed_m_s: float  # horizontal
    height_m: float  # of the feet above the pad
    climb_m_s: float  # upwards against the pad


def approach(situation: Situation) -> Approach | None:
    """Return the drone against the pad, None unless both are known."""
    position = situation.relative_position_enu_m
    velocity = situation.relative_velocity_enu_m_s
    if position is None or velocity is None:
        return None
    return Approach(
        distance_m=float(np.hypot(position[0], position[1])),
        speed_m_s=float(np.hypot(velocity[0], velocity[1])),
        height_m=float(position[2]),
        climb_m_s=float(velocity[2]),
    )


def drone_now(own: OwnState | None, t_ns: int, yaw_rad: float, age_max_s: float) -> Drone | None:
    """Return the drone at `t_ns`, carried forward at its reported velocity; None when the report is too old."""
    if own is None:
        return None
    age_s = (t_ns - own.t_ns) * 1e-9
    if abs(age_s) > age_max_s:
        return None
    velocity = np.array(own.velocity_enu_m_s)
    position = np.array(own.position_enu_m) + velocity * age_s
    return Drone(position_enu_m=position, velocity_enu_m_s=velocity, yaw_rad=yaw_rad, age_s=age_s)


def vector3(array: Array | None) -> Vector3 | None:
    """Return (3,) as a tuple for a message."""
    return None if array is None else (float(array[0]), float(array[1]), float(array[2]))
