"""Proportional navigation far from the target and proportional-derivative control near it.

With `u` the position of the target from the drone and `u'` its rate, the acceleration across the line of sight is
`-lambda |u'| (u / |u|) x Omega`, `Omega = (u x u') / (u . u)`; along it a proportional-derivative law closes in. Near,
`a = a_target + k u + d u'`. Source: Borowczyk et al. 2017, "Autonomous Landing of a Quadcopter on a High-Speed Ground
Vehicle". Added here: the target's acceleration, limits on speed, acceleration and jerk, and the floor.
"""

from dataclasses import dataclass

import numpy as np

from companion.config.planning import PnConfig
from companion.core.data import Array, FlightLimits
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
from companion.planning.resample import make_resampler

STEP_S = 0.15
STEPS = 20
"""Step and length of the published trajectory, which is the law run on against the target."""

PULL_UP_1_S = 2.0
"""Rate at which speeds approach their limits."""

FLOOR_1_S = PULL_UP_1_S / 4.0
"""Rate at which heights approach the floor: critically damped with the rate of the speeds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PnMemory:
    """The last state, and whether the near law is in force."""

    state: ReferenceState
    near: bool


class ProportionalNavigation:
    """The law with its gains; it holds nothing else."""

    def __init__(self, config: PnConfig) -> None:
        self._config = config

    def plan(self, memory: PnMemory | None, request: PlanRequest) -> tuple[PnMemory, PlanResult]:
        """Return the memory and the plan."""
        request = with_finite_state(None if memory is None else memory.state, request)
        near = memory is not None and memory.near
        if not has_finite_target(request):
            result = brake(request, PlanStatus.FAILED, 0)
            return PnMemory(state=result.next_state, near=near), result
        next_near, next_state = self._run(near, request, np.zeros(1), request.dt_s)[-1]
        instants = np.arange(STEPS, dtype=np.float64) * STEP_S
        path = [request.state, *(state for _, state in self._run(near, request, instants, STEP_S))]
        result = PlanResult(
            next_state=next_state,
            trajectory=Trajectory(
                offset_s=np.arange(STEPS + 1, dtype=np.float64) * STEP_S,
                position_enu_m=np.array([state.position_enu_m for state in path]),
                velocity_enu_m_s=np.array([state.velocity_enu_m_s for state in path]),
                acceleration_enu_m_s2=np.array([state.acceleration_enu_m_s2 for state in path]),
            ),
            status=PlanStatus.SOLVED,
            limit_excess=0.0,
            iterations=0,
        )
        return PnMemory(state=next_state, near=next_near), result

    def _run(self, near: bool, request: PlanRequest, instants: Array, dt_s: float) -> list[tuple[bool, ReferenceState]]:
        """Return which law was in force and the state after each instant's step of `dt_s`."""
        resampler = make_resampler(request.target.offset_s, instants)
        targets, floors = resampler.apply(request.target), resampler.line(request.floor_enu_m)
        state, states = request.state, []
        for position, velocity, acceleration, floor in zip(*targets, floors, strict=True):
            offset, rate = position - state.position_enu_m, velocity - state.velocity_enu_m_s
            near = self._is_near(near, float(np.hypot(offset[0], offset[1])))
            wanted = acceleration + self._law(near, offset, rate, request.limits)
            state = advance(state, wanted, request.limits, float(floor), dt_s)
            states.append((near, state))
        return states

    def _is_near(self, near: bool, distance_m: float) -> bool:
        """Return whether the near law is in force, with hysteresis."""
        bound = self._config.near_distance_m
        return distance_m < (self._config.far_hysteresis * bound if near else bound)

    def _law(self, near: bool, offset: Array, rate: Array, limits: FlightLimits) -> Array:
        """Return the acceleration (3,) relative to the target's; height is always held by the near law."""
        push = self._config.near_gain_1_s2 * offset + self._config.near_damping_1_s * rate
        if not near:
            push[:2] = self._far(offset[:2], rate[:2], limits)
        return push

    def _far(self, offset: Array, rate: Array, limits: FlightLimits) -> Array:
        """Return proportional navigation and the closing law in the horizontal plane, (2,)."""
        distance = float(np.hypot(offset[0], offset[1]))
        sight = offset / distance
        across = np.array([-sight[1], sight[0]])
        turning = float(offset[0] * rate[1] - offset[1] * rate[0]) / distance**2
        navigation = self._config.navigation_gain * float(np.hypot(rate[0], rate[1])) * turning
        damping = self._config.closing_damping_1_s
        closing = min(
            self._config.closing_gain_1_s2 / damping * distance, (limits.acceleration_max_m_s2 * distance) ** 0.5
        )
        along = damping * (closing + float(sight @ rate))
        bound = 0.8 * limits.acceleration_max_m_s2
        push: Array = min(max(along, -bound), bound) * sight + navigation * across
        return push


def advance(state: ReferenceState, wanted: Array, limits: FlightLimits, floor_m: float, dt_s: float) -> ReferenceState:
    """Return the state after `dt_s` in which the acceleration moves to `wanted` (3,) as far as the limits allow."""
    velocity, old = state.velocity_enu_m_s, state.acceleration_enu_m_s2
    push = np.empty(3)
    push[:2] = _short(_slow(wanted[:2], velocity[:2], limits.speed_max_m_s), limits.acceleration_max_m_s2)
    sink_max = min(limits.descent_max_m_s, FLOOR_1_S * (float(state.position_enu_m[2]) - floor_m))
    lowest, highest = PULL_UP_1_S * (-sink_max - velocity[2]), PULL_UP_1_S * (limits.climb_max_m_s - velocity[2])
    bound = limits.vertical_acceleration_max_m_s2
    push[2] = min(max(min(max(wanted[2], lowest), highest), -bound), bound)
    change = (push - old) / dt_s
    jerk = np.append(_short(change[:2], limits.jerk_max_m_s3), _short(change[2:], limits.vertical_jerk_max_m_s3))
    return ReferenceState(
        position_enu_m=state.position_enu_m + velocity * dt_s + old * dt_s**2 / 2.0 + jerk * dt_s**3 / 6.0,
        velocity_enu_m_s=velocity + old * dt_s + jerk * dt_s**2 / 2.0,
        acceleration_enu_m_s2=old + jerk * dt_s,
    )


def _slow(push: Array, velocity: Array, speed_max_m_s: float) -> Array:
    """Return `push` (2,) without what would take the speed past its limit."""
    speed = float(np.hypot(velocity[0], velocity[1]))
    if speed < 1e-6:
        return push
    along = velocity / speed
    excess = float(push @ along) - PULL_UP_1_S * (speed_max_m_s - speed)
    return push - max(excess, 0.0) * along


def _short(vector: Array, length: float) -> Array:
    """Return `vector` (k,) shortened to at most `length`."""
    size = float(np.sqrt(vector @ vector))
    return vector if size <= length else vector * (length / size)
