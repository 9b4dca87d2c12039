"""The rigid body in flight (report, eqs. 2-4), with linear and quadratic drag on airspeed.

State `y` (13,): p_WB m, q_WB wxyz, v_WB m/s, w_WB_B rad/s. World ENU, body FLU.
`m dv = m g + f`, `dq = q * [0, w] / 2`, `I dw = -w x I w + torque`; f is every force but gravity, in W.
"""

import math

from link.compiled import kernel
from sim_autopilot.core.data import Array
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.physics.parameters import Record

STATE_SIZE = 13


@kernel
def fill_derivative(y: Array, force: Array, torque: Array, body: Record, out: Array) -> None:
    """Write dy/dt (13,) under `force` (3,) in W, N without gravity, and `torque` (3,) in B, N m."""
    mass = body["mass_kg"]
    inertia = body["inertia_kg_m2"]
    p, q, r = y[10], y[11], y[12]
    for i in range(3):
        out[i] = y[7 + i]
        out[7 + i] = force[i] / mass
    out[9] -= GRAVITY_M_S2
    out[3] = 0.5 * (-y[4] * p - y[5] * q - y[6] * r)
    out[4] = 0.5 * (y[3] * p + y[5] * r - y[6] * q)
    out[5] = 0.5 * (y[3] * q + y[6] * p - y[4] * r)
    out[6] = 0.5 * (y[3] * r + y[4] * q - y[5] * p)
    out[10] = (torque[0] - (inertia[2] - inertia[1]) * q * r) / inertia[0]
    out[11] = (torque[1] - (inertia[0] - inertia[2]) * r * p) / inertia[1]
    out[12] = (torque[2] - (inertia[1] - inertia[0]) * p * q) / inertia[2]


@kernel
def fill_flight_forces(
    y: Array, rotation: Array, wrench: Array, wind: Array, body: Record, force: Array, torque: Array
) -> None:
    """Write the force (3,) in W and the torque (3,) in B of `wrench` [T, L, M, N] and of drag."""
    u, v, w = y[7] - wind[0], y[8] - wind[1], y[9] - wind[2]
    drag = body["drag_n_s_m"] + body["drag_n_s2_m2"] * math.sqrt(u * u + v * v + w * w)
    for i in range(3):
        force[i] = rotation[3 * i + 2] * wrench[0] - drag * (y[7 + i] - wind[i])
        torque[i] = wrench[1 + i]


@kernel
def normalise(y: Array) -> None:
    """Bring the quaternion in `y` (13,) back to unit length and w >= 0."""
    norm = math.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6])
    scale = 1.0 / norm if y[3] >= 0.0 else -1.0 / norm
    for i in range(3, 7):
        y[i] *= scale
