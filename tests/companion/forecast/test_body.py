"""A body dives and leans as its springs let it, and a rollout meets its roof as it moves then."""

import math

import numpy as np
import pytest

from companion.core.data import GRAVITY_M_S2
from companion.forecast.body import BodyLean, gains_rad_s2_m, spring, sprung, update_body
from companion.forecast.rollout import roll_out
from companion.forecast.samples import ALONG, DT_S, IN_S, SPEED, TILT, Body, Descent, Samples
from tests.companion.forecast.descents import LEVEL, NEVER_S, descent, samples

SECOND_NS = 1_000_000_000
GAIN, ABOVE_M = 0.004, 2.0


def over(body: Body, **drone: float) -> Descent:
    """A descent over a vehicle whose body stands like this, in calm air."""
    down = descent(**drone)
    down.course.air_enu_m_s2[:] = 0.0
    return down._replace(course=down.course._replace(body=body))


def on_springs(down: Samples) -> Samples:
    return down._replace(gains_rad_s2_m=np.full_like(down.gains_rad_s2_m, GAIN))


def test_a_body_overshoots_by_what_its_damping_leaves_and_comes_to_rest() -> None:
    state, step, seen = (0.0, 0.0), spring(0.01), []
    for _ in range(500):
        state = sprung(state, -4.0, step)
        seen.append(state[0])
    overshoot = math.exp(-math.pi * 0.3 / math.sqrt(1.0 - 0.3**2))
    assert min(seen) == pytest.approx(-4.0 * (1.0 + overshoot), rel=1e-3)
    assert seen[-1] == pytest.approx(-4.0, rel=1e-3)


def test_two_steps_are_one_of_twice_the_time() -> None:
    twice = sprung(sprung((0.3, -1.0), 2.0, spring(0.05)), 2.0, spring(0.05))
    assert twice == pytest.approx(sprung((0.3, -1.0), 2.0, spring(0.1)))


def test_what_is_known_of_a_body_goes_with_its_data_and_stands_after_an_outage() -> None:
    first = update_body(BodyLean(), 0, 0.5, 0.0)
    assert (first.dive, first.lean) == ((0.5, 0.0), (0.0, 0.0))
    brakes = update_body(first, SECOND_NS // 20, -3.0, 1.0)
    assert brakes.dive == pytest.approx(sprung((0.5, 0.0), -3.0, spring(0.05)))
    assert brakes.lean == pytest.approx(sprung((0.0, 0.0), 1.0, spring(0.05)))
    assert update_body(brakes, 3 * SECOND_NS, -2.0, 1.0).dive == (-2.0, 0.0)


def test_bodies_dive_by_one_to_three_degrees_for_each_g_and_lean_by_three_to_seven() -> None:
    ends = np.degrees(gains_rad_s2_m(np.array([[0.0, 0.0], [1.0, 1.0]])) * GRAVITY_M_S2)
    assert ends == pytest.approx(np.array([[1.0, 3.0], [3.0, 7.0]]))


def test_a_roof_that_dives_is_met_faster_by_how_fast_it_runs_ahead_of_its_wheels() -> None:
    begun_s = 0.1
    brakes = on_springs(samples(kind=ALONG, event=np.array([0.0, -3.0, 1e-6, NEVER_S]), delay_s=9.0))
    plain, dives = (roll_out(brakes, over(LEVEL._replace(above_m=above_m)), begun_s)[0] for above_m in (0.0, ABOVE_M))
    _, rate = sprung((0.0, 0.0), -3.0, spring(begun_s + plain[IN_S]))
    assert dives[SPEED] - plain[SPEED] == pytest.approx(ABOVE_M * GAIN * rate, abs=0.03)


def test_a_roof_that_has_dived_swings_on() -> None:
    swings = LEVEL._replace(dive=(0.0, 20.0), above_m=ABOVE_M)
    (end,) = roll_out(on_springs(samples()), over(swings), 0.0)
    _, rate = sprung((0.0, 20.0), 0.0, spring(end[IN_S]))
    assert end[SPEED] == pytest.approx(ABOVE_M * GAIN * abs(rate), abs=0.02)


@pytest.mark.parametrize("told", [False, True])
def test_a_roof_leans_out_of_a_bend_unless_what_it_tells_has_that_in_it(told: bool) -> None:
    left_m_s2 = 3.0
    leans = LEVEL._replace(lean=(left_m_s2, 0.0), told_m_s2=(0.0, left_m_s2 if told else 0.0))
    down = over(leans, level_below_m=-1.0)
    down.course.left_m_s2[:] = left_m_s2
    (end,) = roll_out(on_springs(samples()), down, 3.0 * DT_S)
    slope = left_m_s2 / GRAVITY_M_S2 + (0.0 if told else left_m_s2 * GAIN)
    assert end[TILT] == pytest.approx(math.atan(slope), abs=1e-3)
