"""Car-like unscented Kalman filter after Baca et al. 2019 (state, motion and units in `ukf_motion`).

Until the heading is known, from a measurement or from the course of a moving vehicle, the linear filter stands in: a
car of unknown heading is no Gaussian. The filterpy object is scratch: every step loads mean and covariance, acts, and
reads them back. The sigma points all weigh the same (the centre nothing), which keeps covariances positive.
"""

import math
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

from companion.config.estimation import LkfConfig, UkfConfig
from companion.core.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from companion.vehicle.angle import short_way_round
from companion.vehicle.filter_step import Gaussian, Update, squared_norm, symmetric
from companion.vehicle.lkf import LkfModel, WhiteJerkNoise
from companion.vehicle.ukf_motion import SIZE, drive, drive_all, kinematics, process_noise, track_variance
from link.records import replace

STEP_MAX_S = 0.2  # 0.08 rad at 10 m/s with 4 m/s^2 to the side
SLIP_VARIANCE_RAD2 = 0.05**2  # by how much a course may differ from the heading


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Car:
    """A Gaussian over the car's state: mean (8,), covariance (8, 8)."""

    mean: Array
    covariance: Array


UkfState = Gaussian | Car


def _place_of(state: UkfState) -> list[int]:
    """Return the indices of the position."""
    return [0, 1, 6] if isinstance(state, Car) else [0, 1, 2]


def _position(state: Array) -> Array:
    return state[[0, 1, 6]]


def _velocity(state: Array) -> Array:
    return np.array([state[3] * math.cos(state[2]), state[3] * math.sin(state[2]), state[7]])


def _heading(state: Array) -> Array:
    return state[2:3]


def _yaw_rate(state: Array) -> Array:
    return np.asarray(state[3:4] * state[5])


SEES = {
    Quantity.POSITION: _position,
    Quantity.VELOCITY: _velocity,
    Quantity.HEADING: _heading,
    Quantity.YAW_RATE: _yaw_rate,
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UkfModel:
    """The filter as a model for the delay buffer.

    Attributes:
        config: its numbers.
        point_config: of the linear filter that stands in while the heading is unknown.
    """

    config: UkfConfig
    point_config: LkfConfig
    _point: LkfModel = field(init=False)
    _points: MerweScaledSigmaPoints = field(init=False)
    _scratch: UnscentedKalmanFilter = field(init=False)

    def __post_init__(self) -> None:
        points = MerweScaledSigmaPoints(SIZE, alpha=1.0, beta=0.0, kappa=0.0)
        fx = partial(drive, decay_s=self.config.acceleration_decay_s)
        object.__setattr__(self, "_point", LkfModel(noise=WhiteJerkNoise(config=self.point_config)))
        object.__setattr__(self, "_points", points)
        object.__setattr__(self, "_scratch", UnscentedKalmanFilter(SIZE, 3, STEP_MAX_S, _position, fx, points))

    @property
    def placed_by(self) -> Quantity:
        """The vehicle's fixes."""
        return Quantity.POSITION

    def start(self, fix: Measurement) -> UkfState:
        """Return the state after a first position: a point of unknown heading."""
        return self._point.start(fix)

    def predict(self, state: UkfState, dt_s: float) -> UkfState:
        """Return the state `dt_s` later."""
        if isinstance(state, Gaussian):
            return self._point.predict(state, dt_s)
        steps = max(math.ceil(dt_s / STEP_MAX_S - 1e-9), 1)
        for _ in range(steps):
            state = self._step(state, dt_s / steps)
        return state

    def update(self, state: UkfState, measurement: Measurement) -> Update[UkfState] | None:
        """Return the state after a position, velocity, heading or yaw rate."""
        if isinstance(state, Gaussian):
            return self._update_point(state, measurement)
        sees = SEES.get(measurement.quantity)
        return None if sees is None else self._update_car(state, measurement)

    def move_frame(self, state: UkfState, step: Measurement) -> UkfState:
        """Return the state where the fixes have it from now on: nothing else tells it of the place."""
        mean = state.mean.copy()
        mean[_place_of(state)] += step.value[3:]
        return replace(state, mean=mean)

    def recover(self, state: UkfState, measurement: Measurement) -> UkfState:
        """Start again: at the new position, or where it is with everything else open."""
        if measurement.quantity is Quantity.POSITION:
            return self.start(measurement)
        P = state.covariance
        index = _place_of(state)
        return self.start(replace(measurement, value=state.mean[index], covariance=P[np.ix_(index, index)]))

    def describe(self, state: UkfState, t_ns: int) -> VehicleEstimate:
        """Return the state, its covariance through the sigma points."""
        if isinstance(state, Gaussian):
            return replace(self._point.describe(state, t_ns), yaw_rad=None, yaw_rate_rad_s=None)
        sigmas = kinematics(self._points.sigma_points(state.mean, state.covariance))
        spread = sigmas[1:] - sigmas[1:].mean(axis=0)
        mean = sigmas[0]
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=mean[:3],
            velocity_enu_m_s=mean[3:6],
            acceleration_enu_m_s2=mean[6:],
            covariance=symmetric(spread.T @ spread / len(spread)),
            yaw_rad=short_way_round(float(state.mean[2])),
            yaw_rate_rad_s=float(state.mean[3] * state.mean[5]),
        )

    def forecast(self, state: UkfState, t_ns: int, offset_s: Array) -> Forecast:
        """Return the future along the arc, its spread through the sigma points."""
        if isinstance(state, Gaussian):
            return replace(self._point.forecast(state, t_ns, offset_s), yaw_rad=None)
        sigmas = self._points.sigma_points(state.mean, state.covariance)
        states = drive_all(sigmas, offset_s, self.config.acceleration_decay_s)
        middle = kinematics(states[:, 0])
        variance = states[:, 1:, [0, 1, 6]].var(axis=1) + track_variance(state.mean, offset_s, self._psd())
        return Forecast(
            t_ns=t_ns,
            offset_s=offset_s,
            position_enu_m=middle[:, :3],
            velocity_enu_m_s=middle[:, 3:6],
            acceleration_enu_m_s2=middle[:, 6:],
            yaw_rad=states[:, 0, 2].copy(),
            position_std_m=np.sqrt(variance),
            yaw_std_rad=math.sqrt(max(float(state.covariance[2, 2]), 0.0)),
        )

    def _step(self, state: Car, dt_s: float) -> Car:
        scratch = self._scratch
        scratch.x, scratch.P = state.mean, state.covariance
        scratch.Q = process_noise(state.mean, dt_s, self._psd())
        scratch.predict(dt=dt_s)
        return Car(mean=scratch.x, covariance=symmetric(scratch.P))

    def _update_car(self, state: Car, measurement: Measurement) -> Update[UkfState]:
        value = measurement.value
        if measurement.quantity is Quantity.HEADING:
            value = np.array([state.mean[2] + short_way_round(float(value[0] - state.mean[2]))])
        scratch = self._scratch
        scratch.x, scratch.P = state.mean, state.covariance
        scratch.sigmas_f = self._points.sigma_points(state.mean, state.covariance)
        scratch.update(value, R=measurement.covariance, hx=SEES[measurement.quantity])
        nis = squared_norm(scratch.y, scratch.S)
        car = Car(mean=scratch.x, covariance=symmetric(scratch.P))
        return Update(state=car, nis=nis, gate_nis=nis, dof=len(value))

    def _update_point(self, state: Gaussian, measurement: Measurement) -> Update[UkfState] | None:
        if measurement.quantity is Quantity.HEADING:
            car = self._car(state, float(measurement.value[0]), float(measurement.covariance[0, 0]))
            return Update(state=car, nis=1.0, gate_nis=1.0, dof=1)
        update = self._point.update(state, measurement)
        if update is None:
            return None
        mean, P = update.state.mean, update.state.covariance
        speed = math.hypot(mean[3], mean[4])
        vague = P[3, 3] + P[4, 4]
        known = speed > self.config.heading_known_speed_m_s and 9.0 * vague < speed**2
        course_variance = vague / speed**2 + SLIP_VARIANCE_RAD2 if known else math.inf
        after = self._car(update.state, math.atan2(mean[4], mean[3]), course_variance) if known else update.state
        return Update(state=after, nis=update.nis, gate_nis=update.gate_nis, dof=update.dof)

    def _car(self, state: Gaussian, heading_rad: float, heading_variance_rad2: float) -> Car:
        """The point as a car with a known heading: speed and acceleration are its components along it."""
        c, s = math.cos(heading_rad), math.sin(heading_rad)
        T = np.zeros((SIZE, 9))
        T[0, 0], T[1, 1], T[6, 2], T[7, 5] = 1.0, 1.0, 1.0, 1.0
        T[3, 3:5], T[4, 6:8] = (c, s), (c, s)
        covariance = T @ state.covariance @ T.T
        covariance[2, 2] += heading_variance_rad2
        covariance[5, 5] += self.config.curvature_std_rad_m**2
        return Car(mean=T @ state.mean + heading_rad * np.eye(SIZE)[2], covariance=symmetric(covariance))

    def _psd(self) -> Array:
        """The noise as `ukf_motion.process_noise` takes it, (5,)."""
        config = self.config
        return np.array(
            [
                config.jerk_psd_m2_s5,
                config.lateral_acceleration_psd_m2_s5,
                config.curvature_speed_min_m_s,
                config.heading_psd_rad2_s,
                config.vertical_acceleration_psd_m2_s3,
            ]
        )
