"""Linear-quadratic control about hover: the report's, and one with feed-forward.

Linear model (report, eqs. 6-8): state [x y z, phi theta psi, p q r, vx vy vz] in m, rad, rad/s, m/s; input
[dT L M N] in N, N m; output [x y z psi]. The report's regulator adds the integrals of `r - y`: `u = -K x + Ki xi`,
so the reference enters through the integrators alone (eqs. 9-11).

`lqr_feedforward` takes the gains of the same problem without integrators, as a cascade:
`M = -k_th (th - th_d) - k_q q` with `th_d = a / g` and `a` from the outer loop, whose disturbance observer is its
integral action; with a firmware's gains `a` is that firmware's. Angles are Euler's, as in the linear model; tilt is
compensated in the thrust.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm, solve_continuous_are

from link.compiled import kernel
from sim_autopilot.control.parameters import (
    HAS_POSITION,
    HAS_YAW,
    HEADING,
    INTEGRAL,
    VELOCITY,
    YAW,
    CascadeGains,
)
from sim_autopilot.core.data import Array
from sim_autopilot.physics.airframe import GRAVITY_M_S2, Airframe
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import euler_angles, wrapped

_STEP_S, _END_S = 1e-3, 6.0  # of the linear loop's answer
OUTPUTS = (0, 1, 2, 5)
REPORT_Q = np.diag([1.0] * 3 + [0.1] * 3 + [1e-4] * 3 + [0.1] * 3 + [1500.0] * 4)
REPORT_R = 0.1 * np.eye(4)
GOAL = 5
"""Where in its memory `lqr` keeps the heading that it goes to."""


def linear_model(airframe: Airframe) -> tuple[Array, Array, Array]:
    """Return A (12, 12), B (12, 4), C (4, 12) about hover at heading zero. Source: report, eqs. 6-8."""
    A = np.zeros((12, 12))
    A[0:3, 9:12] = np.eye(3)
    A[3:6, 6:9] = np.eye(3)
    A[9, 4] = GRAVITY_M_S2
    A[10, 3] = -GRAVITY_M_S2
    B = np.zeros((12, 4))
    B[11, 0] = 1.0 / airframe.mass_kg
    B[6:9, 1:4] = np.diag(1.0 / np.array(airframe.inertia_kg_m2))
    return A, B, np.eye(12)[list(OUTPUTS)]


def report_gains(airframe: Airframe) -> tuple[Array, Array]:
    """Return K (4, 12) and Ki (4, 4) of `u = -K x + Ki xi`, from the report's Q and R (eqs. 9-11)."""
    A, B, C = linear_model(airframe)
    augmented = np.zeros((16, 16))
    augmented[:12, :12] = A
    augmented[12:, :12] = -C
    inputs = np.vstack([B, np.zeros((4, 4))])
    riccati = solve_continuous_are(augmented, inputs, REPORT_Q, REPORT_R)
    gain = np.linalg.solve(REPORT_R, inputs.T @ riccati)
    return np.asarray(gain[:, :12], dtype=np.float64), np.asarray(-gain[:, 12:], dtype=np.float64)


POSITION_SCALE_M = 0.25
VELOCITY_SCALE_M_S = 1.0
ANGLE_SCALE_RAD = 1.0
ANGULAR_VELOCITY_SCALE_RAD_S = 4.0
HEADING_SCALE_RAD = 0.25
HEADING_RATE_SCALE_RAD_S = 1.0
"""Bryson's rule: each of these deviations costs as much as the whole input: half the weight; as torque one rotor of a
pair stopped, and in yaw half the thrust moved from one pair to the other. From a search over 0.1 to 0.4 m and 0.3 to
1.5 m/s: with motors of 60 rad/s a unit step along x settles in 1.14 s and overshoots by 0.1 % in linear theory."""


def feedforward_gains(airframe: Airframe) -> CascadeGains:
    """Return the gains of `lqr_feedforward` as a cascade: accelerations per error, not torques."""
    A, B, _ = linear_model(airframe)
    torque = 0.25 * airframe.weight_n * airframe.arm_m
    yaw_torque = 0.5 * airframe.weight_n * airframe.torque_coefficient_n_m_s2 / airframe.thrust_coefficient_n_s2
    scales = [POSITION_SCALE_M] * 3
    scales += [ANGLE_SCALE_RAD, ANGLE_SCALE_RAD, HEADING_SCALE_RAD]
    scales += [ANGULAR_VELOCITY_SCALE_RAD_S, ANGULAR_VELOCITY_SCALE_RAD_S, HEADING_RATE_SCALE_RAD_S]
    scales += [VELOCITY_SCALE_M_S] * 3
    Q = np.diag(1.0 / np.square(scales))
    R = np.diag(1.0 / np.square([0.5 * airframe.weight_n, torque, torque, yaw_torque]))
    K = np.linalg.solve(R, B.T @ solve_continuous_are(A, B, Q, R))
    attitude, rate = (tuple(float(K[1 + i, j + i]) / airframe.inertia_kg_m2[i] for i in range(3)) for j in (3, 6))
    mass = airframe.mass_kg
    g = GRAVITY_M_S2
    return CascadeGains(
        position=(g * K[2, 0] / K[2, 4], -g * K[1, 1] / K[1, 3], K[0, 2] / mass),
        velocity=(g * K[2, 9] / K[2, 4], -g * K[1, 10] / K[1, 3], K[0, 11] / mass),
        attitude=(attitude[0], attitude[1], attitude[2]),
        rate=(rate[0], rate[1], rate[2]),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class StepResponse:
    """How an output answers a unit step of its reference.

    Attributes:
        settling_s: after which it stays within 2 % of the step.
        overshoot: highest value beyond the step, as a part of it.
    """

    settling_s: float
    overshoot: float


def measured_step(t_s: Array, output: Array) -> StepResponse:
    """Return settling time and overshoot of the response `output` (n,) to a unit step at `t_s` (n,) = 0."""
    outside = np.flatnonzero(np.abs(output - 1.0) > 0.02)
    settling = 0.0 if outside.size == 0 else float(t_s[min(int(outside[-1]) + 1, t_s.size - 1)])
    return StepResponse(settling_s=settling, overshoot=max(0.0, float(output.max()) - 1.0))


def linear_step(airframe: Airframe, output: int) -> tuple[Array, Array]:
    """Return the answer of the report's closed linear loop to a unit step of an output, exactly.

    Args:
        airframe: that the loop flies.
        output: its place in `OUTPUTS`.

    Returns:
        Time (n,), s, and the output (n,), in its own unit.
    """
    A, B, C = linear_model(airframe)
    K, Ki = report_gains(airframe)
    closed = np.zeros((17, 17))
    closed[:12, :12] = A - B @ K
    closed[:12, 12:16] = B @ Ki
    closed[12:16, :12] = -C
    closed[12 + output, 16] = 1.0  # the last state is the constant reference
    transition = expm(closed * _STEP_S)
    state = np.zeros(17)
    state[16] = 1.0
    t_s = np.arange(0.0, _END_S, _STEP_S)
    response = np.empty_like(t_s)
    for i in range(t_s.size):
        response[i] = state[OUTPUTS[output]]
        state = transition @ state
    return t_s, response


@kernel
def fill_report_state(y: Array, rotation: Array, memory: Array, out: Array) -> None:
    """Write the linear model's state (12,) relative to where the controller started."""
    roll, pitch, yaw = euler_angles(rotation)
    out[3], out[4], out[5] = roll, pitch, wrapped(yaw - memory[HEADING])
    for i in range(3):
        out[i] = y[i] - memory[VELOCITY + i]
        out[6 + i] = y[10 + i]
        out[9 + i] = y[7 + i]


@kernel
def fill_report_wrench(
    y: Array, rotation: Array, memory: Array, reference: Array, control: Record, body: Record, state: Array, out: Array
) -> None:
    """Write [T, L, M, N] of the report's regulator and integrate its errors; `state` (12,) is scratch.

    Positions count from where it started, by the model's own invariance, so starting is no step. Without a position
    in the reference the integrals stand, and the drone stays.
    """
    fill_report_state(y, rotation, memory, state)
    if reference[HAS_YAW] > 0.0:
        memory[GOAL] = reference[YAW]
    if reference[HAS_POSITION] > 0.0:
        for i in range(3):
            memory[INTEGRAL + i] += control["period_s"] * (reference[i] - y[i])
    memory[INTEGRAL + 3] += control["period_s"] * wrapped(memory[GOAL] - memory[HEADING] - state[5])
    K = control["lqr_state"]
    Ki = control["lqr_integral"]
    for i in range(4):
        out[i] = body["mass_kg"] * GRAVITY_M_S2 if i == 0 else 0.0
        for j in range(12):
            out[i] -= K[i, j] * state[j]
        for j in range(4):
            out[i] += Ki[i, j] * memory[INTEGRAL + j]


@kernel
def fill_feedforward_wrench(
    y: Array, rotation: Array, force: Array, memory: Array, heading_rate_rad_s: float, control: Record, body: Record,
    out: Array,
) -> None:  # fmt: skip
    """Write [T, L, M, N] that leans, by Euler angles, towards the specific force `force` (3,)."""
    roll, pitch, yaw = euler_angles(rotation)
    cosine = math.cos(yaw)
    sine = math.sin(yaw)
    ahead = cosine * force[0] + sine * force[1]
    left = cosine * force[1] - sine * force[0]
    pitch_wanted = math.atan2(ahead, force[2])
    roll_wanted = math.atan2(-left * math.cos(pitch_wanted), force[2])
    errors = (roll - roll_wanted, pitch - pitch_wanted, wrapped(yaw - memory[HEADING]))
    out[0] = body["mass_kg"] * force[2] / max(0.5, rotation[8])
    for i in range(3):
        rate = y[10 + i] - (heading_rate_rad_s if i == 2 else 0.0)
        acceleration = -control["attitude_gain"][i] * errors[i] - control["rate_gain"][i] * rate
        out[1 + i] = body["inertia_kg_m2"][i] * acceleration
