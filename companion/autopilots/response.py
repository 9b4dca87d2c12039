"""How a drone deviates from the path that its setpoints ask for: a model of the autopilot's cascade; pure numerics.

Per axis the deviation e = p - p_path obeys the cascade of position, velocity and integral gain of the autopilot, behind
the lag of the drone's attitude:

    e'' = a + u - a_path
    a' = (a_path - Kv e' - Kv Kp e - Kd s - a) / tau
    u' = -u / T - c a_path + w,        T = Kv / Ki

a (m/s^2) is what the drone's lean accelerates it by. u (m/s^2) pushes it off its path and is not made up for yet by the
integrator: wind, a heavier frame, and drag, which grows by c for each m/s that the path gains. w is white noise, such
that u alone has a given standard deviation. A steady path makes no deviation. s is the slope whose gain is Kd: that of
the velocity's error, a - a_path (ArduPilot), or of the velocity, a (PX4), which holds against the path's own
acceleration, too. What u adds to it is left out.
A led setpoint asks for (1 + Kd) a_path + tau a_path' in place of a_path, so that a drone without a deviation leans as
its path accelerates, at once. Its a is what it leans beyond that: it obeys the equations with a_path left out of a'
and of e''.
State per axis (4,): e (m), e' (m/s), a, u, in W. Measured are e and e'.
Source: the position controllers of PX4 (mc_pos_control) and ArduPilot (AC_PosControl); Kalman and Bucy 1961.
"""

import math

import numpy as np
from msgspec import Struct
from scipy.linalg import expm, solve_continuous_are, solve_continuous_lyapunov

from companion.core.data import Array
from companion.planning.following import Following

DRAG_PER_S = 0.25
"""Drag by mass and airspeed, which no autopilot tells: the benchmark's airframe has 0.17 (0.25 N s/m by 1.5 kg), the
simulations of PX4 and ArduCopter 0.3 and 0.38."""
PUSH_STD_M_S2 = 0.75
"""Of what pushes a drone about: a gust of 3 m/s, moderate turbulence of MIL-F-8785C, at that drag."""
ATTITUDE_LAG_S = 0.1
"""From a wanted acceleration to the drone's, where no parameter tells it."""
RATE_LAG_S = 0.05
"""Of turn rates: motors of 0.05 s behind a controller that makes up for what it costs itself."""
POSITION_STD_M = 0.04
"""Of a report's position beside the path: a receiver with corrections, and 4 ms of its date at 8 m/s."""
VELOCITY_STD_M_S = 0.1
"""Of a report's velocity."""
REPORT_PERIOD_S = 0.02
STATES = 4
_ONE = np.eye(STATES)
_PUSH = 3
_STEP_MAX_S = 0.05


class Cascade(Struct, frozen=True, kw_only=True):
    """The gains of a position controller along a horizontal axis, and how it takes setpoints.

    Attributes:
        position_per_s: velocity per position error.
        velocity_per_s: acceleration per velocity error.
        integral_per_s2: acceleration per integrated velocity error.
        derivative: acceleration per slope of the velocity, or of its error.
        derives_error: whether it is the error's.
        attitude_lag_s: from a wanted acceleration to the drone's.
        is_led: whether setpoints are led: where an autopilot adds the acceleration asked for to its corrections as it
            comes. One that makes a path of its own of it would take that for another place.
        lead_s: by which a setpoint is to be ahead of the drone beside the link's delay: half of what it is held.
    """

    position_per_s: float
    velocity_per_s: float
    integral_per_s2: float
    lead_s: float
    derivative: float = 0.0
    derives_error: bool = False
    attitude_lag_s: float = ATTITUDE_LAG_S
    is_led: bool = False

    @property
    def turns_hz(self) -> float:
        """How fast the drone's lean goes to `path_share` of the path's acceleration, less what the errors take."""
        return (1.0 + self.derivative) / self.attitude_lag_s

    @property
    def forgets_hz(self) -> float:
        """How fast the integrator makes up for what pushes the drone off its path."""
        return self.integral_per_s2 / self.velocity_per_s

    @property
    def lean_lag_s(self) -> float:
        """By how much the drone's lean is behind what the path asks for; a lead makes up for all but its rates'."""
        return RATE_LAG_S if self.is_led else 1.0 / self.turns_hz

    @property
    def path_share(self) -> float:
        """The part of the path's acceleration that the drone leans by, since the derivative may hold against it."""
        return 1.0 if self.derives_error else 1.0 / (1.0 + self.derivative)

    @property
    def damping_per_s(self) -> float:
        """Acceleration that is leaned for, by the velocity's error."""
        return self.velocity_per_s / (1.0 + self.derivative)

    @property
    def stiffness_per_s2(self) -> float:
        """Acceleration that is leaned for, by the position's error."""
        return self.damping_per_s * self.position_per_s

    def lead(self, acceleration_m_s2: Array, jerk_m_s3: Array) -> Array:
        """Return the acceleration (k,) to ask for, so that the drone leans for this one though its lean lags."""
        return np.asarray((acceleration_m_s2 + jerk_m_s3 / self.turns_hz) / self.path_share)


class ResponseModel:
    """The model of one autopilot with constant matrices, which are made once.

    Args:
        cascade: of the autopilot.
        offset_s: (n,) evenly spaced from 0, at which `predict` tells the deviation.

    Attributes:
        cascade: as given.
        following: the motion of the deviation that a path's acceleration makes.
        covariance: (4, 4) of the estimated state, stationary, in gusts of `PUSH_STD_M_S2`, which its gain is made for.
        report_covariance: (4, 4) the part of it that the reports' errors make.
        spread: (4, 4) of the state of a drone that follows as the model says, stationary.
    """

    def __init__(self, cascade: Cascade, offset_s: Array) -> None:
        forgets_hz, turns_hz = cascade.forgets_hz, cascade.turns_hz
        self.cascade = cascade
        self._motion = np.array(
            [
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 1.0],
                [-turns_hz * cascade.stiffness_per_s2, -turns_hz * cascade.damping_per_s, -turns_hz, 0.0],
                [0.0, 0.0, 0.0, -forgets_hz],
            ]
        )
        leans = np.array([0.0, 0.0, 0.0, 0.0] if cascade.is_led else [0.0, -1.0, turns_hz * cascade.path_share, 0.0])
        self._asked = leans - np.array([0.0, 0.0, 0.0, DRAG_PER_S])
        noise = np.zeros((STATES, STATES))
        noise[_PUSH, _PUSH] = 2.0 * forgets_hz * PUSH_STD_M_S2**2
        seen = _ONE[:2]
        report = np.diag([POSITION_STD_M**2, VELOCITY_STD_M_S**2]) * REPORT_PERIOD_S
        self.covariance: Array = solve_continuous_are(self._motion.T, seen.T, noise, report)
        self.spread: Array = solve_continuous_lyapunov(self._motion, -noise)
        self._told: Array = np.asarray(np.linalg.inv(self.spread[:2, :2]), dtype=np.float64)
        self._gain = self.covariance @ seen.T @ np.linalg.inv(report)
        self._corrected = self._motion - self._gain @ seen
        heard = self._gain @ report @ self._gain.T
        self.report_covariance: Array = np.asarray(solve_continuous_lyapunov(self._corrected, -heard), dtype=np.float64)
        self._free, self._forced = _responses(self._motion, self._asked, offset_s)
        self.following = Following(motion=self._motion, asked=self._asked)

    def update(self, state: Array, measured: Array, acceleration_m_s2: Array, dt_s: float) -> Array:
        """Return the state (4, k) of k axes after a report.

        Args:
            state: (4, k) `dt_s` earlier.
            measured: (2, k) position and velocity of the drone less those of the path.
            acceleration_m_s2: (k,) of the path.
            dt_s: since the report before.
        """
        driven = self._gain @ measured + np.outer(self._asked, acceleration_m_s2)
        return _move(self._corrected, state, driven, dt_s)

    def covariance_in(self, push_std_m_s2: float) -> Array:
        """Return the covariance (4, 4) of the estimated state in gusts of that strength, stationary.

        The gain is fixed, so the estimate's error is the sum of what the gusts make of it and what the reports do.
        """
        of_gusts = self.covariance - self.report_covariance
        return np.asarray(self.report_covariance + (push_std_m_s2 / PUSH_STD_M_S2) ** 2 * of_gusts)

    def chi2(self, state: Array) -> Array:
        """Return how unlikely place and velocity of a state (4, k) are of a drone that follows in gusts, (k,)."""
        deviation = state[:2]
        return np.asarray(np.sum(deviation * (self._told @ deviation), axis=0))

    def carry(self, state: Array, acceleration_m_s2: Array, dt_s: float) -> Array:
        """Return the state (4, k) a moment later on a path with that acceleration (k,), without a report."""
        return _move(self._motion, state, np.outer(self._asked, acceleration_m_s2), dt_s)

    def predict(self, state: Array, acceleration_m_s2: Array) -> Array:
        """Return the states (n, 4, k) at the model's offsets.

        Args:
            state: (4, k) now.
            acceleration_m_s2: (n, k) of the path, each from its offset to the next.
        """
        return np.asarray(self._free @ state + self._forced @ acceleration_m_s2)


def _move(motion: Array, state: Array, driven: Array, dt_s: float) -> Array:
    """Return the state (4, k) after `dt_s`, driven steadily by (4, k); to the third order in short steps."""
    steps = max(1, math.ceil(dt_s / _STEP_MAX_S))
    step = motion * (dt_s / steps)
    second = step @ step
    moved, push = _ONE + step + 0.5 * second + second @ step / 6.0, _ONE + 0.5 * step + second / 6.0
    for _ in range(steps):
        state = moved @ state + push @ driven * (dt_s / steps)
    return state


def _responses(motion: Array, asked: Array, offset_s: Array) -> tuple[Array, Array]:
    """Return the maps (n, 4, 4) of a state and (n, 4, n) of an input that is constant from each offset to the next."""
    count, spacing_s = len(offset_s), float(offset_s[1] - offset_s[0])
    augmented = expm(np.block([[motion, asked[:, np.newaxis]], [np.zeros((1, STATES + 1))]]) * spacing_s)
    powers = np.array([np.linalg.matrix_power(augmented[:STATES, :STATES], power) for power in range(count)])
    forced = np.zeros((count, STATES, count))
    for later in range(count):
        for earlier in range(later):
            forced[later, :, earlier] = powers[later - 1 - earlier] @ augmented[:STATES, STATES]
    return powers, forced


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
