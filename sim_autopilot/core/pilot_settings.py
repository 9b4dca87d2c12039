"""What people ask the drone for: full sticks and what counts while nobody holds them, and following somebody."""

from dataclasses import dataclass
from math import pi, radians

from sim_autopilot.core.modes import Event, Mode


@dataclass(frozen=True, slots=True, kw_only=True)
class StickFeel:
    """The parameters of the manual modes; the defaults are PX4's.

    Attributes:
        speed_m_s: horizontal, of the position modes.
        climb_m_s: upwards, of the modes that hold their height; None is the flight's own limit.
        descent_m_s: downwards, of the modes that hold their height; None is the flight's own limit.
        acceleration_m_s2: horizontal, of the position modes; None is the flight's own.
        lift_m_s2: vertical, of the modes that hold their height; None is the flight's own.
        tilt_rad: of the modes that lean.
        yaw_rate_rad_s: of all but acro.
        acro_rate_rad_s: of acro, about each axis.
        dead_zone: of the position modes and of yaw.
        throttle_dead_zone: of the modes that hold their height.
        lost_s: silence after which nobody holds the sticks.
        idle_throttle: what a receiver gives while nobody does; None where there is no receiver, and the modes hold.
    """

    speed_m_s: float = 10.0  # MPC_VEL_MANUAL
    climb_m_s: float | None = None
    descent_m_s: float | None = None
    acceleration_m_s2: float | None = None
    lift_m_s2: float | None = None
    tilt_rad: float = radians(35.0)  # MPC_MAN_TILT_MAX
    yaw_rate_rad_s: float = radians(150.0)  # MPC_MAN_Y_MAX
    acro_rate_rad_s: float = radians(100.0)  # MC_ACRO_R_MAX, MC_ACRO_P_MAX, MC_ACRO_Y_MAX
    dead_zone: float = 0.1  # MPC_HOLD_DZ
    throttle_dead_zone: float = 0.1
    lost_s: float = 0.5  # COM_RC_LOSS_T
    idle_throttle: float | None = None


PX4_STICKS = StickFeel()


@dataclass(frozen=True, slots=True, kw_only=True)
class TakeoverSettings:
    """What moving the sticks and letting them go does.

    Attributes:
        lost_event: what happens when the sticks of a manual mode are let go of; None holds.
        overridden_modes: that a pilot takes over by moving the sticks.
        moved_per_s: how fast, in parts of half their way.
    """

    lost_event: Event | None = None
    overridden_modes: frozenset[Mode] = frozenset()
    moved_per_s: float = 0.3


NO_TAKEOVER = TakeoverSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowSettings:
    """What the FLW_TGT parameters amount to.

    Attributes:
        distance_m: horizontal, from him.
        height_m: above home, or above him where `with_him`.
        angle_rad: about him, clockwise from where he goes; pi is behind.
        along_m_s: at most, on the circle about him.
        smoothing: the part of a new position that is left out.
        with_him: whether the height is his.
    """

    distance_m: float = 8.0
    height_m: float = 8.0
    angle_rad: float = pi
    along_m_s: float = 5.0
    smoothing: float = 0.1
    with_him: bool = False


BEHIND = FollowSettings()
"""PX4's defaults."""
