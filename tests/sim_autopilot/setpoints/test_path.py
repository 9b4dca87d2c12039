from itertools import pairwise
from math import hypot, sqrt

import pytest

from sim_autopilot.core.limits import PathLimits
from sim_autopilot.core.parameters import default_values
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.setpoints.path import (
    Blocked,
    Motion,
    carry_on,
    correction_speed,
    lead_to_position,
    lead_to_velocity,
    square_root_law,
    straight_speed,
)

DT_S = 0.01


def limits() -> PathLimits:
    path = ARDUPILOT.parameters.settings(default_values(ARDUPILOT.parameters.table, {})).path
    assert path is not None
    return path


def led(path: Motion, target: Motion, duration_s: float) -> list[Motion]:
    path_limits, motions = limits(), []
    for _ in range(round(duration_s / DT_S)):
        path = carry_on(
            lead_to_position(path, target, path_limits, straight_speed(path, target.position, path_limits), DT_S), DT_S
        )
        motions.append(path)
    return motions


def test_the_square_root_law_is_smooth_where_its_two_parts_meet() -> None:
    slope, limit = 2.0, 3.0
    knee = limit / slope**2
    assert square_root_law(knee, slope, limit, DT_S) == pytest.approx(square_root_law(knee + 1e-9, slope, limit, DT_S))
    assert square_root_law(-4.0, slope, limit, DT_S) == -square_root_law(4.0, slope, limit, DT_S)
    assert square_root_law(4.0, slope, limit, DT_S) == pytest.approx(sqrt(2.0 * limit * (4.0 - 0.5 * knee)))


def test_one_step_of_the_square_root_law_never_overshoots() -> None:
    assert square_root_law(1e-3, 500.0, 1e6, DT_S) * DT_S <= 1e-3


def test_a_path_to_a_place_arrives_there_inside_its_limits() -> None:
    goal = Motion(position=(37.0, -11.0, 4.0))
    motions = led(Motion(position=(0.0, 0.0, 10.0)), goal, 30.0)
    bounds = limits()
    assert motions[-1].position == pytest.approx(goal.position, abs=0.01)
    assert max(m.position[0] for m in motions) < 37.25
    assert max(hypot(*m.velocity[:2]) for m in motions) <= bounds.speed_m_s + 1e-6
    assert max(-m.velocity[2] for m in motions) <= bounds.descent_m_s + 1e-6
    assert max(hypot(*m.acceleration[:2]) for m in motions) <= bounds.acceleration_m_s2 + 1e-6
    for one, two in pairwise(motions):
        jerk = hypot(*(b - a for a, b in zip(one.acceleration[:2], two.acceleration[:2], strict=True))) / DT_S
        assert jerk <= bounds.jerk_m_s3 + 1e-6


@pytest.mark.slow
def test_a_velocity_that_is_given_is_not_limited_by_the_speed_of_corrections() -> None:
    fast = Motion(position=(0.0, 0.0, 0.0), velocity=(14.0, 0.0, -4.0))
    path = Motion(position=(0.0, 0.0, 0.0))
    for _ in range(1500):
        path = carry_on(lead_to_velocity(path, fast, limits(), DT_S), DT_S)
    assert path.velocity == pytest.approx((14.0, 0.0, -4.0), abs=0.01)


def test_a_path_does_not_run_on_where_the_drone_cannot_follow() -> None:
    path = Motion(position=(5.0, 0.0, 0.0), velocity=(8.0, 0.0, 0.0), acceleration=(1.0, 0.5, 0.0))
    blocked = Blocked(direction=(0.5, 0.0), position=(0.0, 0.0, 0.0), velocity=(8.0, 0.0, 0.0))
    after = carry_on(path, DT_S, blocked)
    assert after.position[0] == path.position[0]
    assert after.velocity[0] == path.velocity[0]
    backwards = carry_on(path, DT_S, Blocked(direction=(-0.5, 0.0), position=(0.0,) * 3, velocity=(8.0, 0.0, 0.0)))
    assert backwards == carry_on(path, DT_S)


def test_corrections_beside_a_velocity_keep_to_the_waypoint_speeds() -> None:
    speed = correction_speed(limits())
    assert (speed.horizontal_m_s, speed.climb_m_s, speed.descent_m_s) == (10.0, 2.5, 1.5)
