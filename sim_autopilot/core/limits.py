"""What flight control keeps to: the controller's envelope and gains, and the limits of a shaped path."""

from dataclasses import dataclass
from math import radians


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
class AxisGains:
    """Of position control along an axis.

    Attributes:
        position_per_s: velocity per position error.
        velocity_per_s: acceleration per velocity error.
        integral_per_s2: acceleration per its integral; None leaves what disturbs to an observer.
        derivative: acceleration per slope of the velocity, or of its error.
    """

    position_per_s: float
    velocity_per_s: float
    integral_per_s2: float | None
    derivative: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PositionGains:
    """A firmware's position control.

    Attributes:
        level: horizontally.
        vertical: upwards and downwards.
        observer_rad_s: pole of the observer of what disturbs, on axes that have no integral.
        derives_error: whether the slope is that of the velocity's error, else of the velocity alone.
        error_cutoff_hz: of the low-pass filter on the velocity's error; None is none.
        slope_cutoff_hz: of the one on the slope; None is none.
        attitude_per_s: turn rate per angle that the attitude is off.
    """

    level: AxisGains
    vertical: AxisGains
    observer_rad_s: float
    derives_error: bool
    error_cutoff_hz: float | None
    slope_cutoff_hz: float | None
    attitude_per_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLimits:
    """What a shaped path keeps to.

    Attributes:
        speed_m_s: horizontal, of corrections and of flight to a bare position.
        climb_m_s: upwards, of corrections and of flight to a bare position.
        descent_m_s: downwards, of corrections and of flight to a bare position.
        acceleration_m_s2: horizontal, of corrections.
        vertical_acceleration_m_s2: of corrections.
        jerk_m_s3: horizontal, of everything.
        vertical_jerk_m_s3: of everything.
        timeout_s: age at which a setpoint's velocity and acceleration are no longer believed.
        throttle_slew_s: in which the throttle rises to full before a take-off.
    """

    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    vertical_acceleration_m_s2: float
    jerk_m_s3: float
    vertical_jerk_m_s3: float
    timeout_s: float
    throttle_slew_s: float
