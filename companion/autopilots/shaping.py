"""The numbers by which an autopilot shapes its own path from setpoints."""

from msgspec import Struct


class Shaping(Struct, frozen=True, kw_only=True):
    """Of an autopilot whose own path of bounded jerk is led by setpoints, as ArduPilot's AC_PosControl does it.

    The path makes up for an error of its velocity by up to the acceleration, at the rate jerk / acceleration; what a
    setpoint brings along is added to that. Its acceleration changes by the jerk at most.

    Attributes:
        carried_s: for how long a setpoint is moved on by its own velocity and acceleration; then it stands.
        acceleration_m_s2: horizontally, of corrections.
        jerk_m_s3: horizontally.
        vertical_acceleration_m_s2: of corrections.
        vertical_jerk_m_s3: of all.
    """

    carried_s: float
    acceleration_m_s2: float
    jerk_m_s3: float
    vertical_acceleration_m_s2: float
    vertical_jerk_m_s3: float
