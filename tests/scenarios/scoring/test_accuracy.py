"""The estimate against the truth: the frame it is compared in, and what NEES and NIS of a fair filter are."""

import math

import numpy as np
import pytest
from scipy import stats

from companion.core.data import VehicleEstimate
from link.frames.geodesy import Datum, LocalFrame, Projection, geodetic_from_enu
from link.frames.rotations import quaternion_from_yaw
from link.messages import Vector3
from link.records import replace
from scenarios.campaigns.intervals import mean_band
from scenarios.scoring.accuracy import EstimateError, Nis, Truth, accuracy_table, antenna_truth, estimate_error
from scenarios.simulation.sensors import Mounting
from scenarios.simulation.vehicle import VehicleState
from sim_autopilot.boot import initial_memory
from sim_autopilot.core.places import Origin
from tests.sim_autopilot.pilot import DATUM, START_NS, px4

TRUTH = Truth(position_enu_m=(10.0, -4.0, 1.6), velocity_enu_m_s=(5.0, 1.0, 0.0))


def estimate_of(position: np.ndarray, velocity: np.ndarray, covariance: np.ndarray) -> VehicleEstimate:
    return VehicleEstimate(
        t_ns=START_NS,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=np.zeros(3),
        covariance=covariance,
        yaw_rad=None,
        yaw_rate_rad_s=None,
    )


def vehicle_of(
    position_enu_m: Vector3, velocity_enu_m_s: Vector3, yaw_rad: float, yaw_rate_rad_s: float
) -> VehicleState:
    return VehicleState(
        t_ns=START_NS,
        position_enu_m=position_enu_m,
        velocity_enu_m_s=velocity_enu_m_s,
        acceleration_enu_m_s2=(0.0, 0.0, 0.0),
        orientation_wxyz=quaternion_from_yaw(yaw_rad),
        angular_velocity_flu_rad_s=(0.0, 0.0, yaw_rate_rad_s),
        yaw_rad=yaw_rad,
        yaw_rate_rad_s=yaw_rate_rad_s,
    )


def test_antenna_is_seen_from_the_frame_and_with_the_error_that_the_drone_flies_by() -> None:
    vehicle = vehicle_of((100.0, 50.0, 0.0), (0.0, 5.0, 0.0), 0.5 * math.pi, 0.4)
    memory = initial_memory(px4(position_enu_m=(3.0, 4.0, 0.12)), START_NS)
    believed = replace(memory.now, position_enu_m=(3.5, 4.0, 0.12))
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(DATUM, (3.0, -4.0, 0.0))
    moved = Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m)
    frame = LocalFrame(origin=moved, projection=Projection.TANGENT_PLANE)
    origin = Origin(world=DATUM, frame=frame, position_enu_m=(3.0, -4.0, 0.0), resets=1)
    mounting = Mounting(antenna_flu_m=(-1.2, 0.5, 1.6), pad_height_m=1.5)
    truth = antenna_truth(
        vehicle, mounting, replace(memory, now=believed, places=replace(memory.places, origin=origin))
    )
    # lever (-0.5, -1.2, 1.6) in W, error (0.5, 0, 0), frame moved by (3, -4, 0); w x lever = 0.4 (1.2, -0.5)
    assert truth.position_enu_m == pytest.approx((100.0 - 0.5 + 0.5 - 3.0, 50.0 - 1.2 + 4.0, 1.6), abs=1e-3)
    assert truth.velocity_enu_m_s == pytest.approx((0.48, 5.0 - 0.2, 0.0))


def test_arm_from_the_pad_is_in_true_metres_whatever_those_of_the_frame_are() -> None:
    vehicle = vehicle_of((200.0, 100.0, 0.0), (5.0, 0.0, 0.0), 0.0, 0.02)
    memory = initial_memory(px4(position_enu_m=(0.0, 0.0, 0.12)), START_NS)
    frame = LocalFrame(origin=DATUM, projection=Projection.PX4)
    origin = Origin(world=DATUM, frame=frame, position_enu_m=(0.0, 0.0, 0.0), resets=1)
    there = replace(memory, places=replace(memory.places, origin=origin))
    antenna = antenna_truth(vehicle, Mounting(antenna_flu_m=(13.0, 3.0, 13.0), pad_height_m=6.5), there)
    pad = antenna_truth(vehicle, Mounting(antenna_flu_m=(0.0, 0.0, 6.5), pad_height_m=6.5), there)
    assert abs(pad.position_enu_m[0] - 200.0) > 0.5
    assert np.subtract(antenna.position_enu_m, pad.position_enu_m) == pytest.approx((13.0, 3.0, 6.5), abs=1e-6)
    assert np.subtract(antenna.velocity_enu_m_s, pad.velocity_enu_m_s) == pytest.approx((-0.06, 0.26, 0.0), abs=1e-9)


def test_nees_of_errors_drawn_from_the_covariance_lies_in_its_band() -> None:
    rng = np.random.default_rng(8)
    root = rng.normal(size=(9, 9))
    covariance = root @ root.T + 0.1 * np.eye(9)
    place, speed = np.array(TRUTH.position_enu_m), np.array(TRUTH.velocity_enu_m_s)
    total, runs = 0.0, 400
    for _ in range(runs):
        error = rng.multivariate_normal(np.zeros(9), covariance)
        estimate = estimate_of(place + error[:3], speed + error[3:6], covariance)
        total += estimate_error(estimate, TRUTH, in_descent=True).nees
    low, high = mean_band(6 * runs)
    assert low is not None
    assert high is not None
    assert 6.0 * low < total / runs < 6.0 * high


def test_band_of_a_mean_is_that_of_chi_square() -> None:
    expected = [float(stats.chi2.ppf(level, 120)) / 120 for level in (0.025, 0.975)]
    assert mean_band(120) == pytest.approx(tuple(expected))
    assert mean_band(0) == (None, None)


def test_accuracy_takes_its_errors_from_the_descent_and_nees_from_all() -> None:
    errors = [
        EstimateError(in_descent=False, position_m=9.0, velocity_m_s=9.0, nees=1.0),
        EstimateError(in_descent=True, position_m=0.3, velocity_m_s=0.1, nees=5.0),
        EstimateError(in_descent=True, position_m=0.4, velocity_m_s=0.7, nees=9.0),
    ]
    assert accuracy_table(errors, Nis(total=30.0, dof=25)) == {
        "position_rmse_m": pytest.approx(math.sqrt(0.125)),
        "velocity_rmse_m_s": pytest.approx(0.5),
        "nees_mean": pytest.approx(5.0),
        "nees_count": 3,
        "nis_sum": 30.0,
        "nis_dof": 25,
    }


def test_run_without_estimates_has_no_accuracy() -> None:
    assert set(accuracy_table([], None).values()) == {None}
