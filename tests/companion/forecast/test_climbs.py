"""How much faster a pad may rise or fall than forecast: as its road or deck has done, and as the estimator believes."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from companion.autopilots.response import STATES
from companion.core.data import VehicleEstimate
from companion.forecast.draws import draws
from companion.landing.touchdown.rollout_errors import climbs_m_s, draw_errors
from companion.vehicle.estimator import EstimatorMemory
from companion.vehicle.hindsight import CLIMB_AHEAD_S, Driving, Hindsight, update_hindsight
from link.records import replace
from tests.companion.facts import NOW_NS, pad_at

STD_M_S = 0.2
KEPT_S = 15.0
"""As long as how a vehicle has driven is looked back at."""


@dataclass(frozen=True)
class Climber:
    """An estimator that knows how fast a vehicle climbs up to its newest datum, and takes it to go on so."""

    climb_m_s: Callable[[float], float]
    newest_s: float

    def newest_fix_ns(self, _memory: EstimatorMemory) -> int:
        return NOW_NS + round(self.newest_s * 1e9)

    def estimate(self, _memory: EstimatorMemory, t_ns: int) -> VehicleEstimate:
        known_s = min((t_ns - NOW_NS) * 1e-9, self.newest_s)
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=np.zeros(3),
            velocity_enu_m_s=np.array([8.0, 0.0, self.climb_m_s(known_s)]),
            acceleration_enu_m_s2=np.zeros(3),
            covariance=np.diag([0.0] * 3 + [0.01, 0.01, STD_M_S**2] + [0.0] * 3),
            yaw_rad=None,
            yaw_rate_rad_s=None,
        )


def driven(climb_m_s: Callable[[float], float], until_s: float, *, late_s: float = 0.2) -> Driving:
    """What is known after such a drive of how its climbs were forecast."""
    hindsight = Hindsight()
    for i in range(round(until_s / 0.1)):
        told: Any = Climber(climb_m_s, 0.1 * i - late_s)
        t_ns = NOW_NS + i * 100_000_000
        hindsight = update_hindsight(hindsight, told, EstimatorMemory(t_ns), t_ns, monotonic_ns=t_ns)
    return hindsight.driving


def believed(driving: Driving) -> float:
    """Of a pad whose estimator states `STD_M_S` for the time of the contact."""
    pad = pad_at()
    pad = replace(pad, climb_std_m_s=STD_M_S * pad.offset_s / CLIMB_AHEAD_S)
    then: Any = Climber(lambda _: 0.0, 0.0)
    return climbs_m_s(then.estimate(None, NOW_NS), pad, driving)


def test_nothing_seen_is_as_the_estimator_believes() -> None:
    assert believed(Driving()) == pytest.approx(STD_M_S)


def test_even_road_is_believed_more_and_more() -> None:
    found = [believed(driven(lambda _: 0.5, until_s)) for until_s in (1.0, 5.0, 20.0, 60.0)]
    assert found == sorted(found, reverse=True)
    assert found[-1] == found[-2] == pytest.approx(STD_M_S * math.sqrt(2.0 / (2.0 + KEPT_S)))


@pytest.mark.parametrize("late_s", [0.1, 0.6])
def test_road_of_hills_is_as_uncertain_as_its_climb_has_changed_meanwhile(late_s: float) -> None:
    """A climb of 1 m/s and a fall of 1 m/s in turn, as a sine of 6 s: what is forecast is old by lateness and lead."""
    w, size_m_s = 2.0 * math.pi / 6.0, 1.0
    off_m_s = math.sqrt(2.0) * size_m_s * math.sin(0.5 * w * (late_s + CLIMB_AHEAD_S))
    found = believed(driven(lambda t_s: size_m_s * math.sin(w * t_s), 60.0, late_s=late_s))
    assert found == pytest.approx(math.sqrt((2.0 * STD_M_S**2 + KEPT_S * off_m_s**2) / (2.0 + KEPT_S)), rel=0.05)


def test_hills_are_forgotten_on_an_even_road() -> None:
    over = believed(driven(lambda t_s: math.sin(t_s) if t_s < 20.0 else math.sin(20.0), 60.0))
    assert over == pytest.approx(believed(driven(lambda _: 0.0, 60.0)))


def test_estimator_that_does_not_look_ahead_is_as_sure_as_at_its_newest_datum() -> None:
    then: Any = Climber(lambda _: 0.0, 0.0)
    assert climbs_m_s(then.estimate(None, NOW_NS), pad_at(), Driving()) == pytest.approx(STD_M_S)


def test_samples_sink_otherwise_by_as_much() -> None:
    then: Any = Climber(lambda _: 0.0, 0.0)
    sinks = [
        draw_errors(then.estimate(None, NOW_NS), pad_at(), std_m_s, np.zeros((STATES, STATES)), draws()).vertical[:, 1]
        for std_m_s in (0.0, 0.4)
    ]
    assert sinks[1].var() - sinks[0].var() == pytest.approx(0.4**2, rel=0.1)
