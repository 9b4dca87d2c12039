"""The default guidance law: model predictive control with preview of the target, per axis, inside the flight limits.

Far from the target the reference is not the target itself but the time-optimal way to it (`intercept`), so that a
horizon of 3 s brakes in time from any speed and the programme stays well scaled; near it the two are the same. The
horizontal axes are turned to where the motion is needed. The major one is solved first, with a share of the limits;
the minor one then gets what the major one's plan leaves of each norm, node by node.
"""

import math
from functools import lru_cache

import numpy as np

from companion.data import Array, FlightLimits
from companion.planning.axis_qp import AxisBounds, make_axis_problem
from companion.planning.brake import brake
from companion.planning.condensed import forced_response, free_response, make_axis_model
from companion.planning.config import MpcConfig
from companion.planning.envelope import acceleration_ceiling, reachable_floor, velocity_ceiling
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, ReferenceState, Trajectory
from companion.planning.horizon import Horizon, make_horizon
from companion.planning.qp import make_solver
from companion.planning.requests import has_finite_target, with_finite_state

MINOR_SHARE_MIN = 0.05
"""Share of a norm limit that the minor axis gets even where the major one's plan leaves nothing."""

MINOR_PUSH_FACTOR = 1.1
"""How much more than its way's acceleration the minor axis gets, for the smoothing of the plan."""


class Mpc:
    """Holds the constant matrices and the solver; a plan depends on its arguments only."""

    def __init__(self, config: MpcConfig) -> None:
        self._config = config
        self._solver = make_solver(config.solver)
        self._model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
        level = make_axis_problem(self._model, config, has_floor=False)
        self._problems = (level, level, make_axis_problem(self._model, config, has_floor=True))
        self._nodes_s = np.append(0.0, self._model.node_s)

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

    def _bounds(self, horizon: Horizon, limits: FlightLimits, axis: int, major_jerk: Array) -> AxisBounds:
        """Return the bounds of an axis, widened so that its state can keep them."""
        match axis:
            case 0:
                speed, push, jerk = self._major(horizon, limits)
            case 1:
                speed, push, jerk = self._left_for_minor(horizon, limits, major_jerk)
            case _:
                return self._vertical(horizon, limits)
        return self._widened(horizon.state[:, axis], (speed, speed), push, jerk, None)

    def _major(self, horizon: Horizon, limits: FlightLimits) -> tuple[Array, Array, Array]:
        """Return speed (n,), acceleration and jerk (m,) that the major axis may use beside what the minor one needs.

        That is the target's own motion and the way's acceleration, and at first what the minor axis moves at now.
        """
        v_now, a_now = abs(float(horizon.state[1, 1])), abs(float(horizon.state[2, 1]))
        major_share, minor_share = math.cos(horizon.split_rad), math.sin(horizon.split_rad)
        target = np.abs(horizon.target_velocity_m_s[1])
        push = np.abs(horizon.target_acceleration_m_s2[1, 1:]) + MINOR_PUSH_FACTOR * horizon.minor_push_m_s2
        slowing = 0.5 * float(push.min()) * np.maximum(self._model.node_s - 0.2, 0.0)
        excess = np.maximum(v_now - target[0] - slowing, self._config.lateral_speed_fraction * limits.speed_max_m_s)
        easing = a_now - 0.5 * minor_share * limits.jerk_max_m_s3 * self._model.end_s
        return (
            _left(limits.speed_max_m_s, target[1:] + excess),
            _left(limits.acceleration_max_m_s2, np.maximum(easing, push)),
            np.full_like(push, major_share * limits.jerk_max_m_s3),
        )

    def _left_for_minor(self, horizon: Horizon, limits: FlightLimits, major_jerk: Array) -> tuple[Array, Array, Array]:
        """Return speed (n,), acceleration and jerk (m,) that the major axis's plan leaves of the norms."""
        model, x = self._model, horizon.state[:, 0]
        return (
            _left(limits.speed_max_m_s, model.free_v @ x + model.forced_v @ major_jerk),
            _left(limits.acceleration_max_m_s2, x[2] + np.cumsum(model.move_s * major_jerk)),
            _left(limits.jerk_max_m_s3, major_jerk),
        )

    def _vertical(self, horizon: Horizon, limits: FlightLimits) -> AxisBounds:
        """Return the bounds of the vertical axis."""
        x, t_s = horizon.state[:, 2], self._model.node_s
        pull, jerk = limits.vertical_acceleration_max_m_s2, limits.jerk_max_m_s3
        speeds = np.full_like(t_s, limits.descent_max_m_s), np.full_like(t_s, limits.climb_max_m_s)
        floor = reachable_floor(horizon.floor_m, x, pull, limits.climb_max_m_s, jerk, t_s)
        ones = np.ones_like(self._model.move_s)
        return self._widened(x, speeds, pull * ones, jerk * ones, floor)

    def _widened(
        self, x: Array, speeds: tuple[Array, Array], push: Array, jerk: Array, floor: Array | None
    ) -> AxisBounds:
        """Return the bounds, widened so that the state `x` can keep them; `speeds` are those down and up."""
        _, v, a = x.tolist()
        nodes, ends, braking, turning = self._model.node_s, self._model.end_s, float(push.min()), float(jerk.min())
        return AxisBounds(
            velocity_min_m_s=-velocity_ceiling(speeds[0], -v, -a, braking, turning, nodes),
            velocity_max_m_s=velocity_ceiling(speeds[1], v, a, braking, turning, nodes),
            acceleration_min_m_s2=-acceleration_ceiling(push, -a, turning, ends),
            acceleration_max_m_s2=acceleration_ceiling(push, a, turning, ends),
            jerk_max_m_s3=jerk,
            floor_m=floor,
        )

    def _result(
        self, request: PlanRequest, horizon: Horizon, moves: Array, excess: float, iterations: int
    ) -> PlanResult:
        """Return the plan in W: at 0, at the nodes, and at the request's `dt_s`."""
        free, forced = _responses(tuple(self._nodes_s.tolist()), request.dt_s, self._config.moves_s)
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


def _left(norm: float, used: Array) -> Array:
    """Return what is left of a norm limit beside `used` (k,)."""
    return np.sqrt(np.maximum(norm * norm - used * used, (MINOR_SHARE_MIN * norm) ** 2))
