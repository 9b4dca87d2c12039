"""An uneven driver, a winding road, a hard turn and a stop are told by the velocities that were driven.

A vehicle that has done what its late data did not let expect is landed on while it stands, or has driven evenly.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.config.estimation import EstimatorKind
from companion.core.data import VehicleEstimate
from companion.landing.memory import StepMemory
from companion.landing.waiting import waits_at_m
from companion.situation.phases import Phase
from companion.vehicle.driving import Driving, drives_unevenly, may_depart, turns_hard, winds, with_velocity
from companion.vehicle.estimator import EstimatorMemory
from companion.vehicle.surprise import Surprise, forget_beliefs, may_surprise, update_surprise
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import NOW_NS, changed, drone_at, pad_at, situation
from tests.companion.vehicle.drives import (
    NOMINAL,
    Drive,
    Sensors,
    brake,
    circle,
    drive,
    figure_eight,
    random_drive,
    straight,
)
from tests.companion.vehicle.hindsight import DESCENT, LATE, UNEVEN, Told, after
from tests.companion.vehicle.rides import estimator, now_ns
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle


def driven(speed_m_s: Callable[[float], float], until_s: float) -> Driving:
    """What is noticed of a vehicle that drives east at such a speed, told ten times a second."""
    driving = Driving()
    for i in range(round(10.0 * until_s)):
        velocity = np.array([speed_m_s(0.1 * i), 0.0, 0.0])
        driving = with_velocity(driving, NOW_NS + i * 100_000_000, velocity)
    return driving


def departing(t_s: float) -> float:
    """From 1 s on at 2 m/s^2 to 10 m/s, and evenly on."""
    return min(max(2.0 * (t_s - 1.0), 0.0), 10.0)


def test_departure_is_uneven_until_it_is_over_and_says_nothing_of_the_driver_then() -> None:
    assert driven(departing, 5.0).unevenness_m_s2 > 3.0 * UNEVEN.acceleration_m_s2
    assert driven(departing, 9.0).unevenness_m_s2 < 0.1 * UNEVEN.acceleration_m_s2


def test_changes_of_speed_after_a_departure_count() -> None:
    brakes = driven(lambda t_s: departing(t_s) - 2.0 * max(0.0, min(t_s - 9.0, 2.0)), 14.0)
    speeds_up = driven(lambda t_s: departing(t_s) + 2.0 * max(0.0, min(t_s - 9.0, 2.0)), 14.0)
    for driving in (brakes, speeds_up):
        assert driving.unevenness_m_s2 > UNEVEN.acceleration_m_s2


@pytest.mark.parametrize(("oldest_s", "late"), [(0.38, False), (0.42, True)])
def test_lateness_is_the_mean_age_however_seldom_a_receiver_tells(oldest_s: float, *, late: bool) -> None:
    surprise, found = Surprise(), set()
    for i in range(500):
        t_ns, age_s = NOW_NS + i * 20_000_000, oldest_s - 0.02 * (9 - i % 10)
        told: Any = Told(5.0, 0.01)
        newest_ns: Any = t_ns - round(age_s * 1e9)
        surprise = update_surprise(surprise, told, newest_ns, t_ns, monotonic_ns=t_ns, config=UNEVEN)
        if i > 150:
            found.add(drives_unevenly(Driving(unevenness_m_s2=0.7), surprise.lateness_s, UNEVEN))
    assert found == {late}


@pytest.mark.slow
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
    assert drives_unevenly(found.driving, LATE.delay_s, UNEVEN) is uneven
    assert not drives_unevenly(found.driving, UNEVEN.age_s, UNEVEN)
    assert not drives_unevenly(found.driving, None, UNEVEN)


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
    assert winds(found.driving, LATE.delay_s, UNEVEN) is winding
    assert not winds(found.driving, UNEVEN.age_s, UNEVEN)
    assert not winds(found.driving, None, UNEVEN)


@pytest.mark.slow
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
    assert turns_hard(found.driving, LATE.delay_s, UNEVEN) is hard
    assert not turns_hard(found.driving, UNEVEN.age_s, UNEVEN)
    assert not turns_hard(found.driving, None, UNEVEN)


def test_curve_is_over_when_the_road_is_straight_again() -> None:
    corner = drive(20.0, lambda _: 6.0, lambda t_s: 0.1 if 8.0 <= t_s < 12.0 else 0.0)
    assert turns_hard(after(corner, LATE, 1, 11.5).driving, LATE.delay_s, UNEVEN)
    assert not turns_hard(after(corner, LATE, 1, 16.0).driving, LATE.delay_s, UNEVEN)


def test_uneven_driving_is_told_from_the_last_seconds_only() -> None:
    """Speeds of 4 and 5 m/s in turn, 2 s each, and an even 5 m/s afterwards, over a fix every tenth of a second."""
    surprise, t_ns = Surprise(), NOW_NS
    for i in range(400):
        told: Any = Told(4.0 if i < 200 and i // 20 % 2 else 5.0, 0.01)
        surprise = update_surprise(surprise, told, EstimatorMemory(t_ns), t_ns, monotonic_ns=t_ns, config=UNEVEN)
        t_ns += 100_000_000
        if i == 199:
            assert surprise.driving.unevenness_m_s2 == pytest.approx(0.5, rel=0.05)
    assert surprise.driving.unevenness_m_s2 == 0.0


def test_speeds_before_and_after_an_outage_are_not_compared() -> None:
    surprise, t_ns = Surprise(), NOW_NS
    for speed_m_s in (1.0, 9.0):
        told: Any = Told(speed_m_s, 0.01)
        for _ in range(22):
            surprise = update_surprise(surprise, told, EstimatorMemory(t_ns), t_ns, monotonic_ns=t_ns, config=UNEVEN)
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
    assert may_depart(found.driving, LATE.delay_s, UNEVEN) is departs
    assert not may_depart(found.driving, UNEVEN.age_s, UNEVEN)
    assert not may_depart(found.driving, None, UNEVEN)


def test_vehicle_that_has_not_driven_is_parked() -> None:
    assert not may_depart(Driving(), LATE.delay_s, UNEVEN)
    assert not may_depart(after(straight(0.0), LATE, 3, 8.0).driving, LATE.delay_s, UNEVEN)


CONFIG = CompanionConfig()
BEGUN_S = 2.0  # until then an estimate may be surprised by what it has not known yet


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("truth", [straight(7.0), circle(5.0)], ids=["straight", "circle"])
def test_even_driving_surprises_nobody_however_late_it_is_told(truth: Drive, seed: int) -> None:
    assert (after(truth, LATE, seed, 15.0).surprised_ns or 0) < now_ns(BEGUN_S)


def braking(by_m_s2: float) -> Drive:
    """Slows down from 10 to 6 m/s after 8 s."""
    return drive(16.0, lambda t_s: min(max(10.0 - by_m_s2 * (t_s - 8.0), 6.0), 10.0), lambda _: 0.0)


@pytest.mark.parametrize(
    ("sensors", "truth", "surprises"),
    [(LATE, brake(), True), (NOMINAL, brake(), True), (NOMINAL, braking(2.0), True), (NOMINAL, braking(1.0), False)],
    ids=["hard, late", "hard", "as hard as the drone can follow late", "soft"],
)
def test_hard_brake_surprises(sensors: Sensors, truth: Drive, *, surprises: bool) -> None:
    found = after(truth, sensors, 3, truth.length_s)
    assert ((found.surprised_ns or 0) > now_ns(BEGUN_S)) is surprises


@pytest.mark.parametrize(("sensors", "surprises"), [(NOMINAL, False), (LATE, True)], ids=["fresh", "late"])
def test_hard_departure_surprises_over_late_data_only(sensors: Sensors, *, surprises: bool) -> None:
    departs = drive(14.0, lambda t_s: min(max(4.0 * (t_s - 8.0), 0.0), 8.0), lambda _: 0.0)
    found = after(departs, sensors, 3, departs.length_s)
    assert ((found.surprised_ns or 0) > now_ns(BEGUN_S)) is surprises


@pytest.mark.parametrize(
    ("off_m_s", "std_m_s", "surprises"),
    [(0.8, 0.2, True), (0.6, 0.2, False), (0.8, 0.5, False), (1.3, 0.5, True)],
    ids=["wrong", "nearly right", "vague, as was said", "wrong beyond what was said"],
)
def test_belief_surprises_by_more_than_it_was_said_to_be_off(
    off_m_s: float, std_m_s: float, *, surprises: bool
) -> None:
    told: Any = Told(5.0, 0.01)
    found = update_surprise(
        Surprise(beliefs=((NOW_NS, 5.0 + off_m_s, std_m_s),)),
        told,
        EstimatorMemory(NOW_NS),
        NOW_NS,
        monotonic_ns=NOW_NS,
        config=UNEVEN,
    )
    assert (found.surprised_ns is not None) is surprises


def test_surprise_holds_for_its_time_and_no_longer() -> None:
    surprise = Surprise(surprised_ns=NOW_NS)
    hold_ns = round(UNEVEN.hold_s * 1e9)
    assert may_surprise(surprise, NOW_NS + hold_ns - 1, UNEVEN)
    assert not may_surprise(surprise, NOW_NS + hold_ns + 1, UNEVEN)
    assert not may_surprise(Surprise(), NOW_NS, UNEVEN)


def test_beliefs_end_with_the_estimate_that_they_were() -> None:
    surprise = Surprise(beliefs=((NOW_NS, 5.0, 0.1),), speed_std_m_s=0.1, surprised_ns=NOW_NS)
    found = update_surprise(surprise, estimator(EstimatorKind.IMM), None, NOW_NS, monotonic_ns=NOW_NS, config=UNEVEN)
    assert found == Surprise(surprised_ns=NOW_NS)


@pytest.mark.parametrize(
    ("variance_m2_s2", "std_m_s"),
    [(0.04, 0.2), (4.0, math.inf), (-1e-18, 0.0)],
    ids=["known", "no longer known", "rounded below nothing"],
)
def test_speed_is_as_uncertain_as_it_is_told_and_unknown_once_it_is_lost(variance_m2_s2: float, std_m_s: float) -> None:
    told: Any = Told(5.0, variance_m2_s2)
    found = update_surprise(
        Surprise(speed_std_m_s=0.1),
        told,
        EstimatorMemory(NOW_NS - 10),
        NOW_NS,
        monotonic_ns=NOW_NS,
        config=UNEVEN,
    )
    assert found.speed_std_m_s == pytest.approx(std_m_s)


def test_surprise_outlasts_a_clock_that_is_set() -> None:
    surprise = Surprise(
        beliefs=((NOW_NS, 5.0, 0.1),),
        speed_std_m_s=0.1,
        surprised_ns=NOW_NS,
        driving=Driving(driven=((NOW_NS, 3.0, 4.0),), changes=((0.5, 0.0),), unevenness_m_s2=0.5),
    )
    kept = replace(surprise, beliefs=(), driving=Driving(unevenness_m_s2=0.5))
    assert forget_beliefs(surprise) == kept
    assert may_surprise(kept, NOW_NS, UNEVEN)
    assert forget_beliefs(Surprise()) == Surprise()


@dataclass(frozen=True)
class Braking(KnownVehicle):
    """Drives at 4 m/s as far as the data tell, and has stood in hindsight."""

    def estimate(self, memory: int | None, t_ns: int) -> VehicleEstimate | None:
        return None if memory is None else Told(4.0 if t_ns > memory else 0.0, 0.01).estimate(memory, t_ns)


@pytest.mark.parametrize("kind", [Braking, KnownVehicle])
def test_step_looks_back_at_what_it_has_believed(kind: type[KnownVehicle]) -> None:
    flight = Flight(vehicle=kind((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0)))
    flight.run(0.1)
    flight.sends_fixes = False
    flight.run(0.5)
    flight.sends_fixes = True
    flight.run(0.1)
    assert may_surprise(flight.memory.vehicle.surprise, flight.monotonic_ns, UNEVEN) is (kind is Braking)


@pytest.mark.parametrize(
    ("speed_m_s", "std_m_s", "waits"),
    [
        (DESCENT.wait.speed_m_s - 0.01, 0.05, False),
        (DESCENT.wait.speed_m_s + 0.01, 0.05, True),
        (DESCENT.wait.speed_m_s + 0.01, 0.3, False),
        (DESCENT.wait.speed_m_s + 0.01, math.inf, False),
        (CONFIG.abort.near_speed_max_m_s + 0.01, math.inf, True),
    ],
    ids=["settled", "too fast", "hardly known", "not known", "too fast by far"],
)
def test_descent_waits_until_the_drone_has_settled_as_far_as_that_is_known(
    speed_m_s: float, std_m_s: float, *, waits: bool
) -> None:
    pad = pad_at()
    here = replace(situation(0.9), drone=drone_at(0.9, 0.0, (0.6 * speed_m_s, -0.8 * speed_m_s, 0.0), pad=pad))
    memory = changed(StepMemory(), phase=Phase.DESCEND, surprise=Surprise(speed_std_m_s=std_m_s))
    assert waits_at_m(memory, here, CONFIG) == (DESCENT.wait.height_m if waits else None)


@pytest.mark.parametrize(
    ("phase", "height_m", "velocity", "surprised", "waits"),
    [
        (Phase.DESCEND, 0.9, (5.0, 1.0, 0.0), True, True),
        (Phase.DESCEND, 0.9, (5.0, 1.0, 0.0), False, False),
        (Phase.DESCEND, 0.9, (0.1, 0.1, 0.0), True, False),
        (Phase.DESCEND, 0.9 * DESCENT.commit_height_m, (5.0, 1.0, 0.0), True, False),
        (Phase.CHASE, 0.9, (5.0, 1.0, 0.0), True, False),
    ],
    ids=["drives", "has not surprised", "stands", "committed", "chase"],
)
def test_descent_waits_above_a_driving_vehicle_that_has_surprised(
    phase: Phase, height_m: float, velocity: Vector3, *, surprised: bool, waits: bool
) -> None:
    surprise = Surprise(surprised_ns=NOW_NS - 10 if surprised else None)
    memory = changed(StepMemory(), phase=phase, surprise=surprise)
    waiting_m = waits_at_m(memory, situation(height_m, pad=pad_at(velocity)), CONFIG)
    assert waiting_m == (DESCENT.wait.height_m if waits else None)
