import math
from collections.abc import Callable

import numpy as np
import pytest

from sim_autopilot.control.geometric import MOTOR_POLE_RAD_S, PLACE_POLE_RAD_S, fill_wanted_attitude, geometric_gains
from sim_autopilot.control.lqr import measured_step
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.core.limits import Envelope
from sim_autopilot.plant.config import PlantConfig
from tests.sim_autopilot.flights import flown, going, holding, hovering

CONFIG = PlantConfig()
START = (0.0, 0.0, 20.0)
HEADING = np.array([math.cos(0.3), math.sin(0.3), 0.0])


def always(wind: Array) -> Callable[[float], Array]:
    return lambda _: wind


def ramp(speed_m_s: float, acceleration_m_s2: float) -> Callable[[float], Reference]:
    ramp_s = speed_m_s / acceleration_m_s2

    def reference_at(t_s: float) -> Reference:
        rising = min(t_s, ramp_s)
        along = 0.5 * acceleration_m_s2 * rising**2 + speed_m_s * (t_s - rising)
        slope = acceleration_m_s2 if t_s < ramp_s else 0.0
        return going(HEADING * along + START, HEADING * acceleration_m_s2 * rising, HEADING * slope)

    return reference_at


def circle(radius_m: float, speed_m_s: float) -> Callable[[float], Reference]:
    """A circle entered at rest; the angle's rate rises for 8 s."""
    rate = speed_m_s / radius_m

    def reference_at(t_s: float) -> Reference:
        rising = min(t_s, 8.0)
        angle = rate * (rising**2 / 16.0 + t_s - rising)
        turning = rate * rising / 8.0
        along, inwards = (
            np.array([math.cos(angle), math.sin(angle), 0]),
            np.array([-math.sin(angle), math.cos(angle), 0]),
        )
        centre = np.array([0.0, radius_m, 20.0])
        slope = rate / 8.0 if t_s < 8.0 else 0.0
        acceleration = radius_m * (slope * along + turning**2 * inwards)
        return going(centre - radius_m * inwards, radius_m * turning * along, acceleration, angle, turning)

    return reference_at


def test_gains_put_the_poles_where_the_docstring_says() -> None:
    gains = geometric_gains()
    c, kp, kv, kr, kw = MOTOR_POLE_RAD_S, gains.position[0], gains.velocity[0], gains.attitude[0], gains.rate[0]
    poles = np.sort(np.roots([1, c, c * kw, c * kr, c * kr * kv, c * kr * kp]).real)[::-1]
    np.testing.assert_allclose(poles[:2], -PLACE_POLE_RAD_S, rtol=1e-3)
    np.testing.assert_allclose(poles[2:], -(c - 2 * PLACE_POLE_RAD_S) / 3, rtol=1e-3)
    assert poles.sum() == pytest.approx(-c)


def test_wanted_attitude_is_a_rotation_with_its_thrust_along_the_force_and_its_nose_on_the_heading() -> None:
    force, heading = np.array([3.0, -2.0, 8.0]), 2.2
    out = np.empty(9)
    fill_wanted_attitude.py_func(force, heading, out)
    R = out.reshape(3, 3)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R[:, 2], force / np.linalg.norm(force))
    assert R[:2, 0] @ [-math.sin(heading), math.cos(heading)] == pytest.approx(0.0, abs=1e-12)
    assert R[:2, 0] @ [math.cos(heading), math.sin(heading)] > 0.0


@pytest.mark.parametrize(("axis", "yaw"), [(0, 1.2), (1, -2.5), (2, 0.0)])
def test_unit_steps_settle_in_1_5_s_with_2_percent_overshoot(axis: int, yaw: float) -> None:
    goal = np.array(START)
    goal[axis] += 1.0
    flight = flown(CONFIG, hovering(CONFIG, START, yaw), lambda _: holding(goal, yaw), 6.0)
    response = measured_step(flight.t_s, flight.position_m[:, axis] - START[axis])
    assert response.settling_s <= 1.5
    assert response.overshoot <= 0.02


@pytest.mark.parametrize("wind", [(-4.0, -3.0, 0.0), (-3.0, 4.0, 0.0)])
def test_ramps_of_3_m_s2_to_20_m_s_are_tracked(wind: tuple[float, float, float]) -> None:
    blowing = always(np.array(wind))
    settled = flown(CONFIG, hovering(CONFIG, START), lambda _: holding(START), 6.0, wind_at=blowing)
    flight = flown(CONFIG, settled.end, ramp(20.0, 3.0), 20.0, wind_at=blowing)
    assert flight.error_m().max() < 0.15
    assert flight.error_m(15.0).max() < 0.03
    assert np.abs(flight.position_m[:, 2] - 20.0).max() < 0.1


def test_circle_of_the_competition_is_tracked_at_7_m_s() -> None:
    flight = flown(CONFIG, hovering(CONFIG, START), circle(16.5, 7.0), 25.0, wind_at=always(np.array((5.0, 0.0, 0.0))))
    assert flight.error_m(10.0).max() < 0.15


def test_hundred_metres_are_flown_without_overshoot_or_sinking() -> None:
    flight = flown(CONFIG, hovering(CONFIG, START), lambda _: holding((100, 40, 20)), 30.0)
    assert (flight.position_m[:, 0] - 100.0).max() < 0.1
    assert np.abs(flight.position_m[:, 2] - 20.0).max() < 0.3
    assert flight.error_m(25.0).max() < 0.01


def test_chase_at_15_m_s_from_100_m_behind_catches_up() -> None:
    chase = flown(
        CONFIG,
        hovering(CONFIG, START),
        lambda t: going((100 + 15 * t, 0, 20), (15, 0, 0), (0, 0, 0)),
        35.0,
        wind_at=always(np.array([-5.0, 5.0, 0.0])),
    )
    assert chase.error_m(30.0).max() < 0.03


def test_envelope_bounds_speed_climb_descent_and_tilt() -> None:
    envelope = Envelope(
        speed_max_m_s=12.0, climb_max_m_s=3.0, descent_max_m_s=1.5, braking_m_s2=6.0, tilt_max_rad=math.radians(25)
    )
    config = PlantConfig(envelope=envelope)
    up = flown(config, hovering(config, START), lambda _: holding((300, -80, 60)), 20.0)
    down = flown(config, hovering(config, (0, 0, 60)), lambda _: holding(START), 20.0)
    assert np.linalg.norm(up.velocity_m_s[:, :2], axis=1).max() < 12.2
    assert up.velocity_m_s[:, 2].max() < 3.1
    assert down.velocity_m_s[:, 2].min() > -1.6
    assert up.tilt_rad.max() < math.radians(27)


def test_velocity_alone_is_flown_without_lasting_error() -> None:
    flight = flown(
        CONFIG,
        hovering(CONFIG, START),
        lambda _: going(None, (6.0, -2.0, 0.5)),
        8.0,
        wind_at=always(np.array([-5.0, 0.0, 0.0])),
    )
    np.testing.assert_allclose(flight.velocity_m_s[-1], [6.0, -2.0, 0.5], atol=0.01)


@pytest.mark.parametrize(("start_m", "goal_m"), [(60.0, 20.0), (20.0, 60.0)])
def test_forty_metres_of_height_are_flown_without_overshoot(start_m: float, goal_m: float) -> None:
    flight = flown(CONFIG, hovering(CONFIG, (0, 0, start_m)), lambda _: holding((0, 0, goal_m)), 20.0)
    beyond = (flight.position_m[:, 2] - goal_m) * math.copysign(1.0, goal_m - start_m)
    assert beyond.max() < 0.05
    assert flight.position_m[-1, 2] == pytest.approx(goal_m, abs=1e-3)


def test_sudden_velocity_aside_and_down_does_not_overshoot_the_descent_limit() -> None:
    config = PlantConfig(envelope=Envelope(speed_max_m_s=4.0, descent_max_m_s=1.5))
    flight = flown(config, hovering(config, (0, 0, 40)), lambda _: going(None, (9.0, 0.0, -4.0)), 5.0)
    assert flight.velocity_m_s[:, 2].min() > -1.5 * 1.15
    assert flight.velocity_m_s[:, 0].max() < 4.0 * 1.1


def test_setpoint_that_is_held_with_its_acceleration_downwards_is_not_fallen_below() -> None:
    # Real position loops are off by v / kp + a / (kp kv) then: 0.7 / 1.0 + 2.9 / 4.0 m with PX4's vertical gains.
    held = going((0.0, 0.0, 5.0), (0.8, 0.0, -0.7), (4.1, 0.2, -2.9))
    flight = flown(CONFIG, hovering(CONFIG, (0.0, 0.0, 5.0)), lambda _: held, 3.0)
    assert flight.position_m[:, 2].min() > 5.0 - 0.7 / 1.0 - 2.9 / 4.0
    assert abs(flight.velocity_m_s[-1, 2]) < 0.05


def test_no_heading_keeps_the_present_one() -> None:
    flight = flown(CONFIG, hovering(CONFIG, START, yaw=0.9), lambda _: going((5, 3, 20), yaw=None), 6.0)
    np.testing.assert_allclose(flight.yaw_rad, 0.9, atol=0.1)
    assert flight.yaw_rad[-1] == pytest.approx(0.9, abs=0.001)


def test_heading_turns_the_short_way_at_60_degrees_a_second() -> None:
    flight = flown(CONFIG, hovering(CONFIG, START, yaw=2.5), lambda _: holding(START, -2.5), 4.0)
    yaw = np.unwrap(np.concatenate([[2.5], flight.yaw_rad]))
    rate = np.diff(yaw) / 0.01
    assert yaw[-1] == pytest.approx(2.0 * math.pi - 2.5, abs=0.01)
    assert rate.max() < 1.3 * math.radians(60)
    assert flight.error_m().max() < 0.05


def test_heading_rate_alone_turns_steadily() -> None:
    flight = flown(CONFIG, hovering(CONFIG, START), lambda _: going(START, yaw=None, rate=0.5), 10.0)
    rate = np.diff(np.unwrap(flight.yaw_rad)) / 0.01
    np.testing.assert_allclose(rate[-200:], 0.5, atol=0.01)


def test_flight_does_not_depend_on_the_heading() -> None:
    offset = np.array([3.0, 1.0, 0.5])
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ offset
    there = flown(CONFIG, hovering(CONFIG, START, 0.3), lambda _: holding(START + offset, 0.3), 4.0)
    also = flown(
        CONFIG, hovering(CONFIG, START, 0.3 + math.pi / 2), lambda _: holding(START + turned, 0.3 + math.pi / 2), 4.0
    )
    np.testing.assert_allclose(also.position_m[:, 1], there.position_m[:, 0], atol=1e-9)
    np.testing.assert_allclose(also.position_m[:, 0], -there.position_m[:, 1], atol=1e-9)
