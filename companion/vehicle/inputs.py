"""From the vehicle's messages to measurements in the drone's local frame W."""

import numpy as np

from companion.autopilots.state import AutopilotState
from companion.core.data import Array, Measurement, OwnState, Quantity
from companion.vehicle.imu_inputs import ACCELERATION_STD_M_S2, imu_measurements, yaw_rate_measurement
from companion.vehicle.range_watch import ATTITUDE_AGE_MAX_S
from companion.vehicle.unit_watch import UnitWatch
from link.frames.geodesy import LocalFrame, is_metric, local_from_geodetic, scale_of
from link.frames.rotations import rotate
from link.messages import Fix, FixVelocity, Matrix3, PadSighting, VehicleImu
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.records import replace
from link.zenoh.keys import Keys

VELOCITY_STD_M_S = 0.3
"""Of a velocity whose message states no covariance: plain GNSS."""

_POSITION_STD_M = 1.5  # of a position whose message states no covariance: plain GNSS
_VERTICAL_VELOCITY_STD_M_S = 100.0  # of one that is not measured: says nothing

# No sensor is better than this; a smaller stated variance (0 for one axis is not rare) is a singular one to a filter.
_STD_MIN = {
    Quantity.POSITION: 0.005,
    Quantity.VELOCITY: 0.01,
    Quantity.HEADING: 0.002,
    Quantity.YAW_RATE: 0.001,
    Quantity.PAD: 0.002,
    Quantity.ACCELERATION: ACCELERATION_STD_M_S2,
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
        return () if frame is None else _watched(velocity_measurements(velocity, frame), unit)
    if key == keys.imu:
        return imu_measurements(cdr.decode(VehicleImu, payload), unit)
    if key == keys.pad_pose:
        sighting = cdr.decode(PadSighting, payload)
        own_then = state.own_at(sighting.t_ns)
        if own_then is None or own_then.attitude_age_s > ATTITUDE_AGE_MAX_S:
            return ()
        return (sighting_measurement(sighting, own_then),)
    return ()


def _watched(velocities: tuple[Measurement, ...], unit: UnitWatch) -> tuple[Measurement, ...]:
    """Return what a message of a velocity measures, once `unit` has been compared with it."""
    velocity, *_ = velocities
    unit.pushes.take_velocity(velocity.t_ns, velocity.value.tolist(), float(velocity.covariance[0, 0]))
    return velocities


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
    least, stated = _STD_MIN[quantity] ** 2, _least_variance(covariance)
    if stated >= least:
        return measurement
    # Single precision leaves a direction that is known well, beside one that is not, less than no variance.
    return replace(measurement, covariance=covariance + (least - min(stated, 0.0)) * np.eye(len(covariance)))


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
    covariance = _matrix(message.velocity_covariance_enu_m2_s2, VELOCITY_STD_M_S)
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
    return (velocity, yaw_rate_measurement(message.t_ns, message.yaw_rate_rad_s, message.yaw_rate_variance_rad2_s2))


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
