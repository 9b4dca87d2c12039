"""The way down: laws of its bounds and its end, and that it is the rest of itself."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.data import Array
from companion.planning.descent_path import descent_path

OFFSET_S: Array = np.arange(0.0, 12.01, 0.2)
FINE_S: Array = np.arange(0.0, 12.001, 0.02)
GAIN_HZ, FAST_M_S, SLOW_M_S, PRESSED_M = 1.0, 1.2, 0.45, -0.5
LANDING = (GAIN_HZ, FAST_M_S, SLOW_M_S, PRESSED_M)
WAITING = (GAIN_HZ, FAST_M_S, SLOW_M_S, 0.85)
BOUNDS = (1.5, 2.5)

heights = st.floats(0.9, 6.0)
rates = st.floats(-1.2, 1.0)


@settings(deadline=None)  # the first call compiles
@given(heights, rates)
def test_acceleration_and_jerk_stay_inside_their_bounds(height_m: float, rate_m_s: float) -> None:
    path = descent_path((height_m, rate_m_s, 0.0), LANDING, BOUNDS, FINE_S)
    assert np.abs(path[2]).max() <= BOUNDS[0] + 1e-9
    assert np.abs(np.diff(path[2])).max() <= BOUNDS[1] * 0.02 + 1e-9


@settings(deadline=None)  # the first call compiles
@given(heights, rates)
def test_sinks_no_faster_than_the_fastest_rate(height_m: float, rate_m_s: float) -> None:
    path = descent_path((height_m, rate_m_s, 0.0), LANDING, BOUNDS, FINE_S)
    assert path[1].min() >= -FAST_M_S - 0.02


@settings(deadline=None)  # the first call compiles
@given(st.floats(2.0, 6.0), rates)
def test_meets_the_pad_at_the_touchdown_rate(height_m: float, rate_m_s: float) -> None:
    path = descent_path((height_m, rate_m_s, 0.0), LANDING, BOUNDS, FINE_S)
    touch = int(np.argmax(path[0] <= 0.0))
    assert path[1, touch] == pytest.approx(-SLOW_M_S, abs=0.05)


@settings(deadline=None)  # the first call compiles
@given(st.floats(1.5, 6.0), st.floats(-0.8, 1.0))
def test_a_descent_that_waits_stops_where_it_is_to_wait(height_m: float, rate_m_s: float) -> None:
    path = descent_path((height_m, rate_m_s, 0.0), WAITING, BOUNDS, FINE_S)
    assert path[0].min() >= 0.85 - 0.03
    assert path[:, -1] == pytest.approx((0.85, 0.0, 0.0), abs=0.02)


def test_presses_no_deeper_than_it_is_told() -> None:
    path = descent_path((0.5, -0.45, 0.0), LANDING, BOUNDS, FINE_S)
    assert path[0].min() >= PRESSED_M - 0.02
    assert path[0, -1] == pytest.approx(PRESSED_M, abs=0.01)


def test_is_the_rest_of_itself_from_any_of_its_points() -> None:
    path = descent_path((3.0, 0.4, -0.2), LANDING, BOUNDS, OFFSET_S)
    for start in (1, 4, 9, 20):
        height_m, rate_m_s, acceleration_m_s2 = path[:, start].tolist()
        rest = descent_path((height_m, rate_m_s, acceleration_m_s2), LANDING, BOUNDS, OFFSET_S[:20])
        np.testing.assert_allclose(rest, path[:, start : start + 20], atol=1e-9)
