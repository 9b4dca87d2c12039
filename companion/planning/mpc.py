"""The default guidance law: model predictive control with preview of the target, per axis, inside the flight limits.

Far from the target the reference is not the target itself but the time-optimal way to it (`intercept`), so that a
horizon of 3 s brakes in time from any speed and the programme stays well scaled; near it the two are the same. The
horizontal axes are turned to where the motion is needed. The major one is solved first, with a share of the limits;
the minor one then gets what the major one's plan leaves of each norm, node by node.
"""

from functools import lru_cache, partial

import numpy as np

from companion.data import Array
from companion.planning.axis_qp import make_axis_problem
from companion.planning.brake import brake
from companion.planning.condensed import forced_response, free_response, make_axis_model
from companion.planning.config import MpcConfig
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, ReferenceState, Trajectory
from companion.planning.programmes import Grid, Numbers, PlainLimits, Posed, Statics, bound_minor, path_of, pose
from companion.planning.qp import Programme, make_solver
from companion.planning.requests import check, is_finite_state, limits_of, with_finite_state
from companion.planning.resample import make_resampler


class Mpc:
    """Holds the constant matrices and the programmes; a plan depends on its arguments only."""

    def __init__(self, config: MpcConfig) -> None:
        solver = make_solver(config.solver)
        model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
        level, upright = (make_axis_problem(model, config, has_floor=floored) for floored in (False, True))
        self._level, self._upright = (Programme(solver, problem.H, problem.A) for problem in (level, upright))
        self._nodes_s = np.append(0.0, model.node_s)
        self._responses = lru_cache(maxsize=64)(partial(_responses, self._nodes_s, np.array(config.moves_s)))
        grid = Grid(nodes_s=self._nodes_s, move_s=model.move_s, forced_v=model.forced_v, end_node=model.end_node)
        numbers = Numbers(
            axes_time_s=config.axes_time_s,
            intercept_fraction=config.intercept_fraction,
            intercept_time_min_s=config.intercept_time_min_s,
            lateral_speed_fraction=config.lateral_speed_fraction,
        )
        slack_gradients = (level.slack_gradient, upright.slack_gradient)
        self._statics: Statics = ((*grid,), (*numbers,), level.weights, slack_gradients)

    def plan(self, memory: ReferenceState | None, request: PlanRequest) -> tuple[ReferenceState, PlanResult]:
        """Return the next state as memory, and the plan."""
        check(request)
        limits = limits_of(request.limits)
        posed = self._posed(request, limits)
        if not posed.is_finite and not is_finite_state(request.state):
            request = with_finite_state(memory, request)
            posed = self._posed(request, limits)
        result = self._plan(request, limits, posed) if posed.is_finite else brake(request, PlanStatus.FAILED, 0)
        return result.next_state, result

    def _plan(self, request: PlanRequest, limits: PlainLimits, posed: Posed) -> PlanResult:
        """Return the plan of a request without NaN."""
        major_term, minor_term, vertical_term = posed.linear_terms
        major = self._level.solve(major_term, *posed.major)
        if major.x is None:
            return brake(request, major.status, major.iterations)
        minor = self._level.solve(minor_term, *bound_minor(posed.state, major.x, limits, self._statics[0]))
        vertical = self._upright.solve(vertical_term, *posed.vertical)
        iterations = major.iterations + minor.iterations + vertical.iterations
        if minor.x is None or vertical.x is None:
            return brake(request, minor.status if minor.x is None else vertical.status, iterations)
        return self._result(request, posed, (major.x, minor.x, vertical.x), iterations)

    def _posed(self, request: PlanRequest, limits: PlainLimits) -> Posed:
        state = request.state
        resampler = make_resampler(request.target.offset_s, self._nodes_s)
        return pose(
            (state.position_enu_m, state.velocity_enu_m_s, state.acceleration_enu_m_s2),
            (*resampler.taken(request.target), resampler.taken_line(request.floor_enu_m)),
            limits,
            (resampler.left, resampler.weights),
            self._statics,
        )

    def _result(
        self, request: PlanRequest, posed: Posed, solved: tuple[Array, Array, Array], iterations: int
    ) -> PlanResult:
        """Return the plan in W: at 0, at the nodes, and at the request's `dt_s`."""
        path, excess = path_of(posed.origin_enu_m, posed.direction, posed.state, solved, self._responses(request.dt_s))
        position, velocity, acceleration = path[:, :-1]
        next_position, next_velocity, next_acceleration = path[:, -1]
        return PlanResult(
            next_state=ReferenceState(
                position_enu_m=next_position,
                velocity_enu_m_s=next_velocity,
                acceleration_enu_m_s2=next_acceleration,
            ),
            trajectory=Trajectory(
                offset_s=self._nodes_s,
                position_enu_m=position,
                velocity_enu_m_s=velocity,
                acceleration_enu_m_s2=acceleration,
            ),
            status=PlanStatus.SOLVED,
            limit_excess=excess,
            iterations=iterations,
        )


def _responses(nodes_s: Array, moves_s: Array, dt_s: float) -> tuple[Array, Array]:
    """Return the maps (3, n + 1, 3) and (3, n + 1, m) from state and moves to p, v, a at the nodes and at `dt_s`."""
    times = np.append(nodes_s, dt_s)
    return np.stack(free_response(times)), np.stack(forced_response(times, moves_s))
