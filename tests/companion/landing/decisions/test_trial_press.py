"""How hard and for how long a drone is pressed down while the signs of a contact agree, which may be wrong."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.landing.decisions.contact import trial_press_m_s2, trial_s
from companion.landing.decisions.contact_signs import Signs
from link.records import replace
from tests.companion.facts import CONFIG

TOUCHDOWN = CONFIG.touchdown
STANDS = Signs(
    height_m=0.0,
    distance_m=0.1,
    climb_m_s=0.0,
    acceleration_up_m_s2=None,
    setpoint_below_m=0.3,
    range_height_m=0.01,
    landed=False,
)


@given(st.floats(0.0, 3.0), st.floats(0.0, 0.4), st.floats(-TOUCHDOWN.sink_max_m_s, TOUCHDOWN.blocked_speed_m_s))
def test_a_drone_pressed_down_in_the_air_becomes_no_faster_than_its_gear_takes(
    seen_m: float, late_s: float, climb_m_s: float
) -> None:
    """One was pressed with 5 m/s^2 from 0.26 m, over a link 0.1 s late: it touched at 1.27 m/s."""
    signs = replace(STANDS, range_height_m=seen_m, climb_m_s=climb_m_s)
    press_m_s2, now_m_s = trial_press_m_s2(signs, late_s, TOUCHDOWN), max(-climb_m_s, 0.0)
    assert 0.0 <= press_m_s2 <= TOUCHDOWN.try_acceleration_m_s2
    touches_m_s = math.sqrt(now_m_s**2 + 2.0 * press_m_s2 * seen_m)
    at_last_m_s = now_m_s + press_m_s2 * (TOUCHDOWN.range_finder.disputed_hold_s + late_s)
    assert min(touches_m_s, at_last_m_s) < TOUCHDOWN.sink_max_m_s + 1e-9
    if press_m_s2 < TOUCHDOWN.try_acceleration_m_s2:  # it is pressed as hard as that allows
        assert min(touches_m_s, at_last_m_s) == pytest.approx(TOUCHDOWN.sink_max_m_s)


@given(st.floats(0.05, 3.0), st.floats(0.0, 0.4))
def test_a_press_that_is_believed_would_have_shown_a_drone_in_the_air_to_sink(seen_m: float, late_s: float) -> None:
    signs = replace(STANDS, range_height_m=seen_m, climb_m_s=0.0)
    press_m_s2 = trial_press_m_s2(signs, late_s, TOUCHDOWN)
    shown_s = trial_s(signs, press_m_s2, late_s, TOUCHDOWN) - late_s
    assert press_m_s2 * shown_s > TOUCHDOWN.blocked_speed_m_s


@given(st.floats(0.0, TOUCHDOWN.try_acceleration_m_s2), st.floats(0.0, 0.4), st.none() | st.floats(-0.1, 3.0))
def test_a_trial_lasts_until_a_drone_with_room_to_fall_would_be_reported_to_sink(
    press_m_s2: float, late_s: float, seen_m: float | None
) -> None:
    """Or, where it may hardly be pressed, for as long as a range finder that disagrees has to be outvoted."""
    lasts_s = trial_s(replace(STANDS, range_height_m=seen_m), press_m_s2, late_s, TOUCHDOWN)
    falls_to_m_s = math.sqrt(2.0 * TOUCHDOWN.press_acceleration_m_s2 * max(math.inf if seen_m is None else seen_m, 0.0))
    reported_s = lasts_s - (late_s if falls_to_m_s > TOUCHDOWN.sink_max_m_s else 0.0)
    is_longest = lasts_s == TOUCHDOWN.range_finder.disputed_hold_s
    assert is_longest or press_m_s2 * reported_s == pytest.approx(TOUCHDOWN.pressed_speed_m_s)
    assert lasts_s <= TOUCHDOWN.range_finder.disputed_hold_s


@pytest.mark.parametrize(("share", "later_s"), [(0.99, 0.0), (1.01, 0.3)])
def test_a_trial_waits_for_the_reports_only_where_the_press_of_a_contact_could_make_the_drone_too_fast(
    share: float, later_s: float
) -> None:
    """Pressed with 9 m/s^2 it has 0.7 m/s after 0.027 m."""
    near = replace(STANDS, range_height_m=share * TOUCHDOWN.sink_max_m_s**2 / (2.0 * TOUCHDOWN.press_acceleration_m_s2))
    assert trial_s(near, 5.0, 0.3, TOUCHDOWN) - trial_s(near, 5.0, 0.0, TOUCHDOWN) == pytest.approx(later_s)


def test_a_drone_whose_range_finder_sees_the_pad_at_its_feet_is_pressed_with_all() -> None:
    signs = replace(STANDS, range_height_m=0.04, climb_m_s=0.0)
    assert trial_press_m_s2(signs, 0.2, TOUCHDOWN) == TOUCHDOWN.try_acceleration_m_s2


def test_without_a_range_finder_only_the_signs_tell_and_the_press_is_whole() -> None:
    signs = replace(STANDS, range_height_m=None)
    assert trial_press_m_s2(signs, 0.2, TOUCHDOWN) == TOUCHDOWN.try_acceleration_m_s2


def test_a_drone_that_sinks_faster_than_its_gear_takes_is_not_pressed_at_all() -> None:
    fast = replace(STANDS, climb_m_s=-TOUCHDOWN.sink_max_m_s - 0.1, range_height_m=0.5)
    assert trial_press_m_s2(fast, 0.1, TOUCHDOWN) == 0.0


def test_a_drone_whose_speed_is_not_known_or_upwards_is_pressed_as_one_that_stands() -> None:
    still = replace(STANDS, climb_m_s=0.0, range_height_m=0.5)
    for climb_m_s in (None, 0.3):
        moving = replace(still, climb_m_s=climb_m_s)
        assert trial_press_m_s2(moving, 0.1, TOUCHDOWN) == trial_press_m_s2(still, 0.1, TOUCHDOWN)


def test_a_range_finder_that_sees_the_pad_above_the_feet_lets_them_press_with_all() -> None:
    assert trial_press_m_s2(replace(STANDS, range_height_m=-0.05), 0.1, TOUCHDOWN) == TOUCHDOWN.try_acceleration_m_s2
