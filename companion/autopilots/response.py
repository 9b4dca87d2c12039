"""How a drone deviates from the path that its setpoints ask for: a model of the autopilot's cascade; pure numerics.

Per axis the deviation e = p - p_path obeys the cascade of position, velocity and integral gain of the autopilot,

    e'' = -Kv e' - Kv Kp e + u,        u' = -u / T - c a_path + w,        T = Kv / Ki

u (m/s^2) pushes the drone off its path and is not made up for yet by the integrator: wind, a heavier frame, and drag,
which grows by c for each m/s that the path gains. w is white noise, such that u alone has a given standard deviation.
The path brings its own velocity and acceleration along, so a steady path makes no deviation.
State per axis (3,): e (m), e' (m/s), u (m/s^2), in W. Measured are e and e'.
Source: the position controllers of PX4 (mc_pos_control) and ArduPilot (AC_PosControl); Kalman and Bucy 1961.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm, solve_continuous_are, solve_continuous_lyapunov

from companion.core.data import Array

PUSH_STD_M_S2 = 0.5
"""Of what pushes a drone about: a gust of 3 m/s, moderate turbulence of MIL-F-8785C, at a drag of 0.17 per second."""
DRAG_PER_S = 0.17
"""Drag by mass and airspeed of a multirotor of 1 to 2 kg; 0.1 to 0.35 are usual (Faessler et al. 2018, table I)."""
POSITION_STD_M = 0.04
"""Of a report's position beside the path: a receiver with corrections, and 4 ms of its date at 8 m/s."""
VELOCITY_STD_M_S = 0.1
"""Likewise of its velocity."""
REPORT_PERIOD_S = 0.02
_ONE = np.eye(3)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cascade:
    """The gains of a position controller along a horizontal axis, and how it takes setpoints.

    Attributes:
        position_per_s: velocity per position error.
        velocity_per_s: acceleration per velocity error.
        integral_per_s2: acceleration per integrated velocity error.
        lead_s: by which a setpoint is to be ahead of the drone beside the link's delay: half of what it is held.
    """

    position_per_s: float
    velocity_per_s: float
    integral_per_s2: float
    lead_s: float


class ResponseModel:
    """The model of one autopilot with constant matrices, which are made once.

    Args:
        cascade: of the autopilot.
        offset_s: (n,) evenly spaced from 0, at which `predict` tells the deviation.

    Attributes:
        cascade: as given.
        covariance: (3, 3) of the estimated state, stationary.
        spread: (3, 3) of the state of a drone that follows as the model says, stationary.
    """

    def __init__(self, cascade: Cascade, offset_s: Array) -> None:
        stiffness = cascade.velocity_per_s * cascade.position_per_s
        forgets_hz = cascade.integral_per_s2 / cascade.velocity_per_s
        self.cascade = cascade
        self._motion = np.array([[0.0, 1.0, 0.0], [-stiffness, -cascade.velocity_per_s, 1.0], [0.0, 0.0, -forgets_hz]])
        noise = np.diag([0.0, 0.0, 2.0 * forgets_hz * PUSH_STD_M_S2**2])
        seen = _ONE[:2]
        report = np.diag([POSITION_STD_M**2, VELOCITY_STD_M_S**2]) * REPORT_PERIOD_S
        self.covariance: Array = solve_continuous_are(self._motion.T, seen.T, noise, report)
        self.spread: Array = solve_continuous_lyapunov(self._motion, -noise)
        self._gain = self.covariance @ seen.T @ np.linalg.inv(report)
        self._corrected = self._motion - self._gain @ seen
        self._free, self._forced = _responses(self._motion, np.array([0.0, 0.0, -DRAG_PER_S]), offset_s)

    def update(self, state: Array, measured: Array, acceleration_m_s2: Array, dt_s: float) -> Array:
        """Return the state (3, k) of k axes after a report.

        Args:
            state: (3, k) `dt_s` earlier.
            measured: (2, k) position and velocity of the drone less those of the path.
            acceleration_m_s2: (k,) of the path.
            dt_s: since the report before, a tenth of a second at most.
        """
        moved, push = _taylor(self._corrected, dt_s)
        updated = moved @ state + push @ (self._gain @ measured)
        updated[2] -= DRAG_PER_S * acceleration_m_s2 * dt_s
        return np.asarray(updated)

    def carry(self, state: Array, dt_s: float) -> Array:
        """Return the state (3, k) a moment later without a report; exact to 1e-4 of it within a quarter of a second."""
        moved, _ = _taylor(self._motion, dt_s)
        return np.asarray(moved @ state)

    def predict(self, state: Array, acceleration_m_s2: Array) -> Array:
        """Return the states (n, 3, k) at the model's offsets.

        Args:
            state: (3, k) now.
            acceleration_m_s2: (n, k) of the path, each from its offset to the next.
        """
        return np.asarray(self._free @ state + self._forced @ acceleration_m_s2)


def _taylor(motion: Array, dt_s: float) -> tuple[Array, Array]:
    """Return the maps (3, 3) of a state and of a constant push over `dt_s`, to the third order."""
    step = motion * dt_s
    second = step @ step
    return _ONE + step + 0.5 * second + second @ step / 6.0, (_ONE + 0.5 * step + second / 6.0) * dt_s


def _responses(motion: Array, pushed: Array, offset_s: Array) -> tuple[Array, Array]:
    """Return the maps (n, 3, 3) of a state and (n, 3, n) of a push that is constant from each offset to the next."""
    count, spacing_s = len(offset_s), float(offset_s[1] - offset_s[0])
    augmented = expm(np.block([[motion, pushed[:, np.newaxis]], [np.zeros((1, 4))]]) * spacing_s)
    powers = np.array([np.linalg.matrix_power(augmented[:3, :3], power) for power in range(count)])
    forced = np.zeros((count, 3, count))
    for later in range(count):
        for earlier in range(later):
            forced[later, :, earlier] = powers[later - 1 - earlier] @ augmented[:3, 3]
    return powers, forced
