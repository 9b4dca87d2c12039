"""How well the companion's estimate of the vehicle agrees with the truth, and with its own covariance.

The truth is taken in the frame that the drone flies in: the autopilot's local frame with the autopilot's own error,
since there the estimate has to be right. NEES is over position and velocity, NIS as the delay buffer counts it.
Source of both tests: Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation, 5.4.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from companion.core.data import Array, VehicleEstimate
from companion.situation.phases import Phase
from link.frames.geodesy import scale_of
from link.frames.rotations import rotate
from link.messages import Vector3
from scenarios.simulation.sensors import Mounting
from scenarios.simulation.vehicle import VehicleState
from sim_autopilot.core.places import local_from_world

if TYPE_CHECKING:
    from sim_autopilot.memory import AutopilotMemory  # of the flight, with its numerics: a score needs none

NEES_DOF = 6
PHASES = frozenset({Phase.CHASE, Phase.ALIGN, Phase.DESCEND})
"""In which estimates are compared: the manoeuvre until contact."""
PERIOD_NS = 100_000_000
"""Between two of them, that of the benchmark's receiver; nearer ones tell nothing new."""


class Truth(Struct, frozen=True, kw_only=True):
    """The vehicle's antenna in the frame that the drone flies in, m and m/s."""

    position_enu_m: Vector3
    velocity_enu_m_s: Vector3


class EstimateError(Struct, frozen=True, kw_only=True):
    """An estimate against the truth."""

    in_descent: bool
    position_m: float
    velocity_m_s: float
    nees: float


class Nis(Struct, frozen=True, kw_only=True):
    """Normalised innovations squared of the accepted measurements, summed up, with their degrees of freedom."""

    total: float
    dof: int


def antenna_truth(vehicle: VehicleState, mounting: Mounting, autopilot: "AutopilotMemory") -> Truth:
    """Return where the vehicle's antenna is for a drone whose autopilot is `autopilot`.

    A metre in the frames of PX4 and ArduPilot is up to 0.7 % off a true one. The drone lands on the pad, so there both
    have to agree, and the arm from the pad to the antenna is in true metres: 15 m of a ship make 5 cm otherwise.
    """
    pad_m = rotate(vehicle.orientation_wxyz, (0.0, 0.0, mounting.pad_height_m))
    lever_m = np.array(rotate(vehicle.orientation_wxyz, mounting.antenna_flu_m))
    rate_rad_s = rotate(vehicle.orientation_wxyz, vehicle.angular_velocity_flu_rad_s)
    own_error_m = np.array(autopilot.now.position_enu_m) - autopilot.plant.state.position_enu_m
    pad_enu_m = np.array(vehicle.position_enu_m) + pad_m + own_error_m
    velocity_m_s = np.array(vehicle.velocity_enu_m_s) * scale_of(autopilot.places.origin.frame)
    position_m = np.array(local_from_world(autopilot.places.origin, _vector3(pad_enu_m))) + lever_m - pad_m
    return Truth(
        position_enu_m=_vector3(position_m),
        velocity_enu_m_s=_vector3(velocity_m_s + np.cross(rate_rad_s, lever_m)),
    )


def estimate_error(estimate: VehicleEstimate, truth: Truth, *, in_descent: bool) -> EstimateError:
    """Return by how much `estimate` is off."""
    position_m = estimate.position_enu_m - truth.position_enu_m
    velocity_m_s = estimate.velocity_enu_m_s - truth.velocity_enu_m_s
    error = np.concatenate([position_m, velocity_m_s])
    return EstimateError(
        in_descent=in_descent,
        position_m=float(np.linalg.norm(position_m)),
        velocity_m_s=float(np.linalg.norm(velocity_m_s)),
        nees=float(error @ np.linalg.solve(estimate.covariance[:NEES_DOF, :NEES_DOF], error)),
    )


def accuracy_table(errors: Sequence[EstimateError], nis: Nis | None) -> dict[str, float | int | None]:
    """Return a run's accuracy: root mean squares over the descent, NEES over the manoeuvre, None where unknown."""
    descent = [error for error in errors if error.in_descent]
    return {
        "position_rmse_m": _root_mean_square([error.position_m for error in descent]),
        "velocity_rmse_m_s": _root_mean_square([error.velocity_m_s for error in descent]),
        "nees_mean": float(np.mean([error.nees for error in errors])) if errors else None,
        "nees_count": len(errors) or None,
        "nis_sum": None if nis is None else nis.total,
        "nis_dof": None if nis is None else nis.dof,
    }


def _root_mean_square(values: Sequence[float]) -> float | None:
    return math.sqrt(float(np.mean(np.square(values)))) if values else None


def _vector3(vector: Array) -> Vector3:
    x, y, z = vector.tolist()
    return x, y, z
