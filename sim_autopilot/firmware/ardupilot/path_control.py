"""The limits of ArduCopter's path and the gains of its position controller, as its parameters set them."""

from math import radians, sqrt

from sim_autopilot.core.limits import AxisGains, PathLimits, PositionGains
from sim_autopilot.core.parameters import Values
from sim_autopilot.physics.airframe import GRAVITY_M_S2

_LEAST_M_S = 0.1
"""Speeds and accelerations below a tenth count as that, as the firmware's own lower bounds do roughly."""
_OBSERVER_RAD_S = 1.0
"""Of what disturbs vertically: PSC_ACCZ_I 1 over PSC_ACCZ_P 0.5 and the thrust itself, by a hover throttle of 0.39."""


def in_si(values: Values, name: str) -> float:
    """Return a speed or an acceleration that is told in centimetres, in metres."""
    return max(_LEAST_M_S, values[name] / 100.0)


def path_limits(values: Values) -> PathLimits:
    """Return what bounds the path that setpoints are turned into."""
    return PathLimits(
        speed_m_s=in_si(values, "WPNAV_SPEED"),
        climb_m_s=in_si(values, "WPNAV_SPEED_UP"),
        descent_m_s=in_si(values, "WPNAV_SPEED_DN"),
        acceleration_m_s2=in_si(values, "WPNAV_ACCEL"),
        vertical_acceleration_m_s2=in_si(values, "WPNAV_ACCEL_Z"),
        jerk_m_s3=_jerk_m_s3(values),
        vertical_jerk_m_s3=max(0.1, values["PSC_JERK_Z"]),
        timeout_s=max(0.1, values["GUID_TIMEOUT"]),
        throttle_slew_s=max(0.25, values["TKOFF_SLEW_TIME"]),
    )


def _jerk_m_s3(values: Values) -> float:
    """Return the jerk set, bounded as AC_PosControl does by how fast the body may turn over; 0 there is no bound."""
    bounds = [max(0.1, values["PSC_JERK_XY"])]
    rate_rad_s = radians(min(values["ATC_RATE_R_MAX"], values["ATC_RATE_P_MAX"]))
    if rate_rad_s > 0.0:
        bounds.append(GRAVITY_M_S2 * rate_rad_s)
    turn_rad_s2 = radians(min(values["ATC_ACCEL_R_MAX"], values["ATC_ACCEL_P_MAX"]) / 100.0)
    if turn_rad_s2 > 0.0:
        bounds.append(0.5 * sqrt(in_si(values, "WPNAV_ACCEL") * GRAVITY_M_S2 * turn_rad_s2))
    return min(bounds)


def position_gains(values: Values) -> PositionGains:
    """Return the gains of AC_PosControl; an observer stands for its vertical integral of an acceleration's error."""
    level = AxisGains(
        position_per_s=_gain(values, "PSC_POSXY_P"),
        velocity_per_s=_gain(values, "PSC_VELXY_P"),
        integral_per_s2=_gain(values, "PSC_VELXY_I"),
        derivative=max(0.0, min(1.0, values["PSC_VELXY_D"])),
    )
    return PositionGains(
        level=level,
        vertical=AxisGains(
            position_per_s=_gain(values, "PSC_POSZ_P"),
            velocity_per_s=_gain(values, "PSC_VELZ_P"),
            integral_per_s2=None,
        ),
        observer_rad_s=_OBSERVER_RAD_S,
        derives_error=True,
        error_cutoff_hz=max(0.1, values["PSC_VELXY_FLTE"]),
        slope_cutoff_hz=max(0.1, values["PSC_VELXY_FLTD"]),
        attitude_per_s=1.0 / max(0.05, values["ATC_INPUT_TC"]),
    )


def _gain(values: Values, name: str) -> float:
    return min(10.0, max(0.02, values[name]))
