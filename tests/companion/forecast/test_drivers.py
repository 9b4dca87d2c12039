"""What a driver has done is expected of it again, and is forgotten; before that it is one of the domain's."""

import math

import numpy as np
import pytest

from companion.forecast.branches import NOTHING, SLOWER, TURN, make_events
from companion.forecast.draws import draws
from companion.forecast.drivers import DEPARTS, PRIOR_GAPS_S, SLOWS, SPEEDS_UP, TURNS, Drivers, chances, update_drivers
from companion.vehicle.hindsight import Driven

START_NS = 1_795_000_000_000_000_000
PERIOD_NS = 100_000_000


def seen(speeds_m_s: list[float], turn_rad_s: float = 0.0) -> Drivers:
    drivers, driven = Drivers(), tuple[Driven, ...]()
    for at, speed_m_s in enumerate(speeds_m_s):
        course_rad = 0.4 + turn_rad_s * 0.1 * max(at - 30, 0)
        velocity = (speed_m_s * math.cos(course_rad), speed_m_s * math.sin(course_rad))
        driven = (*driven, (START_NS + at * PERIOD_NS, *velocity))[-150:]
        drivers = update_drivers(drivers, driven)
    return drivers


BRAKE = [9.0 - 0.25 * min(step, 16) for step in range(30)]  # 2.5 m/s^2 for 1.6 s


def test_an_unseen_driver_is_one_of_the_domains() -> None:
    assert [Drivers().rate_hz(kind) for kind in range(4)] == pytest.approx([1.0 / gap_s for gap_s in PRIOR_GAPS_S])


def test_one_brake_counts_once_and_as_hard_as_it_was() -> None:
    drivers = seen([9.0] * 20 + BRAKE)
    assert drivers.counts[SLOWS] == pytest.approx(1.0, abs=0.1)
    assert drivers.seen_m_s2(SLOWS) == pytest.approx(2.5, abs=0.1)


def test_an_even_driver_is_expected_to_go_on_evenly_and_a_brake_is_forgotten() -> None:
    braked, long_ago = seen([9.0] * 20 + BRAKE), seen([9.0] * 20 + BRAKE + [5.0] * 1500)
    even = seen([9.0] * 500)
    assert even.rate_hz(SLOWS) < Drivers().rate_hz(SLOWS) < braked.rate_hz(SLOWS)
    assert long_ago.rate_hz(SLOWS) < 0.5 * braked.rate_hz(SLOWS)


def test_a_bend_counts_as_a_turn_and_a_departure_not_as_speeding_up() -> None:
    assert seen([9.0] * 60, turn_rad_s=0.25).counts[TURNS] == pytest.approx(1.0, abs=0.1)
    departed = seen([0.0] * 30 + [0.18 * step for step in range(20)])
    assert departed.counts == pytest.approx((0.0, 0.0, 0.0, 1.0), abs=0.1)
    assert departed.rate_hz(DEPARTS) > 0.15


def test_a_bend_ends_after_a_right_angle_until_it_has_gone_on_for_longer() -> None:
    turning, straight = seen([9.0] * 50, turn_rad_s=0.25), seen([9.0] * 50)
    circling = seen([9.0] * 300, turn_rad_s=0.25)
    assert 0.0 < 1.0 / turning.exits_hz(9.0 * 0.25, 9.0) - 0.5 * math.pi / 0.25 < 3.0
    assert 1.0 / circling.exits_hz(9.0 * 0.25, 9.0) > 30.0
    assert straight.bends_s == straight.exits_hz(0.1, 9.0) == 0.0
    assert 0.0 < straight.exits_hz(2.0, 0.0) < 3.0  # of a vehicle that hardly moves an estimate may say anything


def test_a_bend_that_is_driven_through_is_left_more_often_than_another_one_begins() -> None:
    numbers = draws()
    turns = numbers.branch == TURN
    events = make_events(numbers, Drivers(), within_s=1.5, unseen_s=0.4, speed_m_s=6.0, left_m_s2=2.5, stands=False)
    assert np.mean(events.event[turns, 1] == 0.0) > 0.8
    assert events.event[turns, 0].min() == pytest.approx(-0.4, abs=0.05)
    assert events.event[~turns, 0].min() >= 0.0
    on_straight = make_events(
        numbers, Drivers(), within_s=1.5, unseen_s=0.4, speed_m_s=6.0, left_m_s2=0.0, stands=False
    )
    assert events.weight[turns].sum() > 5.0 * on_straight.weight[turns].sum()


@pytest.mark.parametrize("stands", [True, False])
def test_chances_and_weights_are_probabilities(stands: bool) -> None:
    numbers = draws()
    assert chances(Drivers(), 1.7, 2.1, 0.3, stands=stands).sum() == pytest.approx(1.0)
    events = make_events(numbers, Drivers(), within_s=1.7, unseen_s=0.0, speed_m_s=8.0, left_m_s2=0.3, stands=stands)
    assert events.weight.sum() == pytest.approx(1.0)
    nothing = float(events.weight[numbers.branch == NOTHING].sum())
    rates_hz = [1.0 / PRIOR_GAPS_S[DEPARTS]] if stands else [1.0 / gap_s for gap_s in PRIOR_GAPS_S[:3]]
    assert nothing == pytest.approx(math.exp(-1.7 * sum(rates_hz)))  # of a Poisson process


def test_end_of_a_bend_takes_nothing_from_the_weight_of_a_brake() -> None:
    straight, bend = (chances(Drivers(), 2.0, 2.0, exits_hz, stands=False) for exits_hz in (0.0, 2.0))
    assert bend[1:3] == pytest.approx(straight[1:3])
    assert bend[3] > 0.5 > straight[3]
    alone = -np.expm1(-2.0 * (Drivers().rate_hz(SLOWS) + Drivers().rate_hz(SPEEDS_UP)))
    assert bend[1:3].sum() == pytest.approx(alone)


def test_brakes_have_the_domains_mean_and_its_heavy_tail() -> None:
    numbers = draws()
    slower = numbers.branch == SLOWER
    events = make_events(numbers, Drivers(), within_s=2.0, unseen_s=0.0, speed_m_s=8.0, left_m_s2=0.0, stands=False)
    sizes = events.event[slower, 1]
    assert -sizes.mean() == pytest.approx(0.88 * 2.53 + 0.12 * 6.75, abs=0.15)
    assert np.count_nonzero(sizes < -4.5) == pytest.approx(0.12 * slower.sum(), abs=1.0)
