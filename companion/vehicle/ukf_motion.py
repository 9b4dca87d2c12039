"""Compiled motion of a car-like vehicle: along its arc, by its own acceleration (Baca et al. 2019, JFR).

State (8,): x, y in m, heading in rad (not wrapped), speed in m/s, acceleration along the track in m/s^2, curvature in
rad/m, height in m, climb in m/s. The heading is also the course. The acceleration fades with a time constant; while it
brakes the vehicle stops and does not drive backwards. Without distance there is no turn, so standing still is stable.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.small_matrices import white_jerk

SIZE = 8


@compiled_kernel
def drive(state: Array, dt_s: float, decay_s: float) -> Array:
    """Return the state (8,) after `dt_s` with an acceleration that fades with `decay_s`."""
    _, _, heading, speed, acceleration, curvature, _, climb = state
    fade = math.exp(-dt_s / decay_s)
    gained = acceleration * decay_s * (1.0 - fade)
    moving_s = dt_s
    stops = speed * acceleration < 0.0 and abs(gained) >= abs(speed)
    if stops:
        moving_s = -decay_s * math.log(max(1.0 + speed / (acceleration * decay_s), 1e-12))
    relaxed = decay_s * (1.0 - math.exp(-moving_s / decay_s))
    distance = speed * moving_s + acceleration * decay_s * (moving_s - relaxed)
    half = 0.5 * curvature * distance
    chord = distance * (math.sin(half) / half if abs(half) > 1e-6 else 1.0)
    after = state.copy()
    after[0] += chord * math.cos(heading + half)
    after[1] += chord * math.sin(heading + half)
    after[2] += 2.0 * half
    after[3] = 0.0 if stops else speed + gained
    after[4] = 0.0 if stops else acceleration * fade
    after[6] += climb * dt_s
    return after


@compiled_kernel
def drive_all(states: Array, offset_s: Array, decay_s: float) -> Array:
    """Return `(n, k, 8)`: each of `states` (k, 8) at each of `offset_s` (n,)."""
    after = np.empty((len(offset_s), *states.shape))
    for i in range(len(offset_s)):
        for j in range(len(states)):
            after[i, j] = drive(states[j], offset_s[i], decay_s)
    return after


def kinematics(states: Array) -> Array:
    """Return position, velocity and acceleration in W, `(k, 9)`, of `states` (k, 8)."""
    x, y, heading, speed, acceleration, curvature, z, climb = states.T
    c, s, normal = np.cos(heading), np.sin(heading), curvature * speed**2
    level = np.zeros_like(x)
    along, across = acceleration * c - normal * s, acceleration * s + normal * c
    return np.column_stack([x, y, z, speed * c, speed * s, climb, along, across, level])


def process_noise(state: Array, dt_s: float, psd: Array) -> Array:
    """Return Q `(8, 8)` over `dt_s`.

    Args:
        state: mean (8,).
        dt_s: step.
        psd: (5,) jerk along the track, m^2/s^5; lateral acceleration, m^2/s^5; lowest speed for the curvature, m/s;
            heading, rad^2/s, from 1 m/s on; vertical acceleration, m^2/s^3.
    """
    d, heading, speed = dt_s, state[2], abs(state[3])
    Q = np.zeros((SIZE, SIZE))
    along = np.zeros((SIZE, 3))
    along[0, 0], along[1, 0], along[3, 1], along[4, 2] = math.cos(heading), math.sin(heading), 1.0, 1.0
    Q += psd[0] * along @ np.array(white_jerk(d)) @ along.T
    Q[2, 2] = psd[3] * min(speed, 1.0) ** 2 * d
    Q[5, 5] = psd[1] / max(speed, psd[2]) ** 4 * d
    Q[6:, 6:] = psd[4] * np.array([[d**3 / 3, d**2 / 2], [d**2 / 2, d]])
    return Q


def track_variance(state: Array, offset_s: Array, psd: Array) -> Array:
    """Return what noise alone does to the position at `offset_s` (n,), m^2 along x, y, z: `(n, 3)`.

    Curvature that wanders by lateral acceleration over v^2 is white lateral jerk at the speed v.
    """
    c2 = math.cos(state[2]) ** 2
    along = psd[0] * offset_s**5 / 20
    across = psd[1] * min(abs(state[3]) / psd[2], 1.0) ** 4 * offset_s**5 / 20
    return np.column_stack([c2 * along + (1 - c2) * across, (1 - c2) * along + c2 * across, psd[4] * offset_s**3 / 3])
