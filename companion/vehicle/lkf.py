"""Linear Kalman filter with constant acceleration per axis (source report, eq. 15).

State `[p, v, a]` of the antenna in W, nine components, m, m/s, m/s^2: `p+ = p + v dt + a dt^2/2`, `v+ = v + a dt`.
What it believes of model and sensors is either the report's own or white noise of the jerk.
"""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from filterpy.kalman import predict, update

from companion.config.estimation import LkfConfig, LkfReportConfig
from companion.core.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from companion.vehicle.filter_step import Gaussian, Update, squared_norm, symmetric
from companion.vehicle.small_matrices import white_jerk
from link.records import replace

I3 = np.eye(3)


class LkfNoise(Protocol):
    """What the linear filter believes about its start, its model and its sensors."""

    def initial(self, fix: Measurement) -> Array:
        """Return the covariance `(9, 9)` after a first position."""

    def process(self, dt_s: float) -> Array:
        """Return Q `(9, 9)` of one prediction over `dt_s`."""

    def position_variance(self, t_s: Array) -> Array:
        """Return what Q has added to each axis's position after `t_s` (n, 1), m^2: `(n, 3)`."""

    def sensor(self, measurement: Measurement) -> Array | None:
        """Return R `(3, 3)`, or None when this filter has no use for the measurement."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportNoise:
    """The report's: the same variance for every state at every step, positions only."""

    config: LkfReportConfig

    def initial(self, fix: Measurement) -> Array:  # noqa: ARG002 (the report starts the same whatever the fix)
        """Return P0."""
        return self.config.initial_variance * np.eye(9)

    def process(self, dt_s: float) -> Array:
        """Return the variance of as many steps as `dt_s` holds."""
        return self._rate() * dt_s * np.eye(9)

    def position_variance(self, t_s: Array) -> Array:
        """Return the sum over all steps in the limit of short ones, the same for the three axes."""
        return np.tile(self._rate() * (t_s + t_s**3 / 3 + t_s**5 / 20), 3)

    def sensor(self, measurement: Measurement) -> Array | None:
        """Return the report's R for a position."""
        return self.config.fix_variance_m2 * I3 if measurement.quantity is Quantity.POSITION else None

    def _rate(self) -> float:
        return self.config.step_variance / self.config.step_s


@dataclass(frozen=True, slots=True, kw_only=True)
class WhiteJerkNoise:
    """Continuous white jerk, and the sensors' own covariances for positions and velocities."""

    config: LkfConfig

    def initial(self, fix: Measurement) -> Array:
        """Return the fix's covariance beside the priors of velocity and acceleration."""
        covariance = np.zeros((9, 9))
        covariance[:3, :3] = fix.covariance
        covariance[3:6, 3:6] = self.config.initial_speed_std_m_s**2 * I3
        covariance[6:, 6:] = self.config.initial_acceleration_std_m_s2**2 * I3
        return covariance

    def process(self, dt_s: float) -> Array:
        """Return white jerk integrated over `dt_s`."""
        return np.kron(np.array(white_jerk(dt_s)), np.diag(self._psd()))

    def position_variance(self, t_s: Array) -> Array:
        """Return the first entry of `process`, for each axis."""
        return np.asarray(t_s**5 / 20 * self._psd())

    def sensor(self, measurement: Measurement) -> Array | None:
        """Return the measurement's own covariance."""
        return measurement.covariance if measurement.quantity in (Quantity.POSITION, Quantity.VELOCITY) else None

    def _psd(self) -> Array:
        horizontal = self.config.jerk_psd_m2_s5
        return np.array([horizontal, horizontal, self.config.vertical_jerk_psd_m2_s5])


OBSERVES = {
    Quantity.POSITION: np.hstack([I3, np.zeros((3, 6))]),
    Quantity.VELOCITY: np.hstack([np.zeros((3, 3)), I3, np.zeros((3, 3))]),
}
COURSE_SPEED_MIN_M_S = 1.0  # slower than this a course says nothing about the heading


def transition(dt_s: float) -> Array:
    """Return F `(9, 9)`."""
    return np.kron(np.array([[1.0, dt_s, 0.5 * dt_s**2], [0.0, 1.0, dt_s], [0.0, 0.0, 1.0]]), I3)


@dataclass(frozen=True, slots=True, kw_only=True)
class LkfModel:
    """The filter as a model for the delay buffer."""

    noise: LkfNoise

    @property
    def placed_by(self) -> Quantity:
        """The vehicle's fixes."""
        return Quantity.POSITION

    def start(self, fix: Measurement) -> Gaussian:
        """Return the state after a first position: at rest, as far as known."""
        return Gaussian(mean=np.concatenate([fix.value, np.zeros(6)]), covariance=self.noise.initial(fix))

    def predict(self, state: Gaussian, dt_s: float) -> Gaussian:
        """Return the state `dt_s` later."""
        mean, covariance = predict(state.mean, state.covariance, F=transition(dt_s), Q=self.noise.process(dt_s))
        return Gaussian(mean=mean, covariance=symmetric(covariance))

    def update(self, state: Gaussian, measurement: Measurement) -> Update[Gaussian] | None:
        """Return the state after what its noise model has a use for."""
        R = self.noise.sensor(measurement)
        if R is None:
            return None
        H = OBSERVES[measurement.quantity]
        mean, covariance = update(state.mean, state.covariance, measurement.value, R, H)
        nis = squared_norm(measurement.value - H @ state.mean, H @ state.covariance @ H.T + R)
        return Update(state=Gaussian(mean=mean, covariance=symmetric(covariance)), nis=nis, gate_nis=nis, dof=3)

    def move_frame(self, state: Gaussian, step: Measurement) -> Gaussian:
        """Return the state where the fixes have it from now on: nothing else tells it of the place."""
        return replace(state, mean=state.mean + np.pad(step.value[3:], (0, 6)))

    def recover(self, state: Gaussian, measurement: Measurement) -> Gaussian:
        """Start again: on the new position, or where it is with the velocity open."""
        if measurement.quantity is Quantity.POSITION:
            return self.start(measurement)
        return self.start(replace(measurement, value=state.mean[:3], covariance=state.covariance[:3, :3]))

    def describe(self, state: Gaussian, t_ns: int) -> VehicleEstimate:
        """Return the state; the heading is the course, known while it drives."""
        velocity, acceleration = state.mean[3:6], state.mean[6:]
        speed = math.hypot(velocity[0], velocity[1])
        drives = speed > COURSE_SPEED_MIN_M_S
        turn = velocity[0] * acceleration[1] - velocity[1] * acceleration[0]
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=state.mean[:3],
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=acceleration,
            covariance=state.covariance,
            yaw_rad=math.atan2(velocity[1], velocity[0]) if drives else None,
            yaw_rate_rad_s=float(turn) / speed**2 if drives else None,
        )

    def forecast(self, state: Gaussian, t_ns: int, offset_s: Array) -> Forecast:
        """Return the future at constant acceleration, with its spread."""
        p, v, a = state.mean[:3], state.mean[3:6], state.mean[6:]
        t = offset_s[:, None]
        velocity = v + a * t
        drives = math.hypot(v[0], v[1]) > COURSE_SPEED_MIN_M_S
        return Forecast(
            t_ns=t_ns,
            offset_s=offset_s,
            position_enu_m=p + v * t + 0.5 * a * t**2,
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=np.tile(a, (len(offset_s), 1)),
            yaw_rad=np.arctan2(velocity[:, 1], velocity[:, 0]) if drives else None,
            position_std_m=np.sqrt(_position_variance(state.covariance, t) + self.noise.position_variance(t)),
        )


def _position_variance(P: Array, t_s: Array) -> Array:
    """Diagonal of the position block of `F P F'` at every `t_s` (n, 1): `(n, 3)`."""
    pp, vv, aa = P.diagonal()[:3], P.diagonal()[3:6], P.diagonal()[6:]
    pv, va, pa = P.diagonal(3)[:3], P.diagonal(3)[3:6], P.diagonal(6)
    return np.asarray(pp + 2 * t_s * pv + t_s**2 * (vv + pa) + t_s**3 * va + 0.25 * t_s**4 * aa)
