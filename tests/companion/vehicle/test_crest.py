"""How high waves lift a deck: the highest of the last half to one minute, and nothing on a calm one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.vehicle.crest import Crest, crest_above_m, update_crest

STEP_S = 0.1
START_NS = 10**12


def seen(heights_m: list[float]) -> Crest:
    crest = Crest()
    for i, height_m in enumerate(heights_m):
        crest = update_crest(crest, START_NS + round(i * STEP_S * 1e9), height_m)
    return crest


def waves(amplitude_m: float, period_s: float, duration_s: float) -> list[float]:
    times_s = [i * STEP_S for i in range(round(duration_s / STEP_S))]
    return [6.5 + amplitude_m * math.sin(2.0 * math.pi * t_s / period_s) for t_s in times_s]


@pytest.mark.parametrize("duration_s", [30.0, 45.0, 70.0, 200.0])
@pytest.mark.parametrize("period_s", [8.8, 12.4, 15.0])
def test_deck_in_a_trough_is_known_to_come_up_again(period_s: float, duration_s: float) -> None:
    heights_m = waves(2.3, period_s, duration_s)
    assert crest_above_m(seen(heights_m), 6.5 - 2.3) == pytest.approx(4.6, abs=0.01)
    assert crest_above_m(seen(heights_m), 6.5 + 2.3) == pytest.approx(0.0, abs=0.01)


@given(st.lists(st.floats(-20.0, 20.0), min_size=1))
def test_crest_is_no_lower_than_the_deck_and_no_higher_than_waves_are(heights_m: list[float]) -> None:
    assert 0.0 <= crest_above_m(seen(heights_m), heights_m[-1]) <= 10.0


def test_waves_of_a_minute_ago_are_forgotten() -> None:
    heights_m = waves(2.3, 12.4, 30.0) + [6.5] * round(62.0 / STEP_S)
    assert crest_above_m(seen(heights_m), 6.5) == 0.0


def test_nothing_is_known_before_the_first() -> None:
    assert crest_above_m(Crest(), 6.5) == 0.0
