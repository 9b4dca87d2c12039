"""What a driver has done is expected of it again, and is forgotten; before that it is one of the domain's."""

import math

import numpy as np
import pytest

from companion.autopilots.response import (
    DRAG_PER_S,
    POSITION_STD_M,
    PUSH_STD_M_S2,
    VELOCITY_STD_M_S,
    Cascade,
    ResponseModel,
)
from companion.core.data import Array
from companion.forecast.branches import NOTHING, SLOWER, make_events
from companion.forecast.draws import draws
from companion.forecast.drivers import DEPARTS, PRIOR_GAPS_S, SLOWS, TURNS, Drivers, chances, update_drivers
from companion.forecast.gusts import Gusts, update_gusts
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


@pytest.mark.parametrize("stands", [True, False])
def test_chances_and_weights_are_probabilities(stands: bool) -> None:
    numbers = draws()
    assert chances(Drivers(), 1.7, stands=stands).sum() == pytest.approx(1.0)
    events = make_events(numbers, Drivers(), within_s=1.7, speed_m_s=8.0, left_m_s2=0.3, stands=stands)
    assert events.weight.sum() == pytest.approx(1.0)
    nothing = float(events.weight[numbers.branch == NOTHING].sum())
    rates_hz = [1.0 / PRIOR_GAPS_S[DEPARTS]] if stands else [1.0 / gap_s for gap_s in PRIOR_GAPS_S[:3]]
    assert nothing == pytest.approx(math.exp(-1.7 * sum(rates_hz)))  # of a Poisson process


def test_brakes_have_the_domains_mean_and_its_heavy_tail() -> None:
    numbers = draws()
    slower = numbers.branch == SLOWER
    sizes = make_events(numbers, Drivers(), within_s=2.0, speed_m_s=8.0, left_m_s2=0.0, stands=False).event[slower, 1]
    assert -sizes.mean() == pytest.approx(0.88 * 2.53 + 0.12 * 6.75, abs=0.15)
    assert np.count_nonzero(sizes < -4.5) == pytest.approx(0.12 * slower.sum(), abs=1.0)


RESPONSE = ResponseModel(
    Cascade(position_per_s=0.95, velocity_per_s=1.8, integral_per_s2=0.4, lead_s=0.02), np.arange(0.0, 4.01, 0.2)
)
REPORT_S = 0.02


def learnt(pushes_m_s2: Array, path_m_s2: float = 0.0) -> Gusts:
    """What reports teach in which the estimated push (n, 2) is this."""
    gusts = Gusts()
    for report, push in enumerate(pushes_m_s2):
        deviation = np.zeros((4, 2))
        deviation[3] = push
        gusts = update_gusts(gusts, round(report * REPORT_S * 1e9), deviation, np.full(2, path_m_s2), RESPONSE)
    return gusts


def pushed(std_m_s2: float, noise: float, seed: int) -> Gusts:
    """What is learnt over two minutes from the reports of a drone that is pushed so, with that share of their noise."""
    rng, gusts, state = np.random.default_rng(seed), Gusts(), np.zeros((4, 2))
    truth, forgets_hz = np.zeros((4, 2)), RESPONSE.cascade.forgets_hz
    new_m_s2 = std_m_s2 * math.sqrt(1.0 - math.exp(-2.0 * REPORT_S * forgets_hz))
    errs = noise * np.array([[POSITION_STD_M], [VELOCITY_STD_M_S]])
    for report in range(6000):
        truth = RESPONSE.carry(truth, REPORT_S)
        truth[3] += new_m_s2 * rng.standard_normal(2)
        state = RESPONSE.update(state, truth[:2] + errs * rng.standard_normal((2, 2)), np.zeros(2), REPORT_S)
        gusts = update_gusts(gusts, round(report * REPORT_S * 1e9), state, np.zeros(2), RESPONSE)
    return gusts


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("std_m_s2", [0.3, 0.75, 1.5])
def test_gusts_are_learnt_from_what_pushes_whatever_the_reports_noise(std_m_s2: float, noise: float) -> None:
    found = np.mean([pushed(std_m_s2, noise, seed).push_std_m_s2 ** 2 for seed in range(4)]) ** 0.5
    assert found == pytest.approx(std_m_s2, rel=0.25, abs=0.12)


def test_reports_without_noise_of_a_drone_that_nothing_pushes_show_no_gusts() -> None:
    assert Gusts().push_std_m_s2 == PUSH_STD_M_S2
    assert pushed(0.0, 0.0, 1).push_std_m_s2 < 0.3 * PUSH_STD_M_S2


def test_what_the_integrator_still_holds_after_a_hard_flight_is_no_gust() -> None:
    times_s = REPORT_S * np.arange(1000)
    left = np.exp(-times_s * RESPONSE.cascade.forgets_hz)
    assert learnt(1.2 * np.column_stack([left, -left])).push_std_m_s2 < 0.3 * PUSH_STD_M_S2


def test_what_drag_does_to_a_path_that_speeds_up_is_no_gust() -> None:
    path_m_s2, forgets_hz = 2.0, RESPONSE.cascade.forgets_hz
    held = -DRAG_PER_S * path_m_s2 / forgets_hz * (1.0 - np.exp(-REPORT_S * np.arange(500) * forgets_hz))
    assert learnt(np.column_stack([held, held]), path_m_s2).push_std_m_s2 < 0.35 * PUSH_STD_M_S2
