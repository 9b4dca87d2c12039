"""One step of a damped oscillator that noise drives, of a deck's heave, roll or pitch, compiled."""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.small_matrices import carried_through, times

_DOUBLINGS = 6


@compiled_kernel
def heave_step(dt_s: float, frequency_rad_s: float, damping: float, std_m: float) -> tuple[Array, Array]:
    """Return transition and noise, each (2, 2), of a damped oscillator driven by white noise to a steady `std_m`."""
    damped = frequency_rad_s * math.sqrt(1.0 - damping**2)
    fade = math.exp(-damping * frequency_rad_s * dt_s)
    c, s = math.cos(damped * dt_s), math.sin(damped * dt_s)
    ratio = damping * frequency_rad_s / damped
    A = np.empty((2, 2))
    A[0, 0], A[0, 1] = fade * (c + ratio * s), fade * (s / damped)
    A[1, 0], A[1, 1] = fade * (-(frequency_rad_s**2) / damped * s), fade * (c - ratio * s)
    place, rate = std_m**2, (std_m * frequency_rad_s) ** 2
    noise = np.empty((2, 2))
    noise[0, 0] = place - (A[0, 0] * place * A[0, 0] + A[0, 1] * rate * A[0, 1])
    noise[1, 1] = rate - (A[1, 0] * place * A[1, 0] + A[1, 1] * rate * A[1, 1])
    noise[0, 1] = noise[1, 0] = -(A[0, 0] * place * A[1, 0] + A[0, 1] * rate * A[1, 1])
    return A, noise


@compiled_kernel
def smooth_step(dt_s: float, frequency_rad_s: float, damping: float, std_m_s: float) -> tuple[Array, Array]:
    """Return transition and noise, each (3, 3), of a place whose rate is such an oscillator, to a steady `std_m_s`.

    The noise is that of a 64th of the step, where it is that of white jerk, added up by doubling.
    """
    psd = 4.0 * damping * frequency_rad_s**3 * std_m_s**2
    d = dt_s / 2**_DOUBLINGS
    A, noise = np.eye(3), np.empty((3, 3))
    A[1:, 1:], _ = heave_step(d, frequency_rad_s, damping, std_m_s)
    for i, started in enumerate(((1.0, 0.0), (0.0, 1.0))):  # integrate w'' + 2 d f w' + f^2 w = 0
        gained = A[2, 1 + i] - started[1] + 2.0 * damping * frequency_rad_s * (A[1, 1 + i] - started[0])
        A[0, 1 + i] = -gained / frequency_rad_s**2
    white_jerk = ((d**5 / 20, d**4 / 8, d**3 / 6), (d**4 / 8, d**3 / 3, d**2 / 2), (d**3 / 6, d**2 / 2, d))
    for i in range(3):
        for j in range(3):
            noise[i, j] = psd * white_jerk[i][j]
    for _ in range(_DOUBLINGS):
        noise = carried_through(A, noise) + noise
        A = times(A, A)
    return A, noise
