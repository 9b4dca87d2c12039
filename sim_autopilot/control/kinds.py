"""Which flight controllers there are, and the envelope that they keep."""

from dataclasses import dataclass
from enum import Enum
from math import radians


class ControllerKind(Enum):
    """The flight controllers by name."""

    LQR = "lqr"  # the report's, published gains, the reference enters through integrators only
    LQR_FEEDFORWARD = "lqr_feedforward"  # linear-quadratic gains with feed-forward and limits
    GEOMETRIC = "geometric"  # tracking on SE(3)


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope:
    """What the controller keeps to, each a magnitude; `lqr` knows none of it.

    Attributes:
        speed_max_m_s: horizontal velocity, feed-forward and correction together.
        climb_max_m_s: upwards.
        descent_max_m_s: downwards.
        braking_m_s2: horizontal deceleration with which a far position is approached.
        tilt_max_rad: of the thrust axis from the vertical.
        yaw_rate_max_rad_s: of the commanded heading.
    """

    speed_max_m_s: float = 30.0
    climb_max_m_s: float = 6.0
    descent_max_m_s: float = 4.0
    braking_m_s2: float = 3.0
    tilt_max_rad: float = radians(45.0)
    yaw_rate_max_rad_s: float = radians(60.0)


DEFAULT_ENVELOPE = Envelope()


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionGains:
    """Velocity per position error, acceleration per velocity error and per its integral; then the vertical ones."""

    position_per_s: float
    velocity_per_s: float
    integral_per_s2: float
    vertical_position_per_s: float
    vertical_velocity_per_s: float
