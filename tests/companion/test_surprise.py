"""A vehicle that has done what its late data did not let expect is landed on while it stands, or has driven evenly."""

import math
from dataclasses import replace
from typing import Any

import pytest

from companion.config import CompanionConfig
from companion.estimation.config import EstimatorKind
from companion.flying import waits_at_m
from companion.phases import Phase
from companion.step_data import StepMemory
from companion.surprise import Surprise, looked_back, may_surprise
from link.messages import Vector3
from tests.companion.estimation.driving import DEGRADED, NOMINAL, Drive, Sensors, brake, circle, sense, straight
from tests.companion.estimation.rides import estimator, now_ns
from tests.companion.facts import NOW_NS, drone_at, pad_at, situation

CONFIG = CompanionConfig()
DESCENT = CONFIG.descent
LATE = replace(DEGRADED, delay_s=0.5)
TICK_S = 0.02
BEGUN_S = 2.0  # until then an estimate may be surprised by what it has not known yet


def after(truth: Drive, sensors: Sensors, seed: int, until_s: float) -> Surprise:
    """What has been noticed of a drive, asked at 50 Hz, when each measurement has come when it comes."""
    chosen, waiting = estimator(EstimatorKind.IMM), sense(truth, sensors, seed)[::-1]
    memory: Any = None
    surprise = Surprise()
    for i in range(round(until_s / TICK_S)):
        batch = []
        while waiting and waiting[-1][0] <= now_ns(i * TICK_S):
            batch.append(waiting.pop()[1])
        memory = chosen.fuse(memory, batch)
        surprise = looked_back(surprise, chosen, memory, now_ns(i * TICK_S), DESCENT)
    return surprise


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("truth", [straight(7.0), circle(5.0)], ids=["straight", "circle"])
def test_even_driving_surprises_nobody_however_late_it_is_told(truth: Drive, seed: int) -> None:
    assert after(truth, LATE, seed, 15.0).surprised_ns < now_ns(BEGUN_S)


@pytest.mark.parametrize(("sensors", "surprises"), [(LATE, True), (NOMINAL, False)], ids=["late", "nominal"])
def test_hard_brake_surprises_who_is_told_late(sensors: Sensors, *, surprises: bool) -> None:
    found = after(brake(), sensors, 3, brake().length_s)
    assert (found.surprised_ns > now_ns(BEGUN_S)) is surprises


def test_surprise_holds_for_its_time_and_no_longer() -> None:
    surprise = Surprise(surprised_ns=NOW_NS)
    hold_ns = round(DESCENT.surprise_hold_s * 1e9)
    assert may_surprise(surprise, NOW_NS + hold_ns - 1, DESCENT)
    assert not may_surprise(surprise, NOW_NS + hold_ns + 1, DESCENT)
    assert not may_surprise(Surprise(), NOW_NS, DESCENT)


def test_beliefs_end_with_the_estimate_that_they_were() -> None:
    surprise = Surprise(beliefs=((NOW_NS, 5.0),), surprised_ns=NOW_NS)
    assert looked_back(surprise, estimator(EstimatorKind.IMM), None, NOW_NS, DESCENT) == replace(surprise, beliefs=())


@pytest.mark.parametrize(
    ("speed_m_s", "std_m_s", "waits"),
    [
        (DESCENT.waiting_speed_m_s - 0.01, 0.05, False),
        (DESCENT.waiting_speed_m_s + 0.01, 0.05, True),
        (DESCENT.waiting_speed_m_s + 0.01, 0.2, False),
        (DESCENT.waiting_speed_m_s + 0.01, math.inf, False),
        (CONFIG.abort.near_speed_max_m_s + 0.01, math.inf, True),
    ],
    ids=["settled", "too fast", "hardly known", "not known", "too fast by far"],
)
def test_descent_waits_until_the_drone_has_settled_as_far_as_that_is_known(
    speed_m_s: float, std_m_s: float, *, waits: bool
) -> None:
    pad = pad_at()
    here = replace(situation(0.9), drone=drone_at(0.9, 0.0, (0.6 * speed_m_s, -0.8 * speed_m_s, 0.0), pad=pad))
    memory = StepMemory(phase=Phase.DESCEND, surprise=Surprise(speed_std_m_s=std_m_s))
    assert waits_at_m(memory, here, CONFIG) == (DESCENT.waiting_height_m if waits else None)


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
    surprise = Surprise(surprised_ns=NOW_NS - 10 if surprised else 0)
    memory = StepMemory(phase=phase, surprise=surprise)
    waiting_m = waits_at_m(memory, situation(height_m, pad=pad_at(velocity)), CONFIG)
    assert waiting_m == (DESCENT.waiting_height_m if waits else None)
