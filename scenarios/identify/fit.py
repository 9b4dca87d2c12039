"""The law that explains a flight best: the autopilot's own gains, with the lags and the drag that no parameter tells.

Along a horizontal axis, with the reference r (as shaped, where the firmware shapes a path) `delay` later:

    p' = v,  v' = a - c v
    a' = (r'' + Kv (r' + Kp (r - p) - v) + i + Kd s - a) / tau
    i' = Ki (r' + Kp (r - p) - v)

Kp, Kv, Ki and Kd follow from the parameters; s is the slope of the velocity's error, r'' - v', or of -v. tau (s) stands
for attitude and motors, c (1/s) for drag by mass and airspeed; tau, c and the delay (s) minimise the squares of the
differences from the flight, both axes together.
Source: mc_pos_control (PX4), AC_PosControl (ArduPilot); Levenberg and Marquardt as in scipy.optimize.least_squares.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lsim

from companion.core.data import Array
from scenarios.identify.manoeuvres import DURATION_S, wish_at
from scenarios.identify.pilot import Flight
from sim_autopilot.core.limits import PathLimits
from sim_autopilot.setpoints.path import Motion, carry_on, correction_speed, lead_to_position

_STEP_S = 0.01
_START, _LEAST, _MOST = (0.1, 0.2, 0.02), (0.01, 0.0, -0.1), (0.6, 1.5, 0.3)
"""Of tau, c and the delay: a clock that is fitted late by less than 0.1 s may make the delay negative."""
_UNLIMITED = 1e3


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """What was fitted, and by how much the flight differs from it, RMS of both horizontal axes."""

    lag_s: float
    drag_per_s: float
    delay_s: float
    rms_m: float

    def to_json(self) -> dict[str, float]:
        """Return it by name."""
        return {name: getattr(self, name) for name in self.__slots__}


def fit_law(flight: Flight) -> Law:
    """Return the law of a flight."""
    grid_s = np.arange(0.0, DURATION_S, _STEP_S)
    wishes = np.array([wish_at(t) for t in grid_s])
    asked = _shaped(flight, wishes) if flight.shaping is not None else wishes
    inside = (flight.t_s > grid_s[0]) & (flight.t_s < grid_s[-1])

    def differences(guess: Array) -> Array:
        lag_s, drag_per_s, delay_s = guess
        flown = [_flown(flight, asked[:, :, axis], lag_s, drag_per_s, grid_s) for axis in (0, 1)]
        at_s = flight.t_s[inside] - delay_s
        modelled = np.column_stack([np.interp(at_s, grid_s, one) for one in flown])
        return np.asarray((modelled - flight.position_m[inside, :2]).ravel())

    found = least_squares(differences, _START, bounds=(_LEAST, _MOST), x_scale=(0.1, 0.1, 0.02))
    lag_s, drag_per_s, delay_s = map(float, found.x)
    rms_m = float(np.sqrt(np.mean(found.fun**2)) * np.sqrt(2.0))
    return Law(lag_s=lag_s, drag_per_s=drag_per_s, delay_s=delay_s, rms_m=rms_m)


def _flown(flight: Flight, asked: Array, lag_s: float, drag_per_s: float, grid_s: Array) -> Array:
    """Return the place (n,) of a drone that follows `asked` (n, 3): place, velocity and acceleration on an axis."""
    gains, turns_hz = flight.cascade, 1.0 / lag_s
    kp, kv, ki, kd = gains.position_per_s, gains.velocity_per_s, gains.integral_per_s2, gains.derivative
    fed = turns_hz * (1.0 + kd * gains.derives_error)
    a_row = np.array([-kv * kp, -kv + kd * drag_per_s, -1.0 - kd, 1.0]) * turns_hz
    motion = np.array([[0, 1, 0, 0], [0, -drag_per_s, 1, 0], a_row, [-ki * kp, -ki, 0, 0]], dtype=np.float64)
    driven = np.array([[0, 0, 0], [0, 0, 0], [turns_hz * kv * kp, turns_hz * kv, fed], [ki * kp, ki, 0]])
    system = (motion, driven, np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros((1, 3)))
    return np.asarray(lsim(system, asked, grid_s)[1])


def _shaped(flight: Flight, wishes: Array) -> Array:
    """Return the path (n, 3, 3) to which the firmware shapes what is asked for (n, 3, 3)."""
    shaping = flight.shaping
    if shaping is None:
        raise ValueError("this firmware shapes no path")
    limits = PathLimits(
        speed_m_s=_UNLIMITED,
        climb_m_s=_UNLIMITED,
        descent_m_s=_UNLIMITED,
        acceleration_m_s2=shaping.acceleration_m_s2,
        vertical_acceleration_m_s2=shaping.vertical_acceleration_m_s2,
        jerk_m_s3=shaping.jerk_m_s3,
        vertical_jerk_m_s3=shaping.vertical_jerk_m_s3,
        timeout_s=shaping.carried_s,
        throttle_slew_s=0.0,
    )
    path, way = Motion(position=(0.0, 0.0, 0.0)), []
    for place, velocity, acceleration in wishes.tolist():
        target = Motion(position=tuple(place), velocity=tuple(velocity), acceleration=tuple(acceleration))
        path = lead_to_position(path, target, limits, correction_speed(limits), _STEP_S)
        way.append((path.position, path.velocity, path.acceleration))
        path = carry_on(path, _STEP_S)
    return np.array(way)
