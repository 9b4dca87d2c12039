"""The default guidance law: model predictive control with preview of the target, inside the flight limits.

Far from the target the reference is not the target itself but the time-optimal way to it (`intercept`), so that a
horizon of 3 s brakes in time from any speed and the programme stays well scaled; near it the two are the same. Both
horizontal axes are one programme, since they share the limits of speed, acceleration and jerk; they are turned to where
the motion is needed. The vertical axis is a programme of its own.
"""

from functools import lru_cache, partial

import numpy as np

from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.planning.axis_qp import forced_response, free_response, make_axis_cost, make_axis_model
from companion.planning.brake import brake
from companion.planning.constraints import level_hessian, level_rows, vertical_hessian, vertical_rows
from companion.planning.following import Following
from companion.planning.guidance import (
    PlanRequest,
    PlanResult,
    PlanStatus,
    ReferenceState,
    Trajectory,
    is_finite_state,
    leaning_of,
    limits_of,
    with_finite_state,
)
from companion.planning.programmes import Numbers, PlainLimits, Posed, plan_of, pose
from companion.planning.qp import Programme, make_solver
from companion.planning.resample import make_resampler


class Mpc:
    """Holds the constant matrices and the programmes; a plan depends on its arguments only."""

    def __init__(self, config: MpcConfig) -> None:
        solver = make_solver(config.solver)
        model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
        self._touch_time_s = float(config.touch_time_s)
        cost = make_axis_cost(model, config)
        self._solver, self._config, self._model = solver, config, model
        self._level = lru_cache(maxsize=16)(self._make_level)
        upright = vertical_hessian(cost, config.slack_weight)
        self._above, self._onto = (
            Programme(solver, upright, vertical_rows(model, lead_s)) for lead_s in (0.0, self._touch_time_s)
        )
        self._nodes_s = np.append(0.0, model.node_s)
        self._responses = lru_cache(maxsize=64)(partial(_responses, self._nodes_s, np.array(config.moves_s)))
        grid = (self._nodes_s, model.move_s, model.end_s)
        numbers = Numbers(
            axes_time_s=config.axes_time_s,
            intercept_fraction=config.intercept_fraction,
            intercept_time_min_s=config.intercept_time_min_s,
            slack_weight=config.slack_weight,
        )
        self._upright = cost.weights
        self._statics = (grid, model.end_node, (*numbers,))

    def plan(self, memory: ReferenceState | None, request: PlanRequest) -> tuple[ReferenceState, PlanResult]:
        """Return the next state as memory, and the plan."""
        limits = limits_of(request)
        posed = self._pose(request, limits)
        if posed is None and not is_finite_state(request.state):
            request = with_finite_state(memory, request)
            posed = self._pose(request, limits)
        result = brake(request, PlanStatus.FAILED, 0) if posed is None else self._plan(request, posed)
        return result.next_state, result

    def _make_level(self, following: Following | None) -> tuple[Programme, Array]:
        """Return the programme of both horizontal axes for a drone, and the weights of its linear terms."""
        cost = make_axis_cost(self._model, self._config, following)
        hessian = level_hessian(cost, self._config.slack_weight)
        return Programme(self._solver, hessian, level_rows(self._model)), cost.weights

    def _pose(self, request: PlanRequest, limits: PlainLimits) -> Posed | None:
        """Return the problem of a plan; None where the request is not finite."""
        state, resampler = request.state, make_resampler(request.target.offset_s, self._nodes_s)
        level, weights = self._level(request.following)
        posed = np.empty((5, 3)), level.blank(), self._above.blank()
        floor_enu_m, lead_s = request.floor_enu_m, 0.0
        if request.touched_enu_m is not None:
            floor_enu_m, lead_s = request.touched_enu_m, self._touch_time_s
        is_finite = pose(
            (state.position_enu_m, state.velocity_enu_m_s, state.acceleration_enu_m_s2),
            (*resampler.taken(request.target), resampler.taken_line(floor_enu_m)),
            lead_s,
            limits,
            leaning_of(request),
            (resampler.left, resampler.weights),
            (*self._statics, (weights, self._upright)),
            posed,
        )
        return posed if is_finite else None

    def _plan(self, request: PlanRequest, posed: Posed) -> PlanResult:
        """Return the plan of a request without NaN."""
        frame, level, vertical = posed
        programme, _ = self._level(request.following)
        status, moves, iterations = programme.solve(level)
        if moves is None:
            return brake(request, status, iterations)
        upright = self._above if request.touched_enu_m is None else self._onto
        status, climb, more = upright.solve(vertical)
        if climb is None:
            return brake(request, status, iterations + more)
        return self._result(frame, moves, climb, request.dt_s, iterations + more)

    def _result(self, frame: Array, level: Array, vertical: Array, dt_s: float, iterations: int) -> PlanResult:
        """Return the plan in W: at 0, at the nodes, and at `dt_s`."""
        path = np.empty((3, len(self._nodes_s) + 1, 3))
        excess = plan_of(frame, level, vertical, self._responses(dt_s), path)
        return PlanResult(
            next_state=ReferenceState(
                position_enu_m=path[0, -1],
                velocity_enu_m_s=path[1, -1],
                acceleration_enu_m_s2=path[2, -1],
            ),
            trajectory=Trajectory(
                offset_s=self._nodes_s,
                position_enu_m=path[0, :-1],
                velocity_enu_m_s=path[1, :-1],
                acceleration_enu_m_s2=path[2, :-1],
            ),
            status=PlanStatus.SOLVED,
            limit_excess=excess,
            iterations=iterations,
        )


def _responses(nodes_s: Array, moves_s: Array, dt_s: float) -> Array:
    """Return the maps (3 + m, 3 (n + 1)) from state and moves to p, v, a at the nodes and at `dt_s`."""
    times = np.append(nodes_s, dt_s)
    free, forced = np.vstack(free_response(times)), np.vstack(forced_response(times, moves_s))
    return np.ascontiguousarray(np.hstack((free, forced)).T)
