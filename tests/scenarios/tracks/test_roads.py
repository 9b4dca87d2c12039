import math
from itertools import accumulate, pairwise

import numpy as np
import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.tracks.roads import curve_through
from scenarios.tracks.tracks import course_of

REPORT_ROAD = ((0.0, 0.0), (10.0, 0.0), (15.9, -1.1), (21.3, -3.5), (28.6, -8.6), (40.1, -19.8))


def test_curve_passes_its_waypoints_at_the_lengths_that_it_tells() -> None:
    road, lengths_m = curve_through(REPORT_ROAD)
    places = [road.at(s_m) for s_m in accumulate(lengths_m, initial=0.0)]
    passed = np.array([(place.x_m, place.y_m) for place in places])
    np.testing.assert_allclose(passed, REPORT_ROAD, atol=2e-4)


def test_curve_through_points_of_a_circle_is_about_as_long_as_its_arc() -> None:
    points = [(20.0 * math.sin(a), 20.0 - 20.0 * math.cos(a)) for a in np.linspace(0.0, 1.3, 14)]
    road, lengths_m = curve_through(points)
    assert sum(lengths_m) == pytest.approx(road.length_m, rel=1e-12)
    assert road.length_m == pytest.approx(26.0, rel=1e-3)
    middle = road.at(13.0)
    assert 1.0 / middle.curvature_per_m == pytest.approx(20.0, rel=0.01)


def test_curve_through_two_points_is_straight() -> None:
    road, lengths_m = curve_through([(3.0, 1.0), (7.0, 4.0)])
    assert lengths_m == pytest.approx([5.0])
    assert road.at(2.5).heading_rad == pytest.approx(math.atan2(3.0, 4.0))
    assert road.at(2.5).curvature_per_m == pytest.approx(0.0, abs=1e-12)


def test_curve_never_turns_sharper_than_a_car_at_10_m_s_can() -> None:
    road, _ = curve_through(REPORT_ROAD)
    sharpest = max(abs(road.at(s_m).curvature_per_m) for s_m in np.linspace(0.0, road.length_m, 500))
    assert 10.0**2 * sharpest < 0.5 * 9.81


@pytest.mark.parametrize("waypoints", [[(0.0, 0.0)], [(0.0, 0.0), (1.0, 0.0), (1.0, 0.0)]])
def test_curve_refuses_waypoints_that_are_no_way(waypoints: list[tuple[float, float]]) -> None:
    with pytest.raises(ValueError, match="needs two waypoints"):
        curve_through(waypoints)


def test_report_scenario_3_drives_at_5_m_s_from_its_second_waypoint_on() -> None:
    course = course_of(load_scenario("report_3").track, np.random.default_rng(1))
    lengths_m = curve_through(REPORT_ROAD)[1]
    arrives_s = 2.0 * lengths_m[0] / 5.0
    for t_s in np.linspace(arrives_s, arrives_s + sum(lengths_m[1:]) / 5.0, 20):
        assert course.profile.at(float(t_s)).speed_m_s == pytest.approx(5.0)
    headings = [course.road.at(s_m).heading_rad for s_m in np.arange(0.0, course.road.length_m, 0.1)]
    assert max(abs(after - before) for before, after in pairwise(headings)) < math.radians(0.5)
