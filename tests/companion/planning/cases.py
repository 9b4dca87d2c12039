"""Targets, requests and closed-loop flights of the virtual model that the tests of the guidance laws share."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from companion.core.data import Array, FlightLimits
from companion.planning.guidance import Leaning, PlanRequest, PlanResult, PlanStatus, ReferenceState, Target
from link.records import replace

LIMITS = FlightLimits(
    speed_max_m_s=20.0,
    climb_max_m_s=3.0,
    descent_max_m_s=1.5,
    acceleration_max_m_s2=5.0,
    vertical_acceleration_max_m_s2=3.0,
    jerk_max_m_s3=20.0,
    vertical_jerk_max_m_s3=15.0,
)
OFFSETS_S: Array = np.linspace(0.0, 3.0, 31)
NO_FLOOR_M = -1e3
DT_S = 0.02

M = TypeVar("M")

Motion = Callable[[Array], tuple[Array, Array, Array]]
"""Position, velocity, acceleration (n, 3) at times (n,)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """What a closed loop left behind at the end of each period: arrays (n, 3), times and figures (n,)."""

    t_s: Array
    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    error: Array
    rate: Array
    results: list[PlanResult]


def straight(start: tuple[float, float, float], velocity: tuple[float, float, float]) -> Motion:
    def at(t_s: Array) -> tuple[Array, Array, Array]:
        v = np.tile(np.array(velocity), (len(t_s), 1))
        return np.array(start) + v * t_s[:, None], v, np.zeros((len(t_s), 3))

    return at


def circle(radius_m: float, speed_m_s: float, height_m: float = 2.0) -> Motion:
    def at(t_s: Array) -> tuple[Array, Array, Array]:
        w = speed_m_s / radius_m
        c, s, o = np.cos(w * t_s), np.sin(w * t_s), np.zeros_like(t_s)
        position = np.stack((radius_m * c, radius_m * s, o + height_m), axis=1)
        velocity = speed_m_s * np.stack((-s, c, o), axis=1)
        return position, velocity, -speed_m_s * w * np.stack((c, s, o), axis=1)

    return at


def state_at(
    position: tuple[float, ...], velocity: tuple[float, ...] = (0, 0, 0), acceleration: tuple[float, ...] = (0, 0, 0)
) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array(position, dtype=np.float64),
        velocity_enu_m_s=np.array(velocity, dtype=np.float64),
        acceleration_enu_m_s2=np.array(acceleration, dtype=np.float64),
    )


def state_on(motion: Motion, t_s: float = 0.0) -> ReferenceState:
    position, velocity, acceleration = motion(np.array([t_s]))
    return ReferenceState(
        position_enu_m=position[0], velocity_enu_m_s=velocity[0], acceleration_enu_m_s2=acceleration[0]
    )


def target_of(motion: Motion, t_s: float = 0.0) -> Target:
    position, velocity, acceleration = motion(t_s + OFFSETS_S)
    return Target(
        offset_s=OFFSETS_S, position_enu_m=position, velocity_enu_m_s=velocity, acceleration_enu_m_s2=acceleration
    )


def request_of(
    state: ReferenceState,
    target: Target,
    limits: FlightLimits = LIMITS,
    floor_m: float = NO_FLOOR_M,
    dt_s: float = DT_S,
) -> PlanRequest:
    floor = np.full(len(target.offset_s), floor_m)
    return PlanRequest(state=state, target=target, limits=limits, floor_enu_m=floor, dt_s=dt_s)


class Law(Protocol[M]):
    """A guidance law with a memory of its own."""

    def plan(self, memory: M | None, request: PlanRequest) -> tuple[M, PlanResult]: ...


def fly(
    guidance: Law[M],
    motion: Motion,
    state: ReferenceState,
    duration_s: float,
    limits: FlightLimits = LIMITS,
    *,
    floor_m: float = NO_FLOOR_M,
    dt_s: float = DT_S,
    noise_m: Callable[[float], Array] = lambda _: np.zeros(3),
    leaning: Callable[[ReferenceState], Leaning | None] = lambda _: None,
) -> Flight:
    """Follow `motion`, forecast exactly but for `noise_m` on the positions; every plan must be solved.

    `leaning` is that of the request in each state.
    """
    memory: M | None = None
    states, results = [state], list[PlanResult]()
    times: Array = np.arange(round(duration_s / dt_s), dtype=np.float64) * dt_s
    for t_s in times:
        target = target_of(motion, float(t_s))
        noisy = Target(
            offset_s=target.offset_s,
            position_enu_m=target.position_enu_m + noise_m(float(t_s)),
            velocity_enu_m_s=target.velocity_enu_m_s,
            acceleration_enu_m_s2=target.acceleration_enu_m_s2,
        )
        request = request_of(states[-1], noisy, limits, floor_m, dt_s)
        memory, result = guidance.plan(memory, replace(request, leaning=leaning(states[-1])))
        assert result.status is PlanStatus.SOLVED
        states.append(result.next_state)
        results.append(result)
    acceleration = np.array([s.acceleration_enu_m_s2 for s in states])
    position, velocity = (
        np.array([getattr(s, name) for s in states[1:]]) for name in ("position_enu_m", "velocity_enu_m_s")
    )
    wanted, wanted_velocity, _ = motion(times + dt_s)
    return Flight(
        t_s=times + dt_s,
        position=position,
        velocity=velocity,
        acceleration=acceleration[1:],
        jerk=np.diff(acceleration, axis=0) / dt_s,
        error=position - wanted,
        rate=velocity - wanted_velocity,
        results=results,
    )


def norm(vectors: Array) -> Array:
    """Horizontal norms (n,) of vectors (n, 3)."""
    return np.hypot(vectors[:, 0], vectors[:, 1])


def caught_s(flight: Flight) -> float:
    """When the target was reached for good: within 0.25 m and 0.5 m/s horizontally."""
    away = np.flatnonzero((norm(flight.error) > 0.25) | (norm(flight.rate) > 0.5))
    return float(flight.t_s[away[-1]]) if away.size else 0.0
