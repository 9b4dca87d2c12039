"""The report's system a second time, as a loop over arrays that shares no code with the programs.

Nonlinear model with Euler angles, regulator, linear filter, planner and noisy test, 100 steps a second; the regulator
four times as often. As in the reference simulation the planner may estimate its own virtual model, by the steady
filter of its toolbox: white noise of unit variance on the input, on each output, and on an integrator at each output
but the position, where it could not be observed. That filter runs from the start, but for the first 5 s the virtual
model does not get the planner's input: then the filter takes the standing still for a disturbance.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solve_continuous_are, solve_discrete_are

from scenarios.scoring.truth_log import Array

STEP_S = 0.01
STANDS_S = 5.0
G_M_S2 = 9.81
MASS_KG = 1.507
INERTIA = np.array([0.035, 0.046, 0.0977])
EULER = np.array([[1.0, STEP_S, 0.0], [0.0, 1.0, STEP_S], [0.0, 0.0, 1.0]])
STRAIGHT = ((0.0, 0.0), (50.0, 0.0))
CURVED = ((0.0, 0.0), (10.0, 0.0), (15.9, -1.1), (21.3, -3.5), (28.6, -8.6), (40.1, -19.8))
SCENARIOS = {
    1: (STRAIGHT, (0.0, 5.0)),
    2: (STRAIGHT, (0.0, 7.0)),
    3: (CURVED, (0.0, 5.0, 5.0, 5.0, 5.0, 5.0)),
    4: (CURVED, (0.0, 5.0, 7.0, 7.0, 7.0, 7.0)),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """First instant and place (of the drone) at which the noisy test says landed, None if never; closest truly."""

    t_s: float | None
    drone_m: tuple[float, float] | None
    closest_m: float


def shared_noise(count: int) -> Array:
    """Return unit normal draws (count,) as the reference simulation's generator gives them for its seed of 0.

    The minimal standard generator of Park and Miller (1988) and the polar method of Marsaglia.
    """
    state = 1_144_108_930
    draws = np.empty(count)
    for i in range(count):
        square = 2.0
        while square > 1.0:
            state = state * 16807 % 2147483647
            first = 2.0 * state / 2147483647 - 1.0
            state = state * 16807 % 2147483647
            second = 2.0 * state / 2147483647 - 1.0
            square = first**2 + second**2
        draws[i] = math.sqrt(-2.0 * math.log(square) / square) * first
    return draws


def drive(scenario: int) -> Array:
    """Return the vehicle's place (n, 3) at every step from the start of its standing to the end of the road."""
    waypoints, speeds = SCENARIOS[scenario]
    points = np.array(waypoints)
    knots = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    fine = np.linspace(0.0, knots[-1], 20_001)
    curve = CubicSpline(knots, points, bc_type="natural")(fine)
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1)))
    at = np.interp(knots, fine, lengths)
    durations = 2.0 * np.diff(at) / (np.array(speeds[:-1]) + np.array(speeds[1:]))
    starts = np.append(0.0, np.cumsum(durations))
    t = np.clip(np.arange(0.0, STANDS_S + starts[-1], STEP_S) - STANDS_S, 0.0, None)
    leg = np.clip(np.searchsorted(starts, t, side="right") - 1, 0, len(durations) - 1)
    since, before = t - starts[leg], np.array(speeds)[leg]
    along = at[leg] + before * since + 0.5 * (np.diff(speeds) / durations)[leg] * since**2
    return np.stack(
        [np.interp(along, lengths, curve[:, 0]), np.interp(along, lengths, curve[:, 1]), 0.0 * along], axis=1
    )


def regulator() -> tuple[Array, Array]:
    """Return K (4, 12) and Ki (4, 4)."""
    A, B, C = np.zeros((16, 16)), np.zeros((16, 4)), [0, 1, 2, 5]
    A[0:3, 9:12], A[3:6, 6:9] = np.eye(3), np.eye(3)
    A[9, 4], A[10, 3] = G_M_S2, -G_M_S2
    A[range(12, 16), C] = -1.0
    B[11, 0], B[6:9, 1:4] = 1.0 / MASS_KG, np.diag(1.0 / INERTIA)
    Q = np.diag([1.0] * 3 + [0.1] * 3 + [1e-4] * 3 + [0.1] * 3 + [1500.0] * 4)
    gain = 10.0 * B.T @ solve_continuous_are(A, B, Q, 0.1 * np.eye(4))
    return gain[:, :12], -gain[:, 12:]


def body_rate(x: Array, wrench: Array) -> Array:
    """Return the derivative (12,) of position, Euler angles, body rates and velocity."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(x[3:6]), np.cos(x[3:6])
    p, q, r = w = x[6:9]
    angles = [p + (sr * q + cr * r) * sp / cp, cr * q - sr * r, (sr * q + cr * r) / cp]
    turn = (wrench[1:] - np.cross(w, INERTIA * w)) / INERTIA
    lift = wrench[0] / MASS_KG * np.array([cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp])
    return np.concatenate([x[9:12], angles, turn, lift - [0.0, 0.0, G_M_S2]])


def flown(x: Array, wrench: Array, step_s: float) -> Array:
    """Return the body (12,) after a step of Runge and Kutta."""
    k1 = body_rate(x, wrench)
    k2 = body_rate(x + 0.5 * step_s * k1, wrench)
    k3 = body_rate(x + 0.5 * step_s * k2, wrench)
    k4 = body_rate(x + step_s * k3, wrench)
    return np.asarray(x + step_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))


class Planner:
    """The unconstrained law for all axes at once, and its estimate (5, 3) of the virtual model and two disturbances."""

    def __init__(self, *, estimates: bool) -> None:
        self._A = np.eye(5)
        self._A[:3, :3] = EULER
        self._C = np.eye(3, 5)
        self._C[1, 3] = self._C[2, 4] = 1.0 if estimates else 0.0
        self._gain = np.eye(5, 3)
        if estimates:
            noise = np.diag([0.0, 0.0, STEP_S**2, STEP_S**2, STEP_S**2]) + 1e-14 * np.eye(5)
            P = solve_discrete_are(self._A.T, self._C.T, noise, np.eye(3))
            self._gain = P @ self._C.T @ np.linalg.inv(self._C @ P @ self._C.T + np.eye(3))
        self._of_state, self._of_target, self._of_last = self._law()
        self._state = np.zeros((5, 3))
        self._state[0, 2] = 5.0
        self._last = np.zeros(3)

    def _law(self) -> tuple[Array, Array, Array]:
        """Return the first move's gains on the state (5,), the target (3,) and the last move, from 10 and 2 steps."""
        X, response = np.eye(5), np.zeros((5, 2))
        hessian, of_state, of_target = np.zeros((2, 2)), np.zeros((2, 5)), np.zeros((2, 3))
        weights = np.diag([100.0, 4.0, 0.01])
        for k in range(10):
            X, response = self._A @ X, self._A @ response
            response[2, min(k, 1)] += STEP_S
            seen = (self._C @ response).T @ weights
            hessian += seen @ self._C @ response
            of_state += seen @ self._C @ X
            of_target += seen
        change = np.array([[1.0, 0.0], [-1.0, 1.0]])
        inverse = np.linalg.inv(hessian + 0.0025 * change.T @ change)
        return (inverse @ of_state)[0], (inverse @ of_target)[0], 0.0025 * inverse[0, :1]

    def move(self, model: Array, target: Array) -> Array:
        """Return the jerk (3,) for the virtual model (3, 3) and the held target (3, 3), rows p, v, a."""
        state = self._state + self._gain @ (model - self._C @ self._state)
        self._last = self._of_target @ target - self._of_state @ state + self._of_last * self._last
        self._state = self._A @ state
        self._state[2] += STEP_S * self._last
        return self._last


def outcome(scenario: int, noise_m: Array, *, factor: float = 1.2, estimates: bool = False) -> Outcome:
    """Fly a scenario with one error (n,) for all axes of a measurement and return what came of it."""
    K, Ki = regulator()
    planner = Planner(estimates=estimates)
    model, body, integral = np.zeros((3, 3)), np.zeros(12), np.zeros(4)
    model[0, 2] = body[2] = 5.0
    F = np.kron([[1.0, STEP_S, 0.5 * STEP_S**2], [0.0, 1.0, STEP_S], [0.0, 0.0, 1.0]], np.eye(3))
    P, estimate, start = 10.0 * np.eye(9), np.zeros(9), body.copy()
    closest, landed = math.inf, None
    for k, vehicle in enumerate(drive(scenario)):
        measured = vehicle + noise_m[k]
        estimate, P = F @ estimate, F @ P @ F.T + 0.01 * np.eye(9)
        gain = P[:, :3] @ np.linalg.inv(P[:3, :3] + 0.01 * np.eye(3))
        estimate, P = estimate + gain @ (measured - estimate[:3]), P - gain @ P[:3]
        reference = np.append(model[0], 0.0)
        jerk = planner.move(model, np.stack([estimate[:3], factor * estimate[3:6], estimate[6:]]))
        if k * STEP_S >= STANDS_S - 1e-9:
            closest = min(closest, float(np.linalg.norm(body[:3] - vehicle)))
            if landed is None and np.linalg.norm(body[:3] - measured) <= 0.7:
                landed = (k * STEP_S, float(body[0]), float(body[1]))
            model = EULER @ model
            model[2] += STEP_S * jerk
        for _ in range(4):
            integral = integral + 0.25 * STEP_S * (reference - body[[0, 1, 2, 5]])
            wrench = Ki @ integral - K @ (body - start)
            wrench[0] += MASS_KG * G_M_S2
            body = flown(body, wrench, 0.25 * STEP_S)
    t_s, place = (None, None) if landed is None else (landed[0], landed[1:])
    return Outcome(t_s=t_s, drone_m=place, closest_m=closest)
