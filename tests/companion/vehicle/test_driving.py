"""How a vehicle has driven is told by the velocities that were driven, looked back at once its data are there."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind
from companion.core.data import VehicleEstimate
from companion.vehicle.estimator import EstimatorMemory
from companion.vehicle.hindsight import (
    CLIMB_AHEAD_S,
    Awaited,
    Driving,
    Hindsight,
    forget_instants,
    update_hindsight,
    with_velocity,
)
from link.records import replace
from tests.companion.facts import NOW_NS
from tests.companion.vehicle.drives import Drive, circle, random_drive, straight
from tests.companion.vehicle.hindsight import LATE, Told, after
from tests.companion.vehicle.rides import estimator
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle

EVEN_M_S2 = 0.2  # of an even driver over late data
PERIOD_NS = 100_000_000
AHEAD_NS = round(CLIMB_AHEAD_S * 1e9)
AWAITED = Awaited(t_ns=NOW_NS, climb_m_s=0.0, climb_std_m_s=0.1)


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
    assert driven(departing, 5.0).unevenness_m_s2 > 5.0 * EVEN_M_S2
    assert driven(departing, 9.0).unevenness_m_s2 < 0.2 * EVEN_M_S2


def test_changes_of_speed_after_a_departure_count() -> None:
    brakes = driven(lambda t_s: departing(t_s) - 2.0 * max(0.0, min(t_s - 9.0, 2.0)), 14.0)
    speeds_up = driven(lambda t_s: departing(t_s) + 2.0 * max(0.0, min(t_s - 9.0, 2.0)), 14.0)
    for driving in (brakes, speeds_up):
        assert driving.unevenness_m_s2 > 2.0 * EVEN_M_S2


@pytest.mark.parametrize("oldest_s", [0.2, 0.4])
def test_lateness_is_the_mean_age_however_seldom_a_receiver_tells(oldest_s: float) -> None:
    hindsight, found = Hindsight(), []
    for i in range(500):
        t_ns, age_s = NOW_NS + i * 20_000_000, oldest_s - 0.02 * (9 - i % 10)
        told: Any = Told(5.0, 0.01)
        newest_ns: Any = t_ns - round(age_s * 1e9)
        hindsight = update_hindsight(hindsight, told, newest_ns, t_ns, monotonic_ns=t_ns)
        if i > 250 and hindsight.lateness_s is not None:
            found.append(hindsight.lateness_s)
    assert found == pytest.approx([oldest_s - 0.09] * len(found), abs=0.02)


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
    found = after(truth, LATE, seed, 18.0).driving.unevenness_m_s2
    assert found > 2.0 * EVEN_M_S2 if uneven else found < EVEN_M_S2


def looked_back(hindsight: Hindsight, speed_m_s: float, t_ns: int) -> Hindsight:
    told: Any = Told(speed_m_s, 0.01)
    return update_hindsight(hindsight, told, EstimatorMemory(t_ns), t_ns, monotonic_ns=t_ns)


def test_uneven_driving_is_told_from_the_last_seconds_only() -> None:
    """Speeds of 4 and 5 m/s in turn, 2 s each, and an even 5 m/s afterwards, over a fix every tenth of a second."""
    hindsight = Hindsight()
    for i in range(400):
        hindsight = looked_back(hindsight, 4.0 if i < 200 and i // 20 % 2 else 5.0, NOW_NS + i * PERIOD_NS)
        if i == 199:
            assert hindsight.driving.unevenness_m_s2 == pytest.approx(0.5, rel=0.05)
    assert hindsight.driving.unevenness_m_s2 == 0.0


def test_speeds_before_and_after_an_outage_are_not_compared() -> None:
    hindsight, t_ns = Hindsight(), NOW_NS
    for speed_m_s in (1.0, 9.0):
        for _ in range(26):
            hindsight, t_ns = looked_back(hindsight, speed_m_s, t_ns), t_ns + PERIOD_NS
        t_ns, hindsight = t_ns + 100 * PERIOD_NS, replace(hindsight, awaited=())
    assert len(hindsight.driving.driven) == 42
    assert hindsight.driving.unevenness_m_s2 == 0.0


@pytest.mark.parametrize("variance_m2_s2", [0.08, 0.5])
def test_what_is_hardly_known_is_not_taken_for_driven(variance_m2_s2: float) -> None:
    is_sure = variance_m2_s2 < 0.09
    told: Any = Told(5.0, variance_m2_s2)
    found = update_hindsight(Hindsight(awaited=(AWAITED,)), told, EstimatorMemory(NOW_NS), NOW_NS, monotonic_ns=NOW_NS)
    assert len(found.driving.driven) == is_sure
    assert [one.t_ns for one in found.awaited] == [NOW_NS + AHEAD_NS]


def test_what_is_awaited_ends_with_the_estimate() -> None:
    driving = Driving(unevenness_m_s2=0.5)
    hindsight = Hindsight(awaited=(AWAITED,), speed_std_m_s=0.1, driving=driving)
    found = update_hindsight(hindsight, estimator(EstimatorKind.IMM), None, NOW_NS, monotonic_ns=NOW_NS)
    assert found == Hindsight(driving=driving)


@pytest.mark.parametrize(
    ("variance_m2_s2", "std_m_s"),
    [(0.04, 0.2), (4.0, math.inf), (-1e-18, 0.0)],
    ids=["known", "no longer known", "rounded below nothing"],
)
def test_speed_is_as_uncertain_as_it_is_told_and_unknown_once_it_is_lost(variance_m2_s2: float, std_m_s: float) -> None:
    told: Any = Told(5.0, variance_m2_s2)
    memory = EstimatorMemory(NOW_NS - 10)
    found = update_hindsight(Hindsight(speed_std_m_s=0.1), told, memory, NOW_NS, monotonic_ns=NOW_NS)
    assert found.speed_std_m_s == pytest.approx(std_m_s)


def test_how_a_vehicle_has_driven_outlasts_a_clock_that_is_set() -> None:
    hindsight = Hindsight(
        awaited=(AWAITED,),
        speed_std_m_s=0.1,
        driving=Driving(driven=((NOW_NS, 3.0, 4.0),), changes=(0.5,), unevenness_m_s2=0.5),
    )
    assert forget_instants(hindsight) == Hindsight(speed_std_m_s=0.1, driving=Driving(unevenness_m_s2=0.5))
    assert forget_instants(Hindsight()) == Hindsight()


@dataclass(frozen=True)
class SureVehicle(KnownVehicle):
    """One whose speed is told well."""

    def estimate(self, memory: int | None, t_ns: int) -> VehicleEstimate | None:
        return None if memory is None else Told(4.0, 0.01).estimate(memory, t_ns)


def test_step_looks_back_once_the_data_are_there() -> None:
    flight = Flight(vehicle=SureVehicle((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0)))
    flight.run(0.1)
    flight.sends_fixes = False
    flight.run(1.0)
    before = len(flight.memory.vehicle.hindsight.driving.driven)
    flight.sends_fixes = True
    flight.run(0.1)
    assert len(flight.memory.vehicle.hindsight.driving.driven) >= before + 5
