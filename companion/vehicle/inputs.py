"""From the vehicle's messages to measurements in the drone's local frame W."""

import math

import numpy as np

from companion.autopilots.state import AutopilotState
from companion.core.data import Array, Measurement, OwnState, Quantity
from companion.vehicle.range_watch import ATTITUDE_AGE_MAX_S
from companion.vehicle.unit_watch import UnitWatch
from link.frames.geodesy import LocalFrame, is_metric, local_from_geodetic, scale_of
from link.frames.rotations import roll_pitch_yaw_of, rotate, yaw_of
from link.messages import Fix, FixVelocity, Matrix3, PadSighting, Quaternion, Vector3, VehicleImu
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.records import replace
from link.zenoh.keys import Keys

# Taken when a message states no covariance: plain GNSS and a low-cost attitude sensor.
_POSITION_STD_M = 1.5
_VELOCITY_STD_M_S = 0.3
_VERTICAL_VELOCITY_STD_M_S = 100.0  # of one that is not measured: says nothing
_HEADING_STD_RAD = 0.1
_YAW_RATE_STD_RAD_S = 0.02
# At least: data sheets state the noise at rest (0.02 m/s^2), not how a body shakes and pitches on its wheels.
# ISO 2631-1 calls less than 0.315 m/s^2 not uncomfortable.
_ACCELERATION_STD_M_S2 = 0.3
_TILT_KNOWN_STD_RAD = 0.1  # of roll and pitch; a unit that tells the heading only states more, as of no angle known
_UNKNOWN_RATE_VARIANCE_RAD2_S2 = 1e4

# No sensor is better than this; a smaller stated variance (0 for one axis is not rare) is a singular one to a filter.
_STD_MIN = {
    Quantity.POSITION: 0.005,
    Quantity.VELOCITY: 0.01,
    Quantity.HEADING: 0.002,
    Quantity.YAW_RATE: 0.001,
    Quantity.PAD: 0.002,
    Quantity.ACCELERATION: _ACCELERATION_STD_M_S2,
    Quantity.TILT: 0.001,
}
_STD_MAX = 1e4  # says nothing at all
# Beyond these a message is wrong, or of a vehicle that nobody lands on.
_VALUE_MAX = {
    Quantity.POSITION: 1e5,
    Quantity.VELOCITY: 100.0,
    Quantity.HEADING: 10.0,
    Quantity.YAW_RATE: 10.0,
    Quantity.PAD: 1e5,
    Quantity.ACCELERATION: 100.0,
    Quantity.TILT: 10.0,
}


def measurements_of(key: str, payload: bytes, keys: Keys, state: AutopilotState, unit: UnitWatch) -> list[Measurement]:
    """Return what a Zenoh sample of the vehicle measures, nothing of one that is no measurement or too early.

    Args:
        key: that it was put on.
        payload: CDR.
        keys: of the Zenoh contract.
        state: of the autopilot, for its local frame W and the drone's place when it saw the pad.
        unit: watches the vehicle's inertial unit, of which counts what is believed.

    Raises:
        PayloadError: it cannot be decoded, or is absurd.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # what gets too large for a number is refused as absurd
        return [plausible(measurement) for measurement in _decode(key, payload, keys, state, unit)]


def _decode(key: str, payload: bytes, keys: Keys, state: AutopilotState, unit: UnitWatch) -> tuple[Measurement, ...]:
    frame = state.view.frame
    if key == keys.fix:
        fix = cdr.decode(Fix, payload)
        return () if frame is None else (fix_measurement(fix, frame),)
    if key == keys.fix_velocity:
        velocity = cdr.decode(FixVelocity, payload)
        return () if frame is None else velocity_measurements(velocity, frame)
    if key == keys.imu:
        return imu_measurements(cdr.decode(VehicleImu, payload), unit)
    if key == keys.pad_pose:
        sighting = cdr.decode(PadSighting, payload)
        own_then = state.own_at(sighting.t_ns)
        if own_then is None or own_then.attitude_age_s > ATTITUDE_AGE_MAX_S:
            return ()
        return (sighting_measurement(sighting, own_then),)
    return ()


def _matrix(covariance: Matrix3 | None, std: float) -> Array:
    if covariance is None:
        return np.eye(3) * std**2
    return np.array(covariance).reshape(3, 3)


def plausible(measurement: Measurement) -> Measurement:
    """Return the measurement as a filter can take it: its variance not below what sensors can do.

    Raises:
        PayloadError: a number is absurd.
    """
    quantity, covariance = measurement.quantity, measurement.covariance
    value_max, covariance_max = _VALUE_MAX[quantity], _STD_MAX**2
    if not all(abs(value) < value_max for value in measurement.value.tolist()):
        raise PayloadError(f"the {quantity.value} {measurement.value.tolist()} is absurd")
    if not all(abs(value) < covariance_max for value in covariance.ravel().tolist()):
        raise PayloadError(f"the covariance {covariance.tolist()} of the {quantity.value} is absurd")
    least = _STD_MIN[quantity] ** 2
    if _least_variance(covariance) >= least:
        return measurement
    return replace(measurement, covariance=covariance + least * np.eye(len(covariance)))


def _least_variance(covariance: Array) -> float:
    """Return the variance (smallest eigenvalue) of the best known direction; sensors mostly state a diagonal."""
    variances, parts = covariance.diagonal().tolist(), covariance.ravel().tolist()
    if len(parts) - parts.count(0.0) == len(variances) - variances.count(0.0):
        return float(min(variances))
    return float(np.linalg.eigvalsh(covariance)[0])


def fix_measurement(fix: Fix, frame: LocalFrame) -> Measurement:
    """Return the antenna's position in W, which is the autopilot's `frame`.

    Raises:
        PayloadError: that frame is none in which anything is landed on.
    """
    if not is_metric(frame):
        raise PayloadError("so near a pole a metre east in the autopilot's frame is none on the ground")
    position = local_from_geodetic(frame, fix.latitude_rad, fix.longitude_rad, fix.altitude_m)
    return Measurement(
        t_ns=fix.t_ns,
        quantity=Quantity.POSITION,
        value=np.array(position),
        covariance=_matrix(fix.covariance_enu_m2, _POSITION_STD_M),
    )


def velocity_measurements(message: FixVelocity, frame: LocalFrame) -> tuple[Measurement, ...]:
    """Return the velocity in W, which is the autopilot's `frame`, and, where the message has it, the yaw rate."""
    covariance = _matrix(message.velocity_covariance_enu_m2_s2, _VELOCITY_STD_M_S)
    if not message.is_vertical_measured:
        covariance[2, :] = covariance[:, 2] = 0.0
        covariance[2, 2] = _VERTICAL_VELOCITY_STD_M_S**2
    velocity = Measurement(
        t_ns=message.t_ns,
        quantity=Quantity.VELOCITY,
        value=np.array(message.velocity_enu_m_s) * scale_of(frame),
        covariance=covariance,
    )
    if message.yaw_rate_rad_s is None:
        return (velocity,)
    return (velocity, _yaw_rate(message.t_ns, message.yaw_rate_rad_s, message.yaw_rate_variance_rad2_s2))


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
            found.append(_yaw_rate(message.t_ns, rate_rad_s, rate_variance))
    force_m_s2 = message.specific_force_flu_m_s2
    if force_m_s2 is not None and any(force_m_s2):  # exactly none at all is what drivers without it leave behind
        force_covariance = message.specific_force_covariance_m2_s4
        force_variance = _ACCELERATION_STD_M_S2**2 if force_covariance is None else force_covariance[0]
        unit.gravity.take(message.t_ns, force_m_s2, message.orientation_wxyz)
        forward_m_s2 = _forward_force_m_s2(force_m_s2, message.orientation_wxyz)
        if unit.gravity.is_believed:
            found.append(_scalar(message.t_ns, Quantity.ACCELERATION, forward_m_s2, force_variance))
    tilt = _tilt(message, believes_rates=unit.turns.is_believed)
    return tuple(found) if tilt is None else (*found, tilt)


def _tilt(message: VehicleImu, *, believes_rates: bool) -> Measurement | None:
    """Return roll, pitch and how fast they change, None of a unit that does not say that it knows them."""
    q_WV, covariance = message.orientation_wxyz, message.orientation_covariance_rad2
    if q_WV is None or covariance is None or max(covariance[0], covariance[4]) > _TILT_KNOWN_STD_RAD**2:
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


def sighting_measurement(sighting: PadSighting, own_then: OwnState) -> Measurement:
    """Return the pad's centre in W.

    Args:
        sighting: in the drone's body frame at its stamp.
        own_then: the drone at that stamp.
    """
    offset = rotate(own_then.orientation_wxyz, sighting.position_flu_m)
    turn = np.column_stack(
        [rotate(own_then.orientation_wxyz, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    )
    return Measurement(
        t_ns=sighting.t_ns,
        quantity=Quantity.PAD,
        value=np.array(own_then.position_enu_m) + np.array(offset),
        covariance=turn @ np.array(sighting.position_covariance_m2).reshape(3, 3) @ turn.T,
    )


def _yaw_rate(t_ns: int, rate_rad_s: float, variance: float | None) -> Measurement:
    return _scalar(t_ns, Quantity.YAW_RATE, rate_rad_s, _YAW_RATE_STD_RAD_S**2 if variance is None else variance)


def _scalar(t_ns: int, quantity: Quantity, value: float, variance: float) -> Measurement:
    return Measurement(t_ns=t_ns, quantity=quantity, value=np.array([value]), covariance=np.array([[variance]]))
