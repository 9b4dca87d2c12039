"""The default guidance law: model predictive control with preview of the target, per axis, inside the flight limits.

Far from the target the reference is not the target itself but the time-optimal way to it in coordinates relative to
it (`intercept`), so that a horizon of 3 s brakes in time from any speed and the programme stays well scaled; near it
the two are the same. The horizontal axes are turned to where the motion is needed. The major one is solved first with
a share of the limits; the minor one then gets what the major one's plan leaves of each norm, node by node.
"""

import numpy as np

from companion.data import Array, FlightLimits
from companion.planning.axis_qp import AxisBounds, AxisReference, make_axis_problem
from companion.planning.brake import brake
from companion.planning.condensed import forced_response, free_response, make_axis_model
from companion.planning.config import MpcConfig
from companion.planning.envelope import acceleration_ceiling, reachable_floor, velocity_ceiling
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, ReferenceState, Trajectory
from companion.planning.horizon import Horizon, make_horizon
from companion.planning.qp import QpSolution, make_solver
from companion.planning.requests import has_finite_target, with_finite_state

MINOR_SHARE_MIN = 0.05
"""Share of a norm limit that the minor axis gets even where the major one's plan leaves nothing."""


class Mpc:
    """Holds the constant matrices and the solver; a plan depends on its arguments only."""

    def __init__(self, config: MpcConfig) -> None:
        self._config = config
        self._solver = make_solver(config.solver)
        self._model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
        level = make_axis_problem(self._model, config, has_floor=False)
        self._problems = (level, level, make_axis_problem(self._model, config, has_floor=True))
        self._nodes_s = (0.0, *self._model.node_s.tolist())
        self._ends_s = np.cumsum(self._model.move_s)

    def plan(self, memory: ReferenceState | None, request: PlanRequest) -> tuple[ReferenceState, PlanResult]:
        """Return the next state as memory, and the plan."""
        request = with_finite_state(memory, request)
        if has_finite_target(request):
            result = self._plan(request)
        else:
            result = brake(request, PlanStatus.FAILED, 0)
        return result.next_state, result

    def _plan(self, request: PlanRequest) -> PlanResult:
        """Return the plan of a request without NaN."""
        horizon = make_horizon(request, self._model, self._nodes_s, self._config)
        solutions: list[QpSolution] = []
        for axis in range(3):
            bounds = self._bounds(horizon, request.limits, axis, solutions)
            reference = AxisReference(
                position_m=horizon.position_m[axis],
                velocity_m_s=horizon.velocity_m_s[axis],
                acceleration_m_s2=horizon.acceleration_m_s2[axis],
                jerk_m_s3=horizon.jerk_m_s3[axis],
            )
            solution = self._problems[axis].solve(self._solver, horizon.state[:, axis], reference, bounds)
            solutions.append(solution)
            if solution.x is None:
                return brake(request, solution.status, sum(s.iterations for s in solutions))
        return self._result(request, horizon, solutions)

    def _bounds(self, horizon: Horizon, limits: FlightLimits, axis: int, done: list[QpSolution]) -> AxisBounds:
        """Return the bounds of an axis, the minor one's beside the major one's plan, widened for its state."""
        nodes, moves = np.ones_like(self._model.node_s), np.ones_like(self._model.move_s)
        if axis == 2:
            up, down = limits.climb_max_m_s * nodes, limits.descent_max_m_s * nodes
            push, jerk = limits.vertical_acceleration_max_m_s2 * moves, limits.jerk_max_m_s3 * moves
        elif axis == 0:
            up = down = horizon.speed_major_m_s * nodes
            share = np.sqrt(1.0 - self._config.lateral_fraction**2)
            push, jerk = horizon.acceleration_major_m_s2 * moves, share * limits.jerk_max_m_s3 * moves
        else:
            up, push, jerk = self._left_for_minor(horizon, limits, done[0])
            down = up
        x = horizon.state[:, axis]
        floor = self._floor(horizon, limits) if axis == 2 else None
        return self._widened(x, up, down, push, jerk, floor)

    def _left_for_minor(self, horizon: Horizon, limits: FlightLimits, major: QpSolution) -> tuple[Array, Array, Array]:
        """Return speed (n,), acceleration and jerk (m,) that the major axis's plan leaves of the norms."""
        x, u = horizon.state[:, 0], self._moves(major)
        velocity = self._model.free_v @ x + self._model.forced_v @ u
        acceleration = x[2] + self._model.forced_a[self._model.block_end] @ u
        return (
            _left(limits.speed_max_m_s, velocity),
            _left(limits.acceleration_max_m_s2, acceleration),
            _left(limits.jerk_max_m_s3, u),
        )

    def _widened(self, x: Array, up: Array, down: Array, push: Array, jerk: Array, floor: Array | None) -> AxisBounds:
        """Return the bounds, widened so that the state `x` can keep them."""
        v, a = float(x[1]), float(x[2])
        t, ends, brake_m_s2, turn = self._model.node_s, self._ends_s, float(push.min()), float(jerk.min())
        return AxisBounds(
            velocity_min_m_s=-velocity_ceiling(down, -v, -a, brake_m_s2, turn, t),
            velocity_max_m_s=velocity_ceiling(up, v, a, brake_m_s2, turn, t),
            acceleration_min_m_s2=-acceleration_ceiling(push, -a, turn, ends),
            acceleration_max_m_s2=acceleration_ceiling(push, a, turn, ends),
            jerk_max_m_s3=jerk,
            floor_m=floor,
        )

    def _floor(self, horizon: Horizon, limits: FlightLimits) -> Array:
        """Return the floor (n,) that can be kept."""
        pull, climb = limits.vertical_acceleration_max_m_s2, limits.climb_max_m_s
        state = horizon.state[:, 2]
        return reachable_floor(horizon.floor_m, state, pull, climb, limits.jerk_max_m_s3, self._model.node_s)

    def _moves(self, solution: QpSolution) -> Array:
        """Return the jerk of each block (m,)."""
        if solution.x is None:
            raise ValueError(f"a QP that ended as {solution.status} has no moves")
        return solution.x[: len(self._model.move_s)]

    def _result(self, request: PlanRequest, horizon: Horizon, solutions: list[QpSolution]) -> PlanResult:
        """Return the plan in W: at 0, at the nodes, and at the request's `dt_s`."""
        model, dt = self._model, np.array([request.dt_s])
        u = np.stack([self._moves(solution) for solution in solutions], axis=1)
        x, back = horizon.state, horizon.turn
        free, forced = free_response(dt), forced_response(dt, model.move_s)
        step = [(free[i] @ x + forced[i] @ u)[0] @ back for i in range(3)]
        position = np.concatenate((x[:1], model.free_p @ x + model.forced_p @ u))
        velocity = np.concatenate((x[1:2], model.free_v @ x + model.forced_v @ u))
        acceleration = np.concatenate((x[2:], model.free_a @ x + model.forced_a @ u))
        slacks = [float(s.x[len(model.move_s) :].max()) for s in solutions if s.x is not None]
        return PlanResult(
            next_state=ReferenceState(
                position_enu_m=step[0] + horizon.origin_enu_m, velocity_enu_m_s=step[1], acceleration_enu_m_s2=step[2]
            ),
            trajectory=Trajectory(
                offset_s=np.array(self._nodes_s),
                position_enu_m=position @ back + horizon.origin_enu_m,
                velocity_enu_m_s=velocity @ back,
                acceleration_enu_m_s2=acceleration @ back,
            ),
            status=PlanStatus.SOLVED,
            limit_excess=max(0.0, *slacks),
            iterations=sum(s.iterations for s in solutions),
        )


def _left(norm: float, used: Array) -> Array:
    """Return what is left of a norm limit beside `used` (k,)."""
    return np.sqrt(np.maximum(norm * norm - used * used, (MINOR_SHARE_MIN * norm) ** 2))
