"""The source report's trajectory planner (Ghribi 2022, equations 12 to 14), as its two readings have it.

Per axis `[p, v, a]`, input jerk, forward Euler at 0.01 s: `p+ = p + v h, v+ = v + a h, a+ = a + u h`. The target's
state now is held over the horizon, its velocity multiplied by a factor. Cost: half the sum over the prediction of the
weighed squares of the errors of p, v and a, plus the weighed square of the input (reading STATED) or of its change
(REFERENCE_SIMULATION, the input itself is free). After the control horizon the last input is held. z >= 0 is soft
with an exact penalty, since the input reaches the height only after three steps. Flight limits and the request's
floor are not part of this law.
"""

import math
from dataclasses import dataclass

import numpy as np

from companion.config.planning import ReportMpcConfig, ReportReading, SolverKind
from companion.core.data import Array
from companion.planning.brake import brake
from companion.planning.guidance import (
    PlanRequest,
    PlanResult,
    PlanStatus,
    ReferenceState,
    Trajectory,
    has_finite_target,
    with_finite_state,
)
from companion.planning.qp import Programme, QpSolution, make_solver
from companion.planning.resample import make_resampler

STEP_S = 0.01
"""The report's sampling time."""

SLACK_WEIGHT = 1e6
"""Exact penalty of the height's slack per metre, above the multipliers of z >= 0 for errors of hundreds of metres."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Numbers:
    """One reading of the report: steps, and weights of the squares of p, v, a, the input and the input's change."""

    prediction_steps: int
    control_steps: int
    position_weight: float
    velocity_weight: float
    acceleration_weight: float
    input_weight: float
    change_weight: float


NUMBERS = {
    # the toolbox that the reference simulation used squares the weights 10, 2, 0.1 and 0.05
    ReportReading.REFERENCE_SIMULATION: Numbers(
        prediction_steps=10,
        control_steps=2,
        position_weight=100.0,
        velocity_weight=4.0,
        acceleration_weight=0.01,
        input_weight=0.0,
        change_weight=0.0025,
    ),
    ReportReading.STATED: Numbers(
        prediction_steps=100,
        control_steps=20,
        position_weight=10.0,
        velocity_weight=2.0,
        acceleration_weight=0.1,
        input_weight=0.05,
        change_weight=0.0,
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReportMemory:
    """The virtual model's last state, the jerk (3,) last applied, and the time it is behind."""

    state: ReferenceState
    jerk_m_s3: Array
    behind_s: float


class ReportMpc:
    """Holds the constant matrices and the solver; a plan depends on its arguments only."""

    def __init__(self, config: ReportMpcConfig) -> None:
        self._factor = config.velocity_factor
        self._numbers = NUMBERS[config.reading]
        self._free, self._forced = euler_predictions(self._numbers.prediction_steps, self._numbers.control_steps)
        self._gradient = self._forced.T * _state_weights(self._numbers)
        H, A = _hessian(self._numbers, self._gradient @ self._forced), _constraints(self._numbers, self._forced)
        self._programme = Programme(make_solver(SolverKind.DAQP), H, A)

    def plan(self, memory: ReportMemory | None, request: PlanRequest) -> tuple[ReportMemory, PlanResult]:
        """Return the memory and the plan; the virtual model takes whole steps of 0.01 s, the rest waits."""
        request = with_finite_state(None if memory is None else memory.state, request)
        if not has_finite_target(request):
            return _fallback(request, PlanStatus.FAILED, 0)
        state, jerk = _rows(request.state), np.zeros(3) if memory is None else memory.jerk_m_s3
        due_s = request.dt_s + (0.0 if memory is None else memory.behind_s)
        steps = math.floor(due_s / STEP_S + 1e-6)
        iterations, excess, trajectory = 0, 0.0, [_still(request.state)]
        for target in _targets(request, steps):
            solutions = [self._solve(axis, state[:, axis], target[:, axis], float(jerk[axis])) for axis in range(3)]
            iterations += sum(count for _, _, count in solutions)
            unknowns = [x for _, x, _ in solutions if x is not None]
            if len(unknowns) < len(solutions):
                status = next(status for status, _, _ in solutions if status is not PlanStatus.SOLVED)
                return _fallback(request, status, iterations)
            moves = np.stack(unknowns, axis=1)
            trajectory.append(self._predict(state, moves[:-1]))
            excess = max(excess, float(moves[-1, 2]))
            jerk = moves[0]
            state = EULER @ state + np.outer([0.0, 0.0, STEP_S], jerk)
        result = PlanResult(
            next_state=_reference_state(state),
            trajectory=trajectory[min(1, steps)],
            status=PlanStatus.SOLVED,
            limit_excess=excess,
            iterations=iterations,
        )
        return ReportMemory(state=result.next_state, jerk_m_s3=jerk, behind_s=due_s - steps * STEP_S), result

    def _solve(self, axis: int, x: Array, target: Array, jerk_m_s3: float) -> QpSolution:
        """Return moves and slack of one axis from the state `x` (3,) to the held `target` (3,)."""
        steps = self._numbers.prediction_steps
        wanted = np.repeat(target * np.array([1.0, self._factor, 1.0]), steps)
        moves = self._gradient @ (self._free @ x - wanted)
        moves[0] -= self._numbers.change_weight * jerk_m_s3
        above_road = -self._free[:steps] @ x if axis == 2 else np.full(steps, -np.inf)
        lower = np.append(above_road, 0.0)
        return self._programme.solve((np.append(moves, SLACK_WEIGHT), lower, np.full(steps + 1, np.inf)))

    def _predict(self, state: Array, moves: Array) -> Trajectory:
        """Return the prediction for the state (3, 3) and the moves (c, 3)."""
        nodes = (self._free @ state + self._forced @ moves).reshape(3, self._numbers.prediction_steps, 3)
        path = np.concatenate((state[:, None, :], nodes), axis=1)
        return Trajectory(
            offset_s=np.arange(self._numbers.prediction_steps + 1, dtype=np.float64) * STEP_S,
            position_enu_m=path[0],
            velocity_enu_m_s=path[1],
            acceleration_enu_m_s2=path[2],
        )


EULER = np.array([[1.0, STEP_S, 0.0], [0.0, 1.0, STEP_S], [0.0, 0.0, 1.0]])
"""One forward Euler step of [p, v, a] without jerk."""


def euler_predictions(steps: int, moves: int) -> tuple[Array, Array]:
    """Return the maps from the state now (3 n, 3) and from the moves (3 n, m), the last held, to n steps of p, v, a."""
    free, forced = np.zeros((3, steps, 3)), np.zeros((3, steps, moves))
    state, response = np.eye(3), np.zeros((3, moves))
    for step in range(steps):
        state, response = EULER @ state, EULER @ response
        response[2, min(step, moves - 1)] += STEP_S
        free[:, step], forced[:, step] = state, response
    return free.reshape(3 * steps, 3), forced.reshape(3 * steps, moves)


def _state_weights(numbers: Numbers) -> Array:
    """Return the weight (3 n,) of each predicted p, v and a."""
    weights = [numbers.position_weight, numbers.velocity_weight, numbers.acceleration_weight]
    return np.repeat(np.array(weights), numbers.prediction_steps)


def _hessian(numbers: Numbers, of_states: Array) -> Array:
    """Return the Hessian over the moves and the slack."""
    moves = numbers.control_steps
    times = np.append(np.ones(moves - 1), numbers.prediction_steps - moves + 1.0)
    change = np.eye(moves) - np.eye(moves, k=-1)
    H = np.eye(moves + 1)
    H[:moves, :moves] = of_states + numbers.input_weight * np.diag(times) + numbers.change_weight * change.T @ change
    return 0.5 * (H + H.T)


def _constraints(numbers: Numbers, forced: Array) -> Array:
    """Return the rows of the positions, widened by the slack, and of the slack."""
    steps, moves = numbers.prediction_steps, numbers.control_steps
    rows = np.hstack((forced[:steps], np.ones((steps, 1))))
    return np.vstack((rows, np.eye(1, moves + 1, k=moves)))


def _rows(state: ReferenceState) -> Array:
    """Return position, velocity, acceleration as rows (3, 3)."""
    return np.stack((state.position_enu_m, state.velocity_enu_m_s, state.acceleration_enu_m_s2))


def _reference_state(rows: Array) -> ReferenceState:
    """Return the state of rows (3, 3)."""
    return ReferenceState(position_enu_m=rows[0], velocity_enu_m_s=rows[1], acceleration_enu_m_s2=rows[2])


def _still(state: ReferenceState) -> Trajectory:
    """Return the trajectory of a call in which no step is due."""
    rows = _rows(state)[:, None, :]
    return Trajectory(
        offset_s=np.zeros(1), position_enu_m=rows[0], velocity_enu_m_s=rows[1], acceleration_enu_m_s2=rows[2]
    )


def _targets(request: PlanRequest, steps: int) -> Array:
    """Return the target's position, velocity, acceleration (steps, 3, 3) at the law's own instants."""
    instants = np.arange(steps, dtype=np.float64) * STEP_S
    resampled = make_resampler(request.target.offset_s, instants).apply(request.target)
    return np.stack(resampled, axis=1)


def _fallback(request: PlanRequest, status: PlanStatus, iterations: int) -> tuple[ReportMemory, PlanResult]:
    """Return the braking, after which the input starts from zero."""
    result = brake(request, status, iterations)
    return ReportMemory(state=result.next_state, jerk_m_s3=np.zeros(3), behind_s=0.0), result
