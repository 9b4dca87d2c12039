"""What full sticks ask for, and what counts while nobody holds them."""

from dataclasses import dataclass
from math import radians


@dataclass(frozen=True, slots=True, kw_only=True)
class StickFeel:
    """The parameters of the manual modes; the defaults are PX4's.

    Attributes:
        speed_m_s: horizontal, of the position modes.
        climb_m_s: upwards, of the modes that hold their height; None is the flight's own limit.
        descent_m_s: downwards likewise.
        acceleration_m_s2: horizontal, of the position modes; None is the flight's own.
        lift_m_s2: vertical likewise.
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
