"""How wrong the autopilot's estimate of its own state is: second-order Gauss-Markov errors of position and velocity.

Such an error has the correlation `(1 + |t| / T) exp(-|t| / T)`. White noise on every report would be wrong: between two
corrections an extended Kalman filter integrates its inertial unit, so that its error is smooth and drifts. T of the
velocity follows from PX4's defaults: with 0.35 m/s2 of accelerometer noise (EKF2_ACC_NOISE, each 8 ms) and 0.3 m/s of a
receiver's velocity noise (EKF2_GPS_V_NOISE, each 0.2 s) the steady Kalman gain is 0.047 in 0.2 s, a memory of 4 s, here
2 T. Position lies between the filter's own memory of a second or two and its receiver's slow error of 60 s: T = 10 s.
"""

from dataclasses import dataclass

import numpy as np

from link.messages import Vector3
from sim_autopilot.air.wind import second_order_noise
from sim_autopilot.core.data import Array
from sim_autopilot.core.noise import NoiseSeed

_BLOCK = 1024  # steps whose noise is drawn at once
NO_ERROR: Array = np.zeros(6)


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnStateModel:
    """Standard deviations on each axis with their time constants T, and one step of the local frame's origin.

    Attributes:
        seed: of the errors, or the generator that draws them.
        position_std_m: zero is the truth.
        height_std_m: of the height, None where it is as good as the rest of the position.
        velocity_std_m_s: zero is the truth.
        receiver_accuracy_m: that its receiver states, None for what the firmware's own simulator says.
        position_time_s: T.
        velocity_time_s: T.
        origin_step_enu_m: how far the origin moves, None where it never does.
        origin_step_s: since boot, when.
    """

    seed: NoiseSeed = 0
    position_std_m: float = 0.0
    height_std_m: float | None = None
    velocity_std_m_s: float = 0.0
    receiver_accuracy_m: float | None = None
    position_time_s: float = 10.0
    velocity_time_s: float = 2.0
    origin_step_enu_m: Vector3 | None = None
    origin_step_s: float = 0.0


class OwnStateError:
    """The error of the estimate, step by step; the same seed gives the same one."""

    def __init__(self, model: OwnStateModel, dt_s: float) -> None:
        """Start in the steady state.

        Args:
            model: its size and memory.
            dt_s: of each step.
        """
        # The second of the two states has a variance of 1/4.
        height_std_m = model.position_std_m if model.height_std_m is None else model.height_std_m
        place_std_m = [model.position_std_m, model.position_std_m, height_std_m]
        self._gain = 2.0 * np.array([*place_std_m, *[model.velocity_std_m_s] * 3])
        self._is_exact = not self._gain.any()
        self._generator = np.random.default_rng(model.seed)
        parts = [dt_s / time_s for time_s in (model.position_time_s, model.velocity_time_s) for _ in range(3)]
        self._transition, self._noise_factor = _discrete(parts)
        n = self._generator.standard_normal((2, 6))
        # The steady covariance of both states is [1/2 1/4; 1/4 1/4].
        self._state = np.concatenate([np.sqrt(0.5) * n[0], np.sqrt(0.125) * (n[0] + n[1])])
        self._noise = np.empty((0, 12))
        self._used = 0

    def advance(self) -> Array:
        """Return position, m, and velocity, m/s, by which the estimate is off a step later, (6,) in W."""
        if self._is_exact:
            return NO_ERROR
        if self._used == len(self._noise):
            self._noise, self._used = self._generator.standard_normal((_BLOCK, 12)) @ self._noise_factor.T, 0
        self._state = self._transition @ self._state + self._noise[self._used]
        self._used += 1
        return np.asarray(self._gain * self._state[6:])


def _discrete(parts: list[float]) -> tuple[Array, Array]:
    """Return transition and noise factor, each (12, 12), of six pairs of states over a step of so many T."""
    elapsed = np.array(parts)
    remaining = np.exp(-elapsed)
    along, across, rest = np.array([second_order_noise(part) for part in parts]).T
    none = np.zeros((6, 6))
    transition = np.block([[np.diag(remaining), none], [np.diag(remaining * elapsed), np.diag(remaining)]])
    return transition, np.block([[np.diag(along), none], [np.diag(across), np.diag(rest)]])
