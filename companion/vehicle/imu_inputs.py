"""From the messages of a vehicle's inertial unit to measurements, as far as what it tells is believed."""

import math

import numpy as np

from companion.core.data import Measurement, Quantity
from companion.vehicle.gravity_watch import bounded_force
from companion.vehicle.unit_watch import UnitWatch
from link.frames.rotations import roll_pitch_yaw_of, rotate, yaw_of
from link.messages import Matrix3, Quaternion, Vector3, VehicleImu

# Taken when a message states no covariance: a low-cost attitude sensor.
_HEADING_STD_RAD = 0.1
_YAW_RATE_STD_RAD_S = 0.02
# At least: data sheets state the noise at rest (0.02 m/s^2), not how a body shakes and pitches on its wheels.
# ISO 2631-1 calls less than 0.315 m/s^2 not uncomfortable.
ACCELERATION_STD_M_S2 = 0.3
"""Of an acceleration, at least."""

_TILT_KNOWN_STD_RAD = 0.1  # of roll and pitch; a unit that tells the heading only states more, as of no angle known
_UNKNOWN_RATE_VARIANCE_RAD2_S2 = 1e4


def imu_measurements(message: VehicleImu, unit: UnitWatch) -> tuple[Measurement, ...]:
    """Return heading, yaw rate, acceleration along the vehicle and tilt, as far as the message has them.

    `unit` watches the vehicle's inertial unit: what is not believed of it is not measured.
    """
    found: list[Measurement] = []
    covariance = message.orientation_covariance_rad2
    variance = _HEADING_STD_RAD**2 if covariance is None else covariance[8]
    if message.orientation_wxyz is not None:
        found.append(_scalar(message.t_ns, Quantity.HEADING, yaw_of(message.orientation_wxyz), variance))
    if message.angular_velocity_flu_rad_s is not None:
        rate_covariance = message.angular_velocity_covariance_rad2_s2
        rate_variance = None if rate_covariance is None else rate_covariance[8]
        rate_rad_s = message.angular_velocity_flu_rad_s[2]
        if message.orientation_wxyz is not None:
            unit.turns.take(message.t_ns, yaw_of(message.orientation_wxyz), variance, rate_rad_s)
        if unit.turns.is_believed:
            found.append(yaw_rate_measurement(message.t_ns, rate_rad_s, rate_variance))
    acceleration = _acceleration(message, unit)
    if acceleration is not None:
        found.append(acceleration)
    tilt = _tilt(message, believes_rates=unit.turns.is_believed)
    return tuple(found) if tilt is None else (*found, tilt)


def _acceleration(message: VehicleImu, unit: UnitWatch) -> Measurement | None:
    """Return the acceleration along the vehicle, None of a unit that tells none, or none that is believed."""
    force_m_s2, q_WV = message.specific_force_flu_m_s2, message.orientation_wxyz
    if force_m_s2 is None or not any(force_m_s2):  # exactly none at all is what drivers without it leave behind
        return None
    forward_m_s2 = _forward_force_m_s2(force_m_s2, q_WV)
    unit.gravity.take(message.t_ns, force_m_s2, q_WV)
    if q_WV is not None:
        is_level = _knows_tilt(message.orientation_covariance_rad2)
        felt_m_s2 = _forward_force_m_s2(bounded_force(force_m_s2), q_WV)
        unit.pushes.take_force(message.t_ns, felt_m_s2, yaw_of(q_WV), is_level=is_level)
    if not unit.believes_acceleration:
        return None
    covariance = message.specific_force_covariance_m2_s4
    variance = ACCELERATION_STD_M_S2**2 if covariance is None else covariance[0]
    return _scalar(message.t_ns, Quantity.ACCELERATION, forward_m_s2, variance)


def _tilt(message: VehicleImu, *, believes_rates: bool) -> Measurement | None:
    """Return roll, pitch and how fast they change, None of a unit that does not say that it knows them."""
    q_WV, covariance = message.orientation_wxyz, message.orientation_covariance_rad2
    if q_WV is None or covariance is None or not _knows_tilt(covariance):
        return None
    roll_rad, pitch_rad, _ = roll_pitch_yaw_of(q_WV)
    rates = message.angular_velocity_flu_rad_s if believes_rates else None
    rate_covariance = message.angular_velocity_covariance_rad2_s2
    turning_rad_s = _tilt_rates(roll_rad, pitch_rad, (0.0, 0.0, 0.0) if rates is None else rates)
    variances = [covariance[0], covariance[4], _UNKNOWN_RATE_VARIANCE_RAD2_S2, _UNKNOWN_RATE_VARIANCE_RAD2_S2]
    if rates is not None:
        p, q, r = [_YAW_RATE_STD_RAD_S**2] * 3 if rate_covariance is None else rate_covariance[0:9:4]
        variances[2:] = p + (math.tan(pitch_rad) * math.cos(roll_rad)) ** 2 * r, q + math.sin(roll_rad) ** 2 * r
    return Measurement(
        t_ns=message.t_ns,
        quantity=Quantity.TILT,
        value=np.array([roll_rad, pitch_rad, *turning_rad_s]),
        covariance=np.diag(variances),
    )


def _knows_tilt(covariance_rad2: Matrix3 | None) -> bool:
    """Return whether a unit with such a covariance of its attitude says that it knows roll and pitch."""
    return covariance_rad2 is not None and max(covariance_rad2[0], covariance_rad2[4]) <= _TILT_KNOWN_STD_RAD**2


def _tilt_rates(roll_rad: float, pitch_rad: float, rates_flu_rad_s: Vector3) -> tuple[float, float]:
    """Return how fast roll and pitch (ZYX) change of what turns at these rates about its own axes, rad/s.

    A car that leans by 4 degrees in a bend of 0.5 rad/s turns at 0.035 rad/s about its axis of pitch without pitching.
    """
    p_rad_s, q_rad_s, r_rad_s = rates_flu_rad_s
    c, s = math.cos(roll_rad), math.sin(roll_rad)
    return p_rad_s + math.tan(pitch_rad) * (s * q_rad_s + c * r_rad_s), c * q_rad_s - s * r_rad_s


def _forward_force_m_s2(force_m_s2: Vector3, q_WV: Quaternion | None) -> float:
    """Return the specific force in the direction of the heading, less gravity as far as the attitude tells it."""
    if q_WV is None:
        return force_m_s2[0]
    east_m_s2, north_m_s2, _ = rotate(q_WV, force_m_s2)
    yaw_rad = yaw_of(q_WV)
    return math.cos(yaw_rad) * east_m_s2 + math.sin(yaw_rad) * north_m_s2


def yaw_rate_measurement(t_ns: int, rate_rad_s: float, variance: float | None) -> Measurement:
    """Return a yaw rate, counter-clockwise, as a measurement; `variance` None where none is stated."""
    return _scalar(t_ns, Quantity.YAW_RATE, rate_rad_s, _YAW_RATE_STD_RAD_S**2 if variance is None else variance)


def _scalar(t_ns: int, quantity: Quantity, value: float, variance: float) -> Measurement:
    return Measurement(t_ns=t_ns, quantity=quantity, value=np.array([value]), covariance=np.array([[variance]]))
