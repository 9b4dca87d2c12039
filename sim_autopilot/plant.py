"""The simulated drone under its flight controller: one pure function from a reference to a new state."""

from dataclasses import dataclass

from sim_autopilot.control.kinds import ControllerKind, Envelope
from sim_autopilot.data import Array, Deck, PlantState, Reference
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, Airframe


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantConfig:
    """All that `fly` needs to know, numbers only.

    Attributes:
        airframe: body, motors, drag.
        controller: which one flies.
        envelope: what it keeps to.
        friction_coefficient: Coulomb's, of gear on roof and ground.
        ground_effect: whether thrust grows near a surface.
        control_period_s: of the flight controller.
    """

    airframe: Airframe = BENCHMARK_AIRFRAME
    controller: ControllerKind = ControllerKind.GEOMETRIC
    envelope: Envelope = Envelope()
    friction_coefficient: float = 0.8
    ground_effect: bool = True
    control_period_s: float = 0.005


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlantMemory:
    """The drone and what its controller and its contacts remember.

    Attributes:
        state: the body.
        internals: controller memory and friction anchors, opaque.
    """

    state: PlantState
    internals: Array


def initial_plant(config: PlantConfig, t_ns: int, position_enu_m: Array, yaw_rad: float) -> PlantMemory:
    """Return a drone at rest, level, motors stopped."""
    raise NotImplementedError


def fly(
    memory: PlantMemory,
    reference: Reference | None,
    deck: Deck | None,
    wind_enu_m_s: Array,
    config: PlantConfig,
    duration_s: float,
) -> PlantMemory:
    """Return the plant `duration_s` later (a multiple of the control period); a None reference stops the motors."""
    raise NotImplementedError
