"""Flights of the simulated drone, as arrays that the tests of physics and control look at."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from link.records import replace
from sim_autopilot.core.data import Array, Deck, Reference, Surface
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.plant import PlantMemory, fly, initial_plant

DT_S = 0.01
CALM = np.zeros(3)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """What happened, sampled at `t_s` (n,): the reference and the drone in W, tilt in rad."""

    t_s: Array
    wanted_m: Array
    position_m: Array
    velocity_m_s: Array
    yaw_rad: Array
    tilt_rad: Array
    surface: list[Surface]
    end: PlantMemory

    def error_m(self, since_s: float = 0.0) -> Array:
        """Return the horizontal distance (k,) from the reference since `since_s`."""
        late = self.t_s > since_s
        return np.asarray(np.linalg.norm((self.position_m - self.wanted_m)[late, :2], axis=1))


def going(
    position: object, velocity: object = None, acceleration: object = None, yaw: float | None = 0.0, rate: float = 0.0
) -> Reference:
    """Return a reference of sequences instead of arrays."""
    groups = [
        None if group is None else np.array(group, dtype=np.float64) for group in (position, velocity, acceleration)
    ]
    return Reference(
        position_enu_m=groups[0],
        velocity_enu_m_s=groups[1],
        acceleration_enu_m_s2=groups[2],
        yaw_rad=yaw,
        yaw_rate_rad_s=rate,
    )


def holding(position: object, yaw: float | None = 0.0) -> Reference:
    """Return a reference at rest."""
    return going(position, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), yaw)


def at_rest(config: PlantConfig, position: object, yaw: float = 0.0) -> PlantMemory:
    """Return a drone at rest with its motors stopped."""
    return initial_plant(config, 0, np.array(position, dtype=np.float64), yaw)


def hovering(
    config: PlantConfig, position: object, yaw: float = 0.0, *, velocity: object = (0.0, 0.0, 0.0)
) -> PlantMemory:
    """Return a level drone whose rotors carry it."""
    memory = at_rest(config, position, yaw)
    state = replace(
        memory.state,
        rotor_speed_rad_s=np.full(4, config.airframe.hover_speed_rad_s),
        velocity_enu_m_s=np.array(velocity, dtype=np.float64),
    )
    return replace(memory, state=state)


def flown(
    config: PlantConfig,
    memory: PlantMemory,
    reference_at: Callable[[float], Reference | None],
    duration_s: float,
    *,
    deck_at: Callable[[float], Deck | None] = lambda _: None,
    wind_at: Callable[[float], Array] = lambda _: CALM,
) -> Flight:
    """Fly `memory` along `reference_at`, both from t = 0."""
    states = []
    wanted = []
    t_s = DT_S * np.arange(1, round(duration_s / DT_S) + 1, dtype=np.float64)
    for end_s in t_s.tolist():
        start_s = end_s - DT_S
        memory = fly(memory, reference_at(start_s), deck_at(start_s), wind_at(start_s), config, DT_S)
        states.append(memory.state)
        goal = reference_at(end_s)
        wanted.append(CALM if goal is None or goal.position_enu_m is None else goal.position_enu_m)
    q = np.array([state.orientation_wxyz for state in states])
    w, x, y, z = q.T
    return Flight(
        t_s=t_s,
        wanted_m=np.array(wanted),
        position_m=np.array([state.position_enu_m for state in states]),
        velocity_m_s=np.array([state.velocity_enu_m_s for state in states]),
        yaw_rad=np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
        tilt_rad=np.arccos(np.clip(1.0 - 2.0 * (x * x + y * y), -1.0, 1.0)),
        surface=[state.surface for state in states],
        end=memory,
    )


def driving(
    speed_m_s: float = 0.0, *, height_m: float = 1.5, yaw: float = 0.0, size_m: tuple[float, float] = (4.0, 1.8)
) -> Callable[[float], Deck]:
    """Return a vehicle that passes the origin at t = 0 with constant speed along its heading."""
    along = np.array([np.cos(yaw), np.sin(yaw), 0.0])

    def deck_at(t_s: float) -> Deck:
        return Deck(
            t_ns=round(t_s * 1e9),
            position_enu_m=along * speed_m_s * t_s,
            orientation_wxyz=np.array([np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)]),
            velocity_enu_m_s=along * speed_m_s,
            angular_velocity_enu_rad_s=np.zeros(3),
            roof_size_m=size_m,
            roof_height_m=height_m,
        )

    return deck_at
