"""The airframe and its surroundings as one record that the kernels read."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim_autopilot.physics.airframe import Airframe

Record = Any
"""One element of a structured array: numba knows its fields, typing does not."""

BODY = np.dtype(
    [
        ("mass_kg", "f8"),
        ("inertia_kg_m2", "f8", (3,)),
        ("arm_m", "f8"),
        ("thrust_coefficient_n_s2", "f8"),
        ("torque_per_thrust_m", "f8"),
        ("rotor_radius_m", "f8"),
        ("motor_time_constant_s", "f8"),  # 0 is no lag
        ("thrust_max_n", "f8"),  # of one rotor; infinite is no limit
        ("drag_n_s_m", "f8"),
        ("drag_n_s2_m2", "f8"),
        ("direct", "i8"),  # 1: thrust and torques act at once, unbounded
        ("friction_coefficient", "f8"),
        ("ground_effect", "i8"),
        ("solid", "i8"),  # 0: with its motors running the drone passes through everything
    ]
)


def body_record(
    airframe: Airframe, friction_coefficient: float, *, ground_effect: bool, solid: bool = True
) -> NDArray[np.void]:
    """Return the record (1,) of an airframe and of what it stands on."""
    limit = airframe.thrust_to_weight
    record = np.zeros(1, dtype=BODY)
    record["mass_kg"] = airframe.mass_kg
    record["inertia_kg_m2"] = airframe.inertia_kg_m2
    record["arm_m"] = airframe.arm_m
    record["thrust_coefficient_n_s2"] = airframe.thrust_coefficient_n_s2
    record["torque_per_thrust_m"] = airframe.torque_coefficient_n_m_s2 / airframe.thrust_coefficient_n_s2
    record["rotor_radius_m"] = airframe.rotor_radius_m
    record["motor_time_constant_s"] = airframe.motor_time_constant_s or 0.0
    record["thrust_max_n"] = math.inf if limit is None else limit * airframe.weight_n / 4.0
    record["drag_n_s_m"] = airframe.drag_n_s_m
    record["drag_n_s2_m2"] = airframe.drag_n_s2_m2
    record["direct"] = airframe.takes_wrench_directly
    record["friction_coefficient"] = friction_coefficient
    record["ground_effect"] = ground_effect
    record["solid"] = solid
    return record
