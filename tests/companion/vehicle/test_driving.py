"""An uneven driver, a winding road, a hard turn and a stop are told by the velocities that were driven."""

import math
from dataclasses import replace
from typing import Any

import pytest

from companion.vehicle.driving import Driving, drives_unevenly, may_depart, turns_hard, winds
from companion.vehicle.estimator import EstimatorMemory
from companion.vehicle.surprise import Surprise, update_surprise
from tests.companion.facts import NOW_NS
from tests.companion.vehicle.drives import (
    Drive,
    circle,
    drive,
    figure_eight,
    random_drive,
    straight,
)
from tests.companion.vehicle.hindsight import DESCENT, LATE, Told, after


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    ("truth", "uneven"),
    [(straight(7.0), False), (circle(5.0), False), (random_drive(1), True), (random_drive(2), True)],
    ids=["straight", "circle", "uneven", "uneven as well"],
)
def test_driver_who_changes_speed_time_and_again_is_told_from_an_even_one(
    truth: Drive, seed: int, *, uneven: bool
) -> None:
    found = after(truth, LATE, seed, 18.0)
    assert drives_unevenly(found.driving, LATE.delay_s, DESCENT) is uneven
    assert not drives_unevenly(found.driving, DESCENT.uneven_age_s, DESCENT)
    assert not drives_unevenly(found.driving, None, DESCENT)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    ("truth", "winding"),
    [
        (straight(7.0), False),
        (circle(8.0), False),
        (figure_eight(4.17), False),
        (figure_eight(7.0), True),
        (random_drive(1), False),
    ],
    ids=["straight", "circle", "slow bends", "fast bends", "uneven"],
)
def test_road_that_bends_hard_one_way_and_the_other_is_told_from_a_circle(
    truth: Drive, seed: int, *, winding: bool
) -> None:
    found = after(truth, LATE, seed, 18.0)
    assert winds(found.driving, LATE.delay_s, DESCENT) is winding
    assert not winds(found.driving, DESCENT.uneven_age_s, DESCENT)
    assert not winds(found.driving, None, DESCENT)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["left", "right"])
@pytest.mark.parametrize(
    ("speed_m_s", "radius_m", "hard"),
    [(7.0, math.inf, False), (5.0, 20.0, False), (6.0, 20.0, False), (8.0, 20.0, True), (5.0, 8.0, True)],
    ids=["straight", "1.25 m/s^2", "1.8 m/s^2", "3.2 m/s^2", "a junction"],
)
def test_curve_in_which_the_drone_leans_far_is_told_over_late_data_only(
    speed_m_s: float, radius_m: float, side: float, seed: int, *, hard: bool
) -> None:
    curve = drive(18.0, lambda _: speed_m_s, lambda _: side / radius_m)
    found = after(curve, LATE, seed, 18.0)
    assert turns_hard(found.driving, LATE.delay_s, DESCENT) is hard
    assert not turns_hard(found.driving, DESCENT.uneven_age_s, DESCENT)
    assert not turns_hard(found.driving, None, DESCENT)


def test_curve_is_over_when_the_road_is_straight_again() -> None:
    corner = drive(20.0, lambda _: 6.0, lambda t_s: 0.1 if 8.0 <= t_s < 12.0 else 0.0)
    assert turns_hard(after(corner, LATE, 1, 11.5).driving, LATE.delay_s, DESCENT)
    assert not turns_hard(after(corner, LATE, 1, 16.0).driving, LATE.delay_s, DESCENT)


def test_uneven_driving_is_told_from_the_last_seconds_only() -> None:
    """Speeds of 4 and 5 m/s in turn, 2 s each, and an even 5 m/s afterwards, over a fix every tenth of a second."""
    surprise, t_ns = Surprise(), NOW_NS
    for i in range(400):
        told: Any = Told(4.0 if i < 200 and i // 20 % 2 else 5.0, 0.01)
        surprise = update_surprise(surprise, told, EstimatorMemory(t_ns), t_ns, monotonic_ns=t_ns, config=DESCENT)
        t_ns += 100_000_000
        if i == 199:
            assert surprise.driving.unevenness_m_s2 == pytest.approx(0.5, rel=0.05)
    assert surprise.driving.unevenness_m_s2 == 0.0


def test_speeds_before_and_after_an_outage_are_not_compared() -> None:
    surprise, t_ns = Surprise(), NOW_NS
    for speed_m_s in (1.0, 9.0):
        told: Any = Told(speed_m_s, 0.01)
        for _ in range(22):
            surprise = update_surprise(surprise, told, EstimatorMemory(t_ns), t_ns, monotonic_ns=t_ns, config=DESCENT)
            t_ns += 100_000_000
        t_ns, surprise = t_ns + 10_000_000_000, replace(surprise, beliefs=())
    assert len(surprise.driving.driven) == 42
    assert surprise.driving.unevenness_m_s2 == 0.0


STOP_S = 10.0 + 10.0 / 6.0
"""When `brake` stands."""


@pytest.mark.parametrize(
    ("until_s", "departs"),
    [(9.0, True), (STOP_S + 1.5, True), (STOP_S + 3.5, True), (STOP_S + 6.0, False)],
    ids=["drives", "has stopped", "stands for as long as a bus", "parks"],
)
def test_vehicle_that_has_just_stopped_may_depart_before_that_is_told(until_s: float, *, departs: bool) -> None:
    stays = drive(20.0, lambda t_s: min(max(10.0 - 6.0 * (t_s - 10.0), 0.0), 10.0), lambda _: 0.0)
    found = after(stays, LATE, 3, until_s)
    assert may_depart(found.driving, LATE.delay_s, DESCENT) is departs
    assert not may_depart(found.driving, DESCENT.uneven_age_s, DESCENT)
    assert not may_depart(found.driving, None, DESCENT)


def test_vehicle_that_has_not_driven_is_parked() -> None:
    assert not may_depart(Driving(), LATE.delay_s, DESCENT)
    assert not may_depart(after(straight(0.0), LATE, 3, 8.0).driving, LATE.delay_s, DESCENT)
