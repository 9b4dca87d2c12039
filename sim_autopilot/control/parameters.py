"""What the controller kernels read and remember: one record of gains and limits, one vector of memory.

Memory (17,): whether it is running; heading it commands, rad; velocity as the observer has it, m/s (3);
disturbance, m/s2 (3); integrals of the position and heading errors (4); position that is followed, m (3);
level acceleration that was asked for and could not be had, m/s2 (2), zero where it could. `lqr`
keeps in the second to fifth its heading and position at the start, in the sixth the heading it goes to. A firmware's
own velocity control keeps there its integral, negative, as the disturbance; the velocity, or the error, whose slope it
takes, as the observed velocity; and that slope (3) in place of the integrals.
Reference (25,): position, velocity, acceleration (3 each), heading, heading rate, then 1 or 0 for each of position,
velocity, acceleration and heading given; whether an attitude is given, whether turn rates are, thrust over mass,
quaternion (4), rates (3).
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from sim_autopilot.core.data import Array, AttitudeTarget, Reference
from sim_autopilot.core.limits import Envelope, PositionGains


class ControllerKind(Enum):
    """The flight controllers by name."""

    LQR = "lqr"  # the report's, published gains, the reference enters through integrators only
    LQR_FEEDFORWARD = "lqr_feedforward"  # linear-quadratic gains with feed-forward and limits
    GEOMETRIC = "geometric"  # tracking on SE(3)


RUNNING = 0
HEADING = 1
VELOCITY = 2
DISTURBANCE = 5
INTEGRAL = 8
SLOPE = 8
PLACE = 12
MISSED = 15
OBSERVED = -1.0
"""In place of the gain of an integral that there is not."""

YAW, YAW_RATE, HAS_POSITION, HAS_VELOCITY, HAS_ACCELERATION, HAS_YAW = 9, 10, 11, 12, 13, 14
PARTLY = 0.5
"""In place of 1 for a position that is nobody's wish on some axes, where it is the drone's own."""
HAS_ATTITUDE, HAS_RATES, THRUST, ATTITUDE, RATE = 15, 16, 17, 18, 22
REFERENCE_SIZE = 25

KIND_CODES = {ControllerKind.LQR: 0, ControllerKind.LQR_FEEDFORWARD: 1, ControllerKind.GEOMETRIC: 2}

CONTROL = np.dtype(
    [
        ("kind", "i8"),
        ("period_s", "f8"),
        ("position_gain", "f8", (3,)),
        ("velocity_gain", "f8", (3,)),
        ("attitude_gain", "f8", (3,)),
        ("rate_gain", "f8", (3,)),
        ("lqr_state", "f8", (4, 12)),
        ("lqr_integral", "f8", (4, 4)),
        ("has_pid", "i8"),
        ("integral_gain", "f8", (3,)),
        ("derivative_gain", "f8", (3,)),
        ("derives_error", "i8"),
        ("error_share", "f8"),
        ("slope_share", "f8"),
        ("observer_rad_s", "f8"),
        ("motor_lead", "f8"),
        ("speed_max_m_s", "f8"),
        ("climb_max_m_s", "f8"),
        ("descent_max_m_s", "f8"),
        ("braking_m_s2", "f8"),
        ("tilt_max_rad", "f8"),
        ("yaw_rate_max_rad_s", "f8"),
        ("tilt_braking_rad_s2", "f8"),
    ]
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeGains:
    """Of acceleration on position (1/s2) and velocity (1/s), of angular acceleration on attitude (1/s2) and rate (1/s).

    Position and velocity are along x, y of the heading and z; attitude and rate about x, y, z of B.
    """

    position: tuple[float, float, float]
    velocity: tuple[float, float, float]
    attitude: tuple[float, float, float]
    rate: tuple[float, float, float]


def control_record(
    kind: ControllerKind,
    gains: CascadeGains,
    lqr: tuple[Array, Array],
    envelope: Envelope,
    *,
    pid: PositionGains | None,
    period_s: float,
    observer_rad_s: float,
    motor_lead: float,
    tilt_braking_rad_s2: float,
) -> NDArray[np.void]:
    """Return the record (1,) of a controller.

    `lqr` holds K (4, 12) and Ki (4, 4) of the published one, `pid` what a firmware has in place of an observer.
    """
    record = np.zeros(1, dtype=CONTROL)
    record["kind"] = KIND_CODES[kind]
    record["period_s"] = period_s
    record["position_gain"] = gains.position
    record["velocity_gain"] = gains.velocity
    record["attitude_gain"] = gains.attitude
    record["rate_gain"] = gains.rate
    if pid is not None:
        fill_pid(record, pid, period_s)
    record["lqr_state"], record["lqr_integral"] = lqr
    record["observer_rad_s"] = observer_rad_s
    record["motor_lead"] = motor_lead
    record["speed_max_m_s"] = envelope.speed_max_m_s
    record["climb_max_m_s"] = envelope.climb_max_m_s
    record["descent_max_m_s"] = envelope.descent_max_m_s
    record["braking_m_s2"] = envelope.braking_m_s2
    record["tilt_max_rad"] = envelope.tilt_max_rad
    record["tilt_braking_rad_s2"] = tilt_braking_rad_s2
    record["yaw_rate_max_rad_s"] = envelope.yaw_rate_max_rad_s
    return record


def fill_pid(record: NDArray[np.void], pid: PositionGains, period_s: float) -> None:
    """Write the part of a firmware's position control that is no gain of the cascade."""
    axes = (pid.level, pid.level, pid.vertical)
    record["has_pid"] = 1
    record["integral_gain"] = tuple(OBSERVED if one.integral_per_s2 is None else one.integral_per_s2 for one in axes)
    record["derivative_gain"] = tuple(one.derivative for one in axes)
    record["derives_error"] = int(pid.derives_error)
    record["error_share"] = _filter_share(pid.error_cutoff_hz, period_s)
    record["slope_share"] = _filter_share(pid.slope_cutoff_hz, period_s)


def _filter_share(cutoff_hz: float | None, period_s: float) -> float:
    """Return by which part of the difference a first-order low-pass filter moves in a period."""
    return 1.0 if cutoff_hz is None else 1.0 - math.exp(-2.0 * math.pi * cutoff_hz * period_s)


def reference_vector(reference: Reference) -> Array:
    """Return `reference` as the vector (25,) of the module's text."""
    vector = np.zeros(REFERENCE_SIZE)
    if reference.position_enu_m is not None:
        vector[0:3] = reference.position_enu_m
        vector[HAS_POSITION] = PARTLY if any(reference.free_position) else 1.0
    if reference.velocity_enu_m_s is not None:
        vector[3:6] = reference.velocity_enu_m_s
        vector[HAS_VELOCITY] = 1.0
    if reference.acceleration_enu_m_s2 is not None:
        vector[6:9] = reference.acceleration_enu_m_s2
        vector[HAS_ACCELERATION] = 1.0
    if reference.yaw_rad is not None:
        vector[YAW] = reference.yaw_rad
        vector[HAS_YAW] = 1.0
    if reference.yaw_rate_rad_s is not None:
        vector[YAW_RATE] = reference.yaw_rate_rad_s
    if reference.attitude is not None:
        _fill_attitude(vector, reference.attitude)
    return vector


def _fill_attitude(vector: Array, target: AttitudeTarget) -> None:
    vector[HAS_RATES] = 1.0
    vector[THRUST] = target.thrust_m_s2
    vector[RATE : RATE + 3] = target.rates_flu_rad_s
    if target.orientation_wxyz is not None:
        vector[ATTITUDE : ATTITUDE + 4] = target.orientation_wxyz
        vector[HAS_ATTITUDE] = 1.0
