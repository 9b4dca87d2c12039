"""The air at the drone: the wind, and what the vehicle near it makes of that."""

from math import hypot

import numpy as np

from link.frames.rotations import conjugate, rotate
from link.messages import Vector3
from sim_autopilot.air.airflow import Obstacle, body_of, flow_at
from sim_autopilot.air.wind import WindModel, first_order_step
from sim_autopilot.core.data import Array, Deck, PlantState
from sim_autopilot.core.noise import NoiseSeed


class Air:
    """The air where the drone is; the same seeds and steps give the same air.

    A wake's eddies are as long as what they come from is high, and the stream carries them along. After the time
    `height / stream` they are others. The corner of their spectrum is at 0.16 of its inverse. Over flight decks 0.1 to
    0.2 are measured.

    Args:
        wind: far from the vehicle.
        seed: of the turbulence behind the vehicle, or the generator that draws it.
        superstructure: what stands on the vehicle's deck, None where the vehicle itself is in the wind.
    """

    def __init__(self, wind: WindModel, seed: NoiseSeed, superstructure: Obstacle | None = None) -> None:
        self._wind = wind
        self._generator = np.random.default_rng(seed)
        self._superstructure = superstructure
        self._eddies: list[float] = self._generator.standard_normal(3).tolist()
        self._velocity_enu_m_s: Array = np.zeros(3)

    def advance(self, dt_s: float, drone: PlantState, deck: Deck | None) -> Array:
        """Return the air's velocity (3,), m/s in W, `dt_s` later for a drone that flew through it."""
        away = (drone.velocity_enu_m_s - self._velocity_enu_m_s).tolist()
        wind = self._wind.advance(dt_s, hypot(*away))
        if deck is not None:
            obstacle = self._superstructure or body_of(deck.roof_size_m, deck.roof_height_m)
            if obstacle is not None:
                wind += self._about(dt_s, drone, wind, deck, obstacle)
        self._velocity_enu_m_s = wind
        return wind

    def _about(self, dt_s: float, drone: PlantState, wind_enu_m_s: Array, deck: Deck, obstacle: Obstacle) -> Vector3:
        """Return what the vehicle, as far on as it is by now, adds to the wind at the drone, turbulence included."""
        to_vehicle = conjugate(deck.orientation_wxyz)
        along_m_s, across_m_s, _ = rotate(to_vehicle, wind_enu_m_s - deck.velocity_enu_m_s)
        since_s = (drone.t_ns - deck.t_ns) * 1e-9
        place_flu_m = rotate(to_vehicle, drone.position_enu_m - deck.position_enu_m - since_s * deck.velocity_enu_m_s)
        flow = flow_at(obstacle, place_flu_m, (along_m_s, across_m_s))
        change = list(flow.change_m_s)
        if flow.turbulence_m_s > 0.0:
            elapsed = dt_s * hypot(along_m_s, across_m_s) / obstacle.height_m
            for i, noise in enumerate(self._generator.standard_normal(3).tolist()):
                self._eddies[i] = first_order_step(self._eddies[i], elapsed, noise)
                change[i] += flow.turbulence_m_s * self._eddies[i]
        return rotate(deck.orientation_wxyz, change)
