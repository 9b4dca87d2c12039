"""What the simulated drone is and how it is controlled, with the kernels' records that follow from it."""

from dataclasses import dataclass, field
from functools import lru_cache
from math import inf

import numpy as np
from numpy.typing import NDArray

from sim_autopilot.control.geometric import MOTOR_POLE_RAD_S, geometric_gains
from sim_autopilot.control.lqr import feedforward_gains, report_gains
from sim_autopilot.control.parameters import CascadeGains, ControllerKind, control_record
from sim_autopilot.core.data import Array
from sim_autopilot.core.limits import DEFAULT_ENVELOPE, Envelope, PositionGains
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, Airframe
from sim_autopilot.physics.parameters import body_record

INTEGRATION_STEP_S = 0.001
OBSERVER_POLE_RAD_S = 4.0
"""Of the disturbance observer, below the position loop's poles: wind and drag change slower than a manoeuvre."""
TILT_BRAKING_PART = 0.4
"""Of the torque that there is: the rest is for the motors' lag and for errors."""


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
        gains: of the firmware's position control and lean, in place of the controller's own.
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
        count_whole(self.control_period_s, INTEGRATION_STEP_S, "control_period_s")
        body = body_record(self.airframe, self.friction_coefficient, ground_effect=self.ground_effect, solid=self.solid)
        linear = self.controller is ControllerKind.LQR_FEEDFORWARD
        gains = feedforward_gains(self.airframe) if linear else geometric_gains()
        control = control_record(
            self.controller,
            gains if self.gains is None else _with_gains(gains, self.gains),
            _gains_of(self.airframe),
            self.envelope,
            pid=self.gains,
            period_s=self.control_period_s,
            observer_rad_s=OBSERVER_POLE_RAD_S if self.gains is None else self.gains.observer_rad_s,
            motor_lead=_motor_lead(self.airframe),
            tilt_braking_rad_s2=_tilt_braking_rad_s2(self.airframe),
        )
        object.__setattr__(self, "records", (body, control))


@lru_cache(maxsize=4)
def _gains_of(airframe: Airframe) -> tuple[Array, Array]:
    """Return the report's gains, which take 5 ms; each boot and each change of a limit asks for them."""
    return report_gains(airframe)


def _with_gains(own: CascadeGains, given: PositionGains) -> CascadeGains:
    """Return the cascade with a firmware's gains; its turn rates are followed as well as this airframe can."""
    level, vertical = given.level.velocity_per_s, given.vertical.velocity_per_s
    along, up = given.level.position_per_s * level, given.vertical.position_per_s * vertical
    x, y, z = own.rate
    return CascadeGains(
        position=(along, along, up),
        velocity=(level, level, vertical),
        attitude=(given.attitude_per_s * x, given.attitude_per_s * y, own.attitude[2]),
        rate=(x, y, z),
    )


def _motor_lead(airframe: Airframe) -> float:
    lag_s = airframe.motor_time_constant_s
    return 0.0 if lag_s is None else max(0.0, lag_s * MOTOR_POLE_RAD_S - 1.0)


def _tilt_braking_rad_s2(airframe: Airframe) -> float:
    """Return what a turn is braked with: a share of what two rotors, one full and one stopped, can."""
    if airframe.thrust_to_weight is None:
        return inf
    thrust_n = airframe.thrust_to_weight * airframe.weight_n / 4.0
    return TILT_BRAKING_PART * thrust_n * airframe.arm_m / max(airframe.inertia_kg_m2[:2])


def count_whole(duration_s: float, part_s: float, name: str) -> int:
    """Return how often `part_s` is in `duration_s`.

    Raises:
        ValueError: if that is no whole number, at least 1.
    """
    count = round(duration_s / part_s)
    if count < 1 or abs(count * part_s - duration_s) > 1e-9:
        msg = f"{name} is {duration_s} s, which is not a multiple of {part_s} s"
        raise ValueError(msg)
    return count
