"""How the drone leans, and where its lowest foot is, by its reports."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from companion.config.companion import CompanionConfig
from companion.core.data import OwnState
from companion.situation.own_drone import drone_now, lowest_foot
from companion.situation.situation import Drone
from link.frames.rotations import multiply, normalized, quaternion_from_roll_pitch_yaw, rotate
from link.records import replace

TOUCHDOWN = CompanionConfig().touchdown
STEP_S = 1e-6

angles_rad = st.floats(-0.6, 0.6)
rates_rad_s = st.floats(-3.0, 3.0)


def drone_of(orientation_wxyz: tuple[float, float, float, float], rates: tuple[float, float, float]) -> Drone:
    """The drone of a report with this attitude."""
    own = OwnState(
        t_ns=0,
        position_enu_m=(0.0, 0.0, 5.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=orientation_wxyz,
        angular_velocity_flu_rad_s=rates,
    )
    drone = drone_now(own, 0, 0.0, 1.0)
    assert drone is not None
    return drone


@pytest.mark.parametrize("attitude_age_s", [0.0, 0.02, 0.1])
def test_place_that_is_told_no_more_is_missed_itself_and_not_the_attitude(attitude_age_s: float) -> None:
    own = OwnState(
        t_ns=0,
        position_enu_m=(0.0, 0.0, 5.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
        attitude_age_s=attitude_age_s,
    )
    drones = [drone_now(own, age_ms * 1_000_000, 0.0, 0.5) for age_ms in range(0, 600, 5)]
    assert all(drone is None or drone.attitude_known for drone in drones)
    late = drone_now(replace(own, attitude_age_s=0.49), 20_000_000, 0.0, 0.5)
    assert late is not None
    assert not late.attitude_known


def lowest_m(orientation_wxyz: tuple[float, float, float, float]) -> float:
    """By geometry: the lowest point of a ring of feet, below those of a level drone."""
    turns = np.linspace(0.0, math.tau, 3600)
    ring = [
        (TOUCHDOWN.foot_radius_m * math.cos(t), TOUCHDOWN.foot_radius_m * math.sin(t), -TOUCHDOWN.gear_height_m)
        for t in turns
    ]
    return -TOUCHDOWN.gear_height_m - min(rotate(orientation_wxyz, foot)[2] for foot in ring)


@pytest.mark.parametrize("rotation", [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, -0.5, 0.0), (0.3, 0.2, 2.0)])
def test_lowest_foot_is_that_of_the_turned_ring(rotation: tuple[float, float, float]) -> None:
    attitude = quaternion_from_roll_pitch_yaw(*rotation)
    below_m, _ = lowest_foot(drone_of(attitude, (0.0, 0.0, 0.0)), TOUCHDOWN)
    assert below_m == pytest.approx(lowest_m(attitude), abs=1e-6)


@given(rotation=st.tuples(angles_rad, angles_rad, st.floats(-3.0, 3.0)), rates=st.tuples(*(3 * [rates_rad_s])))
def test_lowest_foot_sinks_by_the_drones_turning(
    rotation: tuple[float, float, float], rates: tuple[float, float, float]
) -> None:
    attitude = quaternion_from_roll_pitch_yaw(*rotation)
    before = drone_of(attitude, rates)
    assume(before.lean > 0.01)
    later = drone_of(multiply(attitude, normalized((1.0, *(0.5 * STEP_S * rate for rate in rates)))), rates)
    (before_m, sinks_m_s), (later_m, _) = lowest_foot(before, TOUCHDOWN), lowest_foot(later, TOUCHDOWN)
    assert sinks_m_s == pytest.approx((later_m - before_m) / STEP_S, abs=1e-3)


def test_unknown_drone_has_no_lower_foot() -> None:
    assert lowest_foot(None, TOUCHDOWN) == (0.0, 0.0)
