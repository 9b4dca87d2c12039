"""The simulated drone under its flight controller: one pure function from a reference to a new state."""

from math import atan2, hypot

import numpy as np
from msgspec import Struct

from sim_autopilot.control.parameters import DISTURBANCE, MISSED, REFERENCE_SIZE, reference_vector
from sim_autopilot.core.data import Array, Deck, PlantState, Reference, Surface
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.physics.contact import DECK_SIZE
from sim_autopilot.physics.rotation import quaternion_from_yaw
from sim_autopilot.plant.config import INTEGRATION_STEP_S, PlantConfig, count_whole
from sim_autopilot.plant.kernel import BODY_END, FORCE_END, MEMORY_START, PLANT_SIZE, SPEED_END, SURFACE, advance
from sim_autopilot.plant.own_state import NO_ERROR

SURFACES = tuple(Surface)
AT_REST: Array = np.zeros(3)
NO_REFERENCE: Array = np.zeros(REFERENCE_SIZE)
NO_DECK: Array = np.array([0.0] * 3 + [1.0] + [0.0] * (DECK_SIZE - 4))


class PlantMemory(Struct, frozen=True, kw_only=True, eq=False):
    """The drone and what its controller and its contacts remember.

    Attributes:
        state: the body.
        internals: controller memory and friction anchors, opaque.
    """

    state: PlantState
    internals: Array


def asked_tilt_rad(memory: PlantMemory, reference: Reference | None) -> float:
    """Return how far the drone would lean to follow the reference's acceleration against the observed disturbance."""
    if reference is None:
        return 0.0
    east, north, _ = memory.internals[DISTURBANCE : DISTURBANCE + 3].tolist()
    if reference.acceleration_enu_m_s2 is not None:
        east -= float(reference.acceleration_enu_m_s2[0])
        north -= float(reference.acceleration_enu_m_s2[1])
    return atan2(hypot(east, north), GRAVITY_M_S2)


def missed_acceleration(memory: PlantMemory) -> tuple[float, float] | None:
    """Return the level acceleration in W that the drone was last asked for in vain, None if it could have it."""
    east_m_s2, north_m_s2 = memory.internals[MISSED : MISSED + 2].tolist()
    return None if east_m_s2 == north_m_s2 == 0.0 else (east_m_s2, north_m_s2)


def initial_plant(
    config: PlantConfig, t_ns: int, position_enu_m: Array, yaw_rad: float, velocity_enu_m_s: Array = AT_REST
) -> PlantMemory:
    """Return a level drone, motors stopped.

    Args:
        config: of the plant.
        t_ns: time of the state.
        position_enu_m: (3,) of the centre of mass; `GEAR_HEIGHT_M` above a surface it stands on it.
        yaw_rad: heading about z.
        velocity_enu_m_s: (3,) of what it stands on.
    """
    del config
    state = PlantState(
        t_ns=t_ns,
        position_enu_m=np.array(position_enu_m, dtype=np.float64),
        orientation_wxyz=quaternion_from_yaw(yaw_rad),
        velocity_enu_m_s=np.array(velocity_enu_m_s, dtype=np.float64),
        angular_velocity_flu_rad_s=np.zeros(3),
        rotor_speed_rad_s=np.zeros(4),
        specific_force_flu_m_s2=np.zeros(3),
        surface=Surface.NONE,
    )
    return PlantMemory(state=state, internals=np.zeros(PLANT_SIZE - MEMORY_START))


def fly(  # noqa: PLR0917 (read as a sentence: who, where to, over what, in which air)
    memory: PlantMemory,
    reference: Reference | None,
    deck: Deck | None,
    wind_enu_m_s: Array,
    config: PlantConfig,
    duration_s: float,
    own_error: Array = NO_ERROR,
) -> PlantMemory:
    """Return the plant `duration_s` later.

    Args:
        memory: the plant now.
        reference: at the plant's time; its velocity, acceleration and heading rate carry it on. None stops the motors.
        deck: the vehicle, at any time near the plant's; its velocities carry it on. None is no vehicle.
        wind_enu_m_s: (3,) air over ground.
        config: of the plant.
        duration_s: a multiple of the control period.
        own_error: (6,) m and m/s in W by which the position and velocity that it flies by are wrong.

    Raises:
        ValueError: if `duration_s` is no such multiple.
    """
    periods = count_whole(duration_s, config.control_period_s, "duration_s")
    body, control = config.records
    plant = _plant_vector(memory)
    advance(
        plant,
        reference is not None,
        NO_REFERENCE if reference is None else reference_vector(reference),
        own_error,
        NO_DECK if deck is None else _deck_vector(deck, memory.state.t_ns),
        wind_enu_m_s,
        control,
        body,
        periods,
        round(config.control_period_s / INTEGRATION_STEP_S),
    )
    return _plant_memory(plant, memory.state.t_ns + round(duration_s * 1e9))


def _plant_vector(memory: PlantMemory) -> Array:
    state = memory.state
    plant = np.empty(PLANT_SIZE)
    plant[0:3] = state.position_enu_m
    plant[3:7] = state.orientation_wxyz
    plant[7:10] = state.velocity_enu_m_s
    plant[10:13] = state.angular_velocity_flu_rad_s
    plant[BODY_END:SPEED_END] = state.rotor_speed_rad_s
    plant[SURFACE] = state.surface.value
    plant[MEMORY_START:] = memory.internals
    return plant


def _deck_vector(deck: Deck, t_ns: int) -> Array:
    vector = np.empty(DECK_SIZE)
    vector[0:3] = deck.position_enu_m
    vector[3:7] = deck.orientation_wxyz
    vector[7:10] = deck.velocity_enu_m_s
    vector[10:13] = deck.angular_velocity_enu_rad_s
    vector[13] = 0.5 * deck.roof_size_m[0]
    vector[14] = 0.5 * deck.roof_size_m[1]
    vector[15] = deck.roof_height_m
    vector[16] = 1.0
    vector[17] = (t_ns - deck.t_ns) * 1e-9
    vector[18] = deck.lowest_m
    vector[19] = deck.road_m
    return vector


def _plant_memory(plant: Array, t_ns: int) -> PlantMemory:
    state = PlantState(
        t_ns=t_ns,
        position_enu_m=plant[0:3],
        orientation_wxyz=plant[3:7],
        velocity_enu_m_s=plant[7:10],
        angular_velocity_flu_rad_s=plant[10:13],
        rotor_speed_rad_s=plant[BODY_END:SPEED_END],
        specific_force_flu_m_s2=plant[SPEED_END:FORCE_END],
        surface=SURFACES[int(plant[SURFACE])],
    )
    return PlantMemory(state=state, internals=plant[MEMORY_START:])
