"""The simulated drone under its flight controller: one pure function from a reference to a new state."""

from dataclasses import dataclass, field
from math import atan2, hypot, inf

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from link.records import replace
from sim_autopilot.control.geometric import MOTOR_POLE_RAD_S, geometric_gains
from sim_autopilot.control.lqr import feedforward_gains, report_gains
from sim_autopilot.control.parameters import (
    DISTURBANCE,
    REFERENCE_SIZE,
    CascadeGains,
    ControllerKind,
    control_record,
    reference_vector,
)
from sim_autopilot.core.data import Array, Deck, PlantState, Reference, Surface
from sim_autopilot.core.limits import DEFAULT_ENVELOPE, Envelope, PositionGains
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, GRAVITY_M_S2, Airframe
from sim_autopilot.physics.contact import DECK_SIZE
from sim_autopilot.physics.parameters import body_record
from sim_autopilot.physics.rotation import quaternion_from_yaw
from sim_autopilot.plant.kernel import BODY_END, FORCE_END, MEMORY_START, PLANT_SIZE, SPEED_END, SURFACE, advance
from sim_autopilot.plant.own_state import NO_ERROR

INTEGRATION_STEP_S = 0.001
OBSERVER_POLE_RAD_S = 4.0
"""Of the disturbance observer, below the position loop's poles: wind and drag change slower than a manoeuvre."""
_SLOWEST_RAD_S = 0.05
TILT_BRAKING_PART = 0.4
"""Of the torque that there is: the rest is for the motors' lag and for errors."""
SURFACES = tuple(Surface)
NO_REFERENCE: Array = np.zeros(REFERENCE_SIZE)
NO_DECK: Array = np.array([0.0] * 3 + [1.0] + [0.0] * (DECK_SIZE - 4))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantConfig:
    """All that `fly` needs to know, numbers only.

    Attributes:
        airframe: body, motors, drag.
        controller: which one flies.
        envelope: what it keeps to.
        friction_coefficient: Coulomb's, of gear on roof and ground.
        ground_effect: whether thrust grows near a surface.
        solid: whether a drone whose motors run can touch ground and vehicle.
        control_period_s: of the flight controller, a multiple of 1 ms.
        gains: of position and velocity in place of the controller's own.
        records: the same for the kernels, derived: airframe and controller.
    """

    airframe: Airframe = BENCHMARK_AIRFRAME
    controller: ControllerKind = ControllerKind.GEOMETRIC
    envelope: Envelope = DEFAULT_ENVELOPE
    friction_coefficient: float = 0.8
    ground_effect: bool = True
    solid: bool = True
    control_period_s: float = 0.005
    gains: PositionGains | None = None
    records: tuple[NDArray[np.void], NDArray[np.void]] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Derive the kernels' records."""
        _whole(self.control_period_s, INTEGRATION_STEP_S, "control_period_s")
        body = body_record(self.airframe, self.friction_coefficient, ground_effect=self.ground_effect, solid=self.solid)
        linear = self.controller is ControllerKind.LQR_FEEDFORWARD
        gains = feedforward_gains(self.airframe) if linear else geometric_gains()
        control = control_record(
            self.controller,
            gains if self.gains is None else _with_gains(gains, self.gains),
            report_gains(self.airframe),
            self.envelope,
            period_s=self.control_period_s,
            observer_rad_s=OBSERVER_POLE_RAD_S if self.gains is None else _observer_pole(self.gains),
            motor_lead=_motor_lead(self.airframe),
            tilt_braking_rad_s2=_tilt_braking_rad_s2(self.airframe),
        )
        object.__setattr__(self, "records", (body, control))


class PlantMemory(Struct, frozen=True, kw_only=True, eq=False):
    """The drone and what its controller and its contacts remember.

    Attributes:
        state: the body.
        internals: controller memory and friction anchors, opaque.
    """

    state: PlantState
    internals: Array


def _with_gains(own: CascadeGains, given: PositionGains) -> CascadeGains:
    level, vertical = given.velocity_per_s, given.vertical_velocity_per_s
    along, up = given.position_per_s * level, given.vertical_position_per_s * vertical
    return replace(own, position=(along, along, up), velocity=(level, level, vertical))


def _observer_pole(gains: PositionGains) -> float:
    """The pole with which the observer lags behind a growing disturbance as an integrator of the velocity would.

    A ramp of slope r leaves `2 r / w_o` uncompensated by the observer, and needs a velocity error of `r / ki`, which
    the velocity gain turns into `kv r / ki`.
    """
    return max(_SLOWEST_RAD_S, 2.0 * gains.integral_per_s2 / gains.velocity_per_s)


def asked_tilt_rad(memory: PlantMemory, reference: Reference | None) -> float:
    """Return how far the drone would lean to follow the reference's acceleration against the observed disturbance."""
    if reference is None:
        return 0.0
    east, north, _ = memory.internals[DISTURBANCE : DISTURBANCE + 3].tolist()
    if reference.acceleration_enu_m_s2 is not None:
        east -= float(reference.acceleration_enu_m_s2[0])
        north -= float(reference.acceleration_enu_m_s2[1])
    return atan2(hypot(east, north), GRAVITY_M_S2)


def _motor_lead(airframe: Airframe) -> float:
    lag_s = airframe.motor_time_constant_s
    return 0.0 if lag_s is None else max(0.0, lag_s * MOTOR_POLE_RAD_S - 1.0)


def _tilt_braking_rad_s2(airframe: Airframe) -> float:
    """Return what a turn is braked with: a share of what two rotors, one full and one stopped, can."""
    if airframe.thrust_to_weight is None:
        return inf
    thrust_n = airframe.thrust_to_weight * airframe.weight_n / 4.0
    return TILT_BRAKING_PART * thrust_n * airframe.arm_m / max(airframe.inertia_kg_m2[:2])


def _whole(duration_s: float, part_s: float, name: str) -> int:
    count = round(duration_s / part_s)
    if count < 1 or abs(count * part_s - duration_s) > 1e-9:
        msg = f"{name} is {duration_s} s, which is not a multiple of {part_s} s"
        raise ValueError(msg)
    return count


def initial_plant(config: PlantConfig, t_ns: int, position_enu_m: Array, yaw_rad: float) -> PlantMemory:
    """Return a drone at rest, level, motors stopped.

    Args:
        config: of the plant.
        t_ns: time of the state.
        position_enu_m: (3,) of the centre of mass; `GEAR_HEIGHT_M` above a surface it stands on it.
        yaw_rad: heading about z.
    """
    del config
    state = PlantState(
        t_ns=t_ns,
        position_enu_m=np.array(position_enu_m, dtype=np.float64),
        orientation_wxyz=quaternion_from_yaw(yaw_rad),
        velocity_enu_m_s=np.zeros(3),
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
    periods = _whole(duration_s, config.control_period_s, "duration_s")
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
