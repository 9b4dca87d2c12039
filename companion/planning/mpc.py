"""The default guidance law: model predictive control with preview of the target, per axis, inside the flight limits.

Far from the target the reference is not the target itself but the time-optimal way to it (`intercept`), so that a
horizon of 3 s brakes in time from any speed and the programme stays well scaled; near it the two are the same. The
horizontal axes are turned to where the motion is needed. The major one is solved first, with a share of the limits;
the minor one then gets what the major one's plan leaves of each norm, node by node.
"""

from functools import lru_cache

import numpy as np

from companion.data import Array, FlightLimits
from companion.planning.axis_qp import Bounds, make_axis_problem
from companion.planning.brake import brake
from companion.planning.condensed import forced_response, free_response, make_axis_model
from companion.planning.config import MpcConfig
from companion.planning.envelope import major_bounds, minor_bounds, vertical_bounds
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, ReferenceState, Trajectory
from companion.planning.horizon import Horizon, make_horizon
from companion.planning.qp import make_solver
from companion.planning.requests import has_finite_target, with_finite_state


class Mpc:
    """Holds the constant matrices and the solver; a plan depends on its arguments only."""

    def __init__(self, config: MpcConfig) -> None:
        self._config = config
        self._solver = make_solver(config.solver)
        self._model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
        level = make_axis_problem(self._model, config, has_floor=False)
        self._problems = (level, level, make_axis_problem(self._model, config, has_floor=True))
        self._nodes_s = np.append(0.0, self._model.node_s)
        self._node_times_s = tuple(self._nodes_s.tolist())

    def plan(self, memory: ReferenceState | None, request: PlanRequest) -> tuple[ReferenceState, PlanResult]:
        """Return the next state as memory, and the plan."""
        request = with_finite_state(memory, request)
        result = self._plan(request) if has_finite_target(request) else brake(request, PlanStatus.FAILED, 0)
        return result.next_state, result

    def _plan(self, request: PlanRequest) -> PlanResult:
        """Return the plan of a request without NaN."""
        horizon = make_horizon(request, self._model, self._nodes_s, self._config)
        moves = np.empty((len(self._model.move_s), 3))
        iterations, excess = 0, 0.0
        for axis, problem in enumerate(self._problems):
            bounds = self._bounds(horizon, request.limits, axis, moves[:, 0])
            x, jerk = horizon.state[:, axis], horizon.jerk_m_s3[axis]
            solution = problem.solve(self._solver, x, horizon.reference[:, axis], jerk, bounds)
            iterations += solution.iterations
            if solution.x is None:
                return brake(request, solution.status, iterations)
            moves[:, axis] = solution.x[: len(moves)]
            excess = max(excess, float(solution.x[len(moves) :].max()))
        return self._result(request, horizon, moves, excess, iterations)

    def _bounds(self, horizon: Horizon, limits: FlightLimits, axis: int, major_jerk: Array) -> Bounds:
        """Return the bounds of an axis's programme."""
        model, x = self._model, horizon.state
        norms = np.array((limits.speed_max_m_s, limits.acceleration_max_m_s2, limits.jerk_max_m_s3))
        match axis:
            case 0:
                way = np.array((horizon.split_rad, horizon.minor_push_m_s2, self._config.lateral_speed_fraction))
                target_v, target_a = horizon.target_velocity_m_s[1], horizon.target_acceleration_m_s2[1]
                return major_bounds(x, target_v, target_a, way, norms, model.node_s, model.end_s)
            case 1:
                return minor_bounds(x, major_jerk, model.forced_v, norms, model.node_s, model.move_s, model.end_s)
            case _:
                descent_m_s, climb_m_s = limits.descent_max_m_s, limits.climb_max_m_s
                vertical = (descent_m_s, climb_m_s, limits.vertical_acceleration_max_m_s2, limits.jerk_max_m_s3)
                return vertical_bounds(x[:, 2], horizon.floor_m, vertical, model.node_s, model.end_s)

    def _result(
        self, request: PlanRequest, horizon: Horizon, moves: Array, excess: float, iterations: int
    ) -> PlanResult:
        """Return the plan in W: at 0, at the nodes, and at the request's `dt_s`."""
        free, forced = _responses(self._node_times_s, request.dt_s, self._config.moves_s)
        path = (free @ horizon.state + forced @ moves) @ horizon.turn
        position = path[0] + horizon.origin_enu_m
        return PlanResult(
            next_state=ReferenceState(
                position_enu_m=position[-1], velocity_enu_m_s=path[1, -1], acceleration_enu_m_s2=path[2, -1]
            ),
            trajectory=Trajectory(
                offset_s=self._nodes_s,
                position_enu_m=position[:-1],
                velocity_enu_m_s=path[1, :-1],
                acceleration_enu_m_s2=path[2, :-1],
            ),
            status=PlanStatus.SOLVED,
            limit_excess=excess,
            iterations=iterations,
        )


@lru_cache(maxsize=64)
def _responses(nodes_s: tuple[float, ...], dt_s: float, moves_s: tuple[float, ...]) -> tuple[Array, Array]:
    """Return the maps (3, n + 1, 3) and (3, n + 1, m) from state and moves to p, v, a at the nodes and at `dt_s`."""
    times, moves = np.array([*nodes_s, dt_s]), np.array(moves_s)
    return np.stack(free_response(times)), np.stack(forced_response(times, moves))
