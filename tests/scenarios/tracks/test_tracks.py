import math
from itertools import pairwise

import numpy as np
import pytest

from scenarios.catalogue.catalogue import list_scenarios, load_scenario
from scenarios.tracks.config import MovingTrack, RandomTrack
from scenarios.tracks.course import Course
from scenarios.tracks.heights import Slope
from scenarios.tracks.profiles import profile_of, waypoint_steps
from scenarios.tracks.roads import polyline, road_of
from scenarios.tracks.tracks import approach_m, course_of

SMOOTH = [entry.name for entry in list_scenarios() if not entry.name.startswith(("report_", "static"))]
DRIVEN = [name for name in SMOOTH if not name.startswith("ship_")]  # a ship passes beside the drone
CURVE = ((0.0, 0.0), (10.0, 0.0), (15.9, -1.1), (21.3, -3.5), (28.6, -8.6), (40.1, -19.8))


def course(name: str, seed: int = 3) -> Course:
    return course_of(load_scenario(name).track, np.random.default_rng(seed))


@pytest.mark.slow
@pytest.mark.parametrize("name", SMOOTH)
def test_road_points_in_the_direction_of_its_heading(name: str) -> None:
    road = course(name).road
    step_m = 1e-5
    for s_m in np.linspace(0.37, road.length_m + 11.0, 91):
        before, after = road.at(s_m - step_m), road.at(s_m + step_m)
        heading_rad = math.atan2(after.y_m - before.y_m, after.x_m - before.x_m)
        assert math.remainder(heading_rad - road.at(s_m).heading_rad, math.tau) == pytest.approx(0.0, abs=1e-5)
        assert math.hypot(after.x_m - before.x_m, after.y_m - before.y_m) == pytest.approx(2.0 * step_m, rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", DRIVEN)
def test_vehicle_passes_the_waiting_point_at_its_nominal_speed(name: str) -> None:
    track = load_scenario(name).track
    assert isinstance(track, MovingTrack)
    driven = course(name)
    point = driven.road.at(approach_m(track))
    assert (point.x_m, point.y_m, point.z_m) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    times_s = np.arange(0.0, 60.0, 0.01)
    passing_s = next(t_s for t_s in times_s if driven.profile.at(t_s).s_m >= approach_m(track))
    assert driven.profile.at(passing_s).speed_m_s == pytest.approx(track.speed_m_s, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("name", SMOOTH)
def test_speed_never_jumps_nor_turns_back(name: str) -> None:
    profile = course(name).profile
    speeds_m_s = np.array([profile.at(t_s).speed_m_s for t_s in np.arange(0.0, 150.0, 0.01)])
    assert speeds_m_s.min() >= 0.0
    assert np.abs(np.diff(speeds_m_s)).max() <= 0.04  # 4 m/s^2


def test_circle_keeps_its_radius() -> None:
    road = course("circle_5").road
    assert road.loop_s_m is not None
    for s_m in np.linspace(road.loop_s_m, road.loop_s_m + 400.0, 37):
        point = road.at(s_m)
        assert math.hypot(point.x_m, point.y_m - 20.0) == pytest.approx(20.0, abs=1e-9)


def test_figure_eight_touches_both_circles_and_closes() -> None:
    road = course("figure_eight_4").road
    assert road.loop_s_m is not None
    points = [road.at(s_m) for s_m in np.arange(road.loop_s_m, road.length_m, 0.05)]
    nearest = [min(math.hypot(p.x_m - side * 23.3, p.y_m) for p in points) for side in (1.0, -1.0)]
    assert nearest == pytest.approx([16.5, 16.5], abs=1e-9)
    assert max(p.x_m for p in points) == pytest.approx(23.3 + 16.5, abs=1e-3)
    end = road.at(road.length_m)
    assert (end.x_m, end.y_m) == pytest.approx((0.0, 0.0), abs=1e-9)
    start = road.at(road.loop_s_m)
    assert math.remainder(end.heading_rad - start.heading_rad, math.tau) == pytest.approx(0.0, abs=1e-9)


def test_figure_eight_repeats_itself() -> None:
    road = course("figure_eight_4").road
    assert road.loop_s_m is not None
    lap_m = road.length_m - road.loop_s_m
    first, third = road.at(road.loop_s_m + 31.0), road.at(road.loop_s_m + 31.0 + 2.0 * lap_m)
    assert (third.x_m, third.y_m) == pytest.approx((first.x_m, first.y_m), abs=1e-9)


@pytest.mark.parametrize("speed_m_s", [5.0, 7.0])
def test_lane_change_moves_over_by_one_lane_and_then_turns_left(speed_m_s: float) -> None:
    name = f"lane_change_{speed_m_s:.0f}"
    road = course(name).road
    behind_m = 40.0 + (1.0 + 3.0) * speed_m_s  # begun 1 s behind the waiting point
    assert road.at(behind_m + 0.01).y_m == pytest.approx(3.5, abs=1e-6)
    assert road.at(behind_m + 0.01).heading_rad == pytest.approx(0.0, abs=1e-9)
    assert road.at(road.length_m).heading_rad == pytest.approx(0.5 * math.pi, abs=1e-9)
    assert max(abs(piece.curvature_per_m) for piece in road.pieces) == pytest.approx(1.0 / 8.0)


def test_stop_and_go_stands_for_three_seconds_between_drives() -> None:
    profile = course("stop_and_go_7").profile
    motions = [profile.at(t_s) for t_s in np.arange(0.005, 45.0, 0.01)]
    assert max(motion.speed_m_s for motion in motions) == pytest.approx(7.0)
    assert {round(motion.acceleration_m_s2, 9) for motion in motions} == {1.5, 0.0, -3.0}
    standing = sum(motion.speed_m_s == 0.0 for motion in motions)
    assert standing == pytest.approx(3 * 300, abs=4)  # cycles of 15 s


def test_report_1_is_where_the_report_landed_at_its_time() -> None:
    # Ghribi 2022: lands after 11 s at x = 4.3 m, standing for the first 5 s included.
    driven = course("report_1")
    motion = driven.profile.at(10.87 - 5.0)
    assert driven.road.at(motion.s_m).x_m == pytest.approx(4.3, abs=0.02)
    assert motion.speed_m_s == pytest.approx(1.47, abs=0.01)


def test_report_3_is_where_the_report_landed_at_its_time() -> None:
    # Ghribi 2022: lands after 13.5 s at (30, -9), at 5 m/s.
    driven = course("report_3")
    motion = driven.profile.at(13.5 - 5.0)
    point = driven.road.at(motion.s_m)
    assert math.dist((point.x_m, point.y_m), (30.0, -9.0)) < 1.0
    assert motion.speed_m_s == pytest.approx(5.0)


@pytest.mark.parametrize(("name", "speed_m_s"), [("report_2", 7.0), ("report_4", 7.0), ("report_3_10", 10.0)])
def test_report_vehicle_reaches_its_last_waypoint_at_speed_and_stops_behind_it(name: str, speed_m_s: float) -> None:
    driven = course(name)
    arrival_s = next(t for t in np.arange(0.0, 60.0, 0.001) if driven.profile.at(t).s_m >= driven.road.length_m)
    assert driven.profile.at(arrival_s).speed_m_s == pytest.approx(speed_m_s, abs=0.01)
    assert driven.profile.at(arrival_s + 10.0).speed_m_s == 0.0


def test_polyline_passes_its_waypoints() -> None:
    road = polyline(CURVE)
    s_m = 0.0
    for before, after in pairwise(CURVE):
        s_m += math.dist(before, after)
        point = road.at(s_m)
        assert (point.x_m, point.y_m) == pytest.approx(after, abs=1e-9)


def test_waypoint_steps_reach_the_speed_at_the_distance() -> None:
    profile = profile_of(waypoint_steps([10.0, 6.0], [0.0, 5.0, 7.0]))
    assert (profile.at(4.0).s_m, profile.at(4.0).speed_m_s) == pytest.approx((10.0, 5.0))
    assert (profile.at(5.0).s_m, profile.at(5.0).speed_m_s) == pytest.approx((16.0, 7.0))


@pytest.mark.slow
def test_random_acceleration_across_has_the_variance_and_the_memory_of_its_process() -> None:
    track = RandomTrack(kind="random", speed_m_s=7.0, road_s=400.0)
    variance, lagged, count = 0.0, 0.0, 8
    for seed in range(count):
        driven = course_of(track, np.random.default_rng(seed))
        speeds_m_s = np.array([leg.speed_m_s for leg in driven.profile.legs[2:-2]])
        across_m_s2 = np.array([piece.curvature_per_m for piece in driven.road.pieces[1:]]) * speeds_m_s**2
        variance += float(np.mean(across_m_s2**2)) / count
        lagged += float(np.mean(across_m_s2[300:] * across_m_s2[:-300])) / count
    assert math.sqrt(variance) == pytest.approx(0.8, rel=0.1)
    assert lagged / variance == pytest.approx(math.exp(-1.0), abs=0.1)


@pytest.mark.slow
def test_random_speed_stays_in_its_band() -> None:
    for seed in range(5):
        legs = course("random_5", seed).profile.legs[2:-2]
        assert min(leg.speed_m_s for leg in legs) >= 2.5
        assert max(leg.speed_m_s for leg in legs) <= 7.5


@pytest.mark.slow
def test_random_course_is_decided_by_its_seed() -> None:
    assert course("random_5", 4) == course("random_5", 4)
    assert course("random_5", 4).road != course("random_5", 5).road


def test_brake_height_is_drawn_for_each_seed() -> None:
    heights_m = [event.height_above_roof_m for seed in range(20) if (event := course("brake_7", seed).brake)]
    assert len(heights_m) == 20
    assert len(set(heights_m)) == 20
    assert 0.4 <= min(heights_m) < max(heights_m) <= 1.6


def test_slope_is_the_integral_of_its_grade() -> None:
    slope = Slope(grade=0.05, start_s_m=40.0, transition_m=10.0)
    for s_m in (20.0, 43.0, 49.9, 77.0):
        step_m = 1e-4
        rise = (slope.at(s_m + step_m)[0] - slope.at(s_m - step_m)[0]) / (2.0 * step_m)
        assert rise == pytest.approx(slope.at(s_m)[1], abs=1e-9)
    assert slope.at(140.0)[0] == pytest.approx(0.05 * 95.0)


def test_road_without_length_is_refused() -> None:
    with pytest.raises(ValueError, match="positive length"):
        road_of([(10.0, 0.0), (0.0, 0.1)])


def test_profile_that_would_drive_backwards_is_refused() -> None:
    with pytest.raises(ValueError, match="backwards"):
        profile_of([(1.0, 1.0), (2.0, -1.0)])
