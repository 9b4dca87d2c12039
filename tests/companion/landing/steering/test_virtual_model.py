"""The virtual model: the drone beside it, how far it may sink, and the setpoint that asks for it."""

import math

import numpy as np
import pytest

from companion.autopilots.px4 import Px4Driver
from companion.core.data import GRAVITY_M_S2, OwnState
from companion.landing.steering.virtual_model import (
    NO_RIDE,
    Tracking,
    add_to_past,
    press_down,
    setpoint_at,
    update_ride,
    update_tracking,
)
from companion.planning.guidance import ReferenceState
from link.messages import Quaternion
from link.records import replace
from tests.companion.world import response_of

STEP_NS = 20_000_000
LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)
RESPONSE = response_of(Px4Driver())


def _state(t_s: float, speed_m_s: float) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array([speed_m_s * t_s, 0.3, 4.0]),
        velocity_enu_m_s=np.array([speed_m_s, 0.0, 0.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )


def _own(t_ns: int, x: float, speed_m_s: float = 5.0, orientation_wxyz: Quaternion = LEVEL) -> OwnState:
    return OwnState(
        t_ns=t_ns,
        position_enu_m=(x, 0.3, 4.0),
        velocity_enu_m_s=(speed_m_s, 0.0, 0.0),
        orientation_wxyz=orientation_wxyz,
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def _fly_behind(lag_m: float, steps: int, *, estimates: bool = True) -> Tracking:
    """The drone stays `lag_m` behind the model and reports 47 ms late."""
    tracking = Tracking()
    for i in range(1, steps):
        t_ns = i * STEP_NS
        tracking = add_to_past(tracking, t_ns, _state(t_ns * 1e-9, 5.0))
        reported_ns = t_ns - 2 * STEP_NS - 7_000_000
        if reported_ns > 0:
            own = _own(reported_ns, 5.0 * reported_ns * 1e-9 - lag_m)
            tracking = update_tracking(tracking, reported_ns, own, RESPONSE, estimates=estimates)
    return tracking


def test_drone_is_compared_with_the_model_at_the_time_of_its_report() -> None:
    tracking = _fly_behind(0.4, 200)
    np.testing.assert_allclose(tracking.error_m, 0.4, atol=1e-6)


def test_lasting_deviation_is_estimated() -> None:
    np.testing.assert_allclose(_fly_behind(0.4, 500).deviation[:2, 0], [-0.4, 0.0], atol=0.1)


def test_nothing_is_estimated_of_a_drone_that_does_not_fly_freely() -> None:
    assert not np.any(_fly_behind(0.4, 200, estimates=False).deviation)


def test_deviation_is_what_the_next_report_shows_after_a_break() -> None:
    tracking = _fly_behind(0.4, 200)
    assert tracking.compared_ns is not None
    for i in range(200, 240):
        tracking = add_to_past(tracking, i * STEP_NS, _state(i * STEP_NS * 1e-9, 5.0))
    t_ns = 238 * STEP_NS
    tracking = update_tracking(tracking, t_ns, _own(t_ns, 5.0 * t_ns * 1e-9 + 0.7, 5.3), RESPONSE, estimates=True)
    np.testing.assert_allclose(tracking.deviation[:2], [[0.7, 0.0], [0.3, 0.0]], atol=1e-6)
    assert not np.any(tracking.deviation[2:])


def test_report_that_was_compared_changes_nothing() -> None:
    tracking = _fly_behind(0.4, 200)
    assert tracking.compared_ns is not None
    again = _own(tracking.compared_ns, 0.0)
    assert update_tracking(tracking, tracking.compared_ns, again, RESPONSE, estimates=True) is tracking


@pytest.mark.parametrize("lean_rad", [0.21, -0.13])
def test_drone_that_leans_on_a_steady_path_holds_against_the_air(lean_rad: float) -> None:
    leaning = (math.cos(lean_rad / 2.0), 0.0, math.sin(lean_rad / 2.0), 0.0)  # nose down: thrust forwards
    tracking = Tracking()
    for i in range(1, 400):
        tracking = add_to_past(tracking, i * STEP_NS, _state(i * STEP_NS * 1e-9, 5.0))
        own = _own(i * STEP_NS, 5.0 * i * STEP_NS * 1e-9, 5.0, leaning)
        tracking = update_tracking(tracking, i * STEP_NS, own, RESPONSE, estimates=True)
    np.testing.assert_allclose(tracking.air_enu_m_s2, [GRAVITY_M_S2 * math.tan(lean_rad), 0.0], atol=1e-3)


@pytest.mark.parametrize("rising_m_s2", [-2.0, 1.5])
def test_drone_that_speeds_up_as_it_sinks_leans_more_for_the_same_thrust_across(rising_m_s2: float) -> None:
    air_m_s2 = 3.0
    lean_rad = math.atan(air_m_s2 / (GRAVITY_M_S2 + rising_m_s2))
    leaning = (math.cos(lean_rad / 2.0), 0.0, math.sin(lean_rad / 2.0), 0.0)
    tracking = Tracking()
    for i in range(1, 400):
        t_s = i * STEP_NS * 1e-9
        tracking = add_to_past(tracking, i * STEP_NS, _state(t_s, 5.0))
        own = replace(_own(i * STEP_NS, 5.0 * t_s, 5.0, leaning), velocity_enu_m_s=(5.0, 0.0, rising_m_s2 * t_s))
        tracking = update_tracking(tracking, i * STEP_NS, own, RESPONSE, estimates=True)
    np.testing.assert_allclose(tracking.air_enu_m_s2, [air_m_s2, 0.0], atol=2e-3)


def test_drone_that_leans_as_its_path_accelerates_holds_against_nothing() -> None:
    speeding_m_s2 = 2.0
    lean_rad = math.atan(speeding_m_s2 / GRAVITY_M_S2)
    leaning = (math.cos(lean_rad / 2.0), 0.0, math.sin(lean_rad / 2.0), 0.0)
    tracking = Tracking()
    for i in range(1, 200):
        t_s = i * STEP_NS * 1e-9
        state = replace(
            _state(t_s, speeding_m_s2 * t_s), position_enu_m=np.array([0.5 * speeding_m_s2 * t_s**2, 0.3, 4.0])
        )
        tracking = add_to_past(tracking, i * STEP_NS, state)
        own = _own(i * STEP_NS, 0.5 * speeding_m_s2 * t_s**2, speeding_m_s2 * t_s, leaning)
        tracking = update_tracking(tracking, i * STEP_NS, own, RESPONSE, estimates=True)
    np.testing.assert_allclose(tracking.air_enu_m_s2, 0.0, atol=1e-6)
    np.testing.assert_allclose(tracking.holds_enu_m_s2, 0.0, atol=1e-6)


def test_drone_that_leans_to_come_back_to_its_path_holds_more_than_against_the_air() -> None:
    back_m_s2 = -0.8  # it is ahead of its path, and slows down
    lean_rad = math.atan(back_m_s2 / GRAVITY_M_S2)
    leaning = (math.cos(lean_rad / 2.0), 0.0, math.sin(lean_rad / 2.0), 0.0)
    tracking = Tracking()
    for i in range(1, 100):
        t_s = i * STEP_NS * 1e-9
        tracking = add_to_past(tracking, i * STEP_NS, _state(t_s, 5.0))
        own = _own(i * STEP_NS, 5.0 * t_s, 5.0 + back_m_s2 * t_s, leaning)
        tracking = update_tracking(tracking, i * STEP_NS, own, RESPONSE, estimates=True)
    np.testing.assert_allclose(tracking.air_enu_m_s2, 0.0, atol=1e-3)
    np.testing.assert_allclose(tracking.holds_enu_m_s2, [back_m_s2, 0.0], atol=1e-3)


def test_setpoint_is_the_model() -> None:
    setpoint = setpoint_at(_state(2.0, 5.0), 50_000_000, 0.3, position_only=False)
    assert setpoint.position_enu_m == (10.0, 0.3, 4.0)
    assert setpoint.velocity_enu_m_s == (5.0, 0.0, 0.0)
    assert setpoint_at(_state(2.0, 5.0), 0, 0.3, position_only=True).velocity_enu_m_s is None


def test_model_that_is_pressed_falls_as_if_nothing_held_it() -> None:
    level = _state(2.0, 5.0)
    pressed = press_down(level, 9.0, 0.13)
    np.testing.assert_allclose(level.position_enu_m - pressed.position_enu_m, [0.0, 0.0, 0.5 * 9.0 * 0.13**2])
    np.testing.assert_allclose(pressed.velocity_enu_m_s, [5.0, 0.0, -9.0 * 0.13])
    np.testing.assert_allclose(pressed.acceleration_enu_m_s2, [0.0, 0.0, -9.0])


def test_ride_is_the_first_comparison_and_goes_over_to_later_ones_within_half_a_second() -> None:
    ride = update_ride(NO_RIDE, 0, 0.1, 0.0)
    assert ride.above_m == 0.1
    for step in range(1, 26):
        ride = update_ride(ride, step * STEP_NS, -0.1, 0.0)
    assert ride.above_m == pytest.approx(-0.1 + 0.2 * math.exp(-1.0))


@pytest.mark.parametrize("above_m", [-3.0, 3.0])
def test_ride_is_no_more_than_a_lag_makes(above_m: float) -> None:
    assert abs(update_ride(NO_RIDE, 0, above_m, 0.0).above_m) == pytest.approx(0.3 * 0.5)
