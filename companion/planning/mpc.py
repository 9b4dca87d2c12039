"""The default guidance law: model predictive control with preview of the target, per axis, inside the flight limits.

Far from the target the reference is not the target itself but the time-optimal way to it (`intercept`), so that a
horizon of 3 s brakes in time from any speed and the programme stays well scaled; near it the two are the same. The
horizontal axes are turned to where the motion is needed. The major one is solved first, with a share of the limits;
the minor one then gets what the major one's plan leaves of each norm, node by node.
"""

from functools import lru_cache, partial

import numpy as np

from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.planning.axis_qp import forced_response, free_response, make_axis_model, make_axis_problem
from companion.planning.brake import brake
from companion.planning.guidance import (
    PlanRequest,
    PlanResult,
    PlanStatus,
    ReferenceState,
    Trajectory,
    is_finite_state,
    limits_of,
    with_finite_state,
)
from companion.planning.programmes import Numbers, PlainLimits, Posed, Statics, bound_minor, plan_of, pose
from companion.planning.qp import Programme, make_solver
from companion.planning.resample import make_resampler


class Mpc:
    """Holds the constant matrices and the programmes; a plan depends on its arguments only."""

    def __init__(self, config: MpcConfig) -> None:
        solver = make_solver(config.solver)
        model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
        self._touch_time_s = float(config.touch_time_s)
        leads_s = (None, 0.0, self._touch_time_s)
        problems = [make_axis_problem(model, config, floor_lead_s=lead_s) for lead_s in leads_s]
        self._level, self._above, self._onto = (Programme(solver, problem.H, problem.A) for problem in problems)
        self._nodes_s = np.append(0.0, model.node_s)
        self._responses = lru_cache(maxsize=64)(partial(_responses, self._nodes_s, np.array(config.moves_s)))
        self._forced_v, self._grid = model.forced_v, (self._nodes_s, model.move_s, model.end_s)
        numbers = Numbers(
            axes_time_s=config.axes_time_s,
            intercept_fraction=config.intercept_fraction,
            intercept_time_min_s=config.intercept_time_min_s,
            lateral_speed_fraction=config.lateral_speed_fraction,
            slack_weight=config.slack_weight,
        )
        self._statics: Statics = (self._grid, model.end_node, (*numbers,), problems[0].weights)

    def plan(self, memory: ReferenceState | None, request: PlanRequest) -> tuple[ReferenceState, PlanResult]:
        """Return the next state as memory, and the plan."""
        limits = limits_of(request)
        posed = self._pose(request, limits)
        if posed is None and not is_finite_state(request.state):
            request = with_finite_state(memory, request)
            posed = self._pose(request, limits)
        result = brake(request, PlanStatus.FAILED, 0) if posed is None else self._plan(request, limits, posed)
        return result.next_state, result

    def _pose(self, request: PlanRequest, limits: PlainLimits) -> Posed | None:
        """Return the problem of a plan, all but its minor axis's bounds; None where the request is not finite."""
        state, resampler = request.state, make_resampler(request.target.offset_s, self._nodes_s)
        posed = np.empty((5, 3)), self._level.blank(), self._level.blank(), self._above.blank()
        floor_enu_m, lead_s = request.floor_enu_m, 0.0
        if request.touched_enu_m is not None:
            floor_enu_m, lead_s = request.touched_enu_m, self._touch_time_s
        is_finite = pose(
            (state.position_enu_m, state.velocity_enu_m_s, state.acceleration_enu_m_s2),
            (*resampler.taken(request.target), resampler.taken_line(floor_enu_m)),
            lead_s,
            limits,
            (resampler.left, resampler.weights),
            self._statics,
            posed,
        )
        return posed if is_finite else None

    def _plan(self, request: PlanRequest, limits: PlainLimits, posed: Posed) -> PlanResult:
        """Return the plan of a request without NaN."""
        frame, major, minor, vertical = posed
        status, x, iterations = self._level.solve(major)
        if x is None:
            return brake(request, status, iterations)
        bound_minor(frame, x, self._forced_v, limits, self._grid, minor)
        status, y, more = self._level.solve(minor)
        if y is None:
            return brake(request, status, iterations + more)
        upright = self._above if request.touched_enu_m is None else self._onto
        status, z, most = upright.solve(vertical)
        if z is None:
            return brake(request, status, iterations + more + most)
        return self._result(frame, (x, y, z), request.dt_s, iterations + more + most)

    def _result(self, frame: Array, moves: tuple[Array, Array, Array], dt_s: float, iterations: int) -> PlanResult:
        """Return the plan in W: at 0, at the nodes, and at `dt_s`."""
        path = np.empty((3, len(self._nodes_s) + 1, 3))
        excess = plan_of(frame, moves, self._responses(dt_s), path)
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
