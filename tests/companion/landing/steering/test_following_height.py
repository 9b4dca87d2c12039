"""How high a drone waits whose own height wanders."""

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.landing.steering.following_height import rise_from_ground_m
from companion.situation.situation import Situation
from link.records import replace
from tests.companion.facts import changed, situation

CONFIG = CompanionConfig()
WAIT_M = CONFIG.takeoff.waiting_height_m
LONG_S = 100.0
FASTEST_M_S = 1.0
"""No more of a single reading than a metre in a second."""


def _waits(seen_m: float | None, up_m: float = 7.0) -> Situation:
    """A drone whose autopilot says `up_m`, and whose range finder sees something `seen_m` below its feet."""
    return _up(changed(situation(), range_height_m=seen_m), up_m)


def _up(facts: Situation, up_m: float) -> Situation:
    assert facts.drone is not None
    return replace(facts, drone=replace(facts.drone, position_enu_m=np.array([0.0, 0.0, up_m])))


@pytest.mark.parametrize("too_low_m", [0.1, 1.0, 3.0])
def test_waiting_point_rises_by_what_the_ground_is_too_near(too_low_m: float) -> None:
    facts = _waits(WAIT_M - too_low_m)
    assert rise_from_ground_m(7.0, facts, LONG_S, CONFIG) == pytest.approx(too_low_m)


@pytest.mark.parametrize("climbed_m", [0.5, 1.0, 2.0])
def test_climb_of_the_drone_changes_nothing_of_where_it_is_to_wait(climbed_m: float) -> None:
    """The range finder then sees the ground farther away by just that."""
    before = 7.0 + rise_from_ground_m(7.0, _waits(WAIT_M - 2.0), LONG_S, CONFIG)
    facts = _waits(WAIT_M - 2.0 + climbed_m, up_m=7.0 + climbed_m)
    assert 7.0 + rise_from_ground_m(7.0, facts, LONG_S, CONFIG) == pytest.approx(before)


@pytest.mark.parametrize("seen_m", [None, WAIT_M, WAIT_M + 3.0])
def test_waiting_point_stays_over_ground_that_is_not_near_or_not_seen(seen_m: float | None) -> None:
    assert rise_from_ground_m(7.0, _waits(seen_m), LONG_S, CONFIG) == 0.0


def test_single_reading_raises_it_by_centimetres() -> None:
    dt_s = 1.0 / CONFIG.setpoints.rate_hz
    assert 0.0 < rise_from_ground_m(7.0, _waits(0.2), dt_s, CONFIG) < FASTEST_M_S * dt_s


def test_drone_whose_range_finder_sees_something_everywhere_climbs_to_twice_the_height() -> None:
    facts, waits_m, dt_s = _waits(1.0), WAIT_M, 1.0 / CONFIG.setpoints.rate_hz
    for _ in range(round(LONG_S / dt_s)):
        waits_m += rise_from_ground_m(waits_m, _up(facts, waits_m), dt_s, CONFIG)
    assert facts.below.ground_enu_m is None
    assert waits_m == pytest.approx(facts.feet_offset_m + 2.0 * WAIT_M)


def test_waiting_point_stays_where_the_drone_is_not_known() -> None:
    assert rise_from_ground_m(7.0, replace(_waits(1.0), drone=None), LONG_S, CONFIG) == 0.0
