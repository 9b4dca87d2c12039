"""A jolt came from the pad where the drone is, or was when it was stopped, and nothing shows that it is in the air."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.landing.decisions.contact import does_not_fall, is_stopped_by_pad
from companion.landing.decisions.contact_signs import Signs, signs_of
from companion.vehicle.pad_reach import over_pad_radius_m
from link.records import replace
from tests.companion.facts import CONFIG, drone_at, pad_at, situation

TOUCHDOWN = CONFIG.touchdown
SEEN_MAX_M = TOUCHDOWN.range_finder.contact_height_max_m
RADIUS_M = over_pad_radius_m(0.75, CONFIG)
JOLT_S = 0.06  # three reports at 50 Hz, in which a jolt is seen
JOLTED = Signs(
    height_m=0.1,
    distance_m=0.2,
    climb_m_s=-0.5,
    acceleration_up_m_s2=3.0,
    setpoint_below_m=0.0,
    range_height_m=None,
    landed=False,
    pad_half_width_m=0.75,
)


@pytest.mark.parametrize(
    ("height_m", "seen_m", "carried_m", "expected"),
    [
        (SEEN_MAX_M - 0.01, None, None, True),
        (SEEN_MAX_M + 0.01, None, None, False),
        (0.3, SEEN_MAX_M - 0.01, None, True),
        (0.1, SEEN_MAX_M + 0.01, None, False),
        (0.3, None, SEEN_MAX_M - 0.01, True),
        (0.1, None, SEEN_MAX_M + 0.01, False),
        (0.3, SEEN_MAX_M - 0.01, 3.0, True),
        (None, SEEN_MAX_M - 0.01, None, False),
    ],
)
def test_range_finder_or_what_it_saw_last_or_else_the_estimate_shows_the_pad_at_the_feet(
    height_m: float | None, seen_m: float | None, carried_m: float | None, *, expected: bool
) -> None:
    signs = replace(JOLTED, height_m=height_m, range_height_m=seen_m, range_carried_m=carried_m)
    assert is_stopped_by_pad(signs, CONFIG) is expected


def test_all_other_signs_of_a_contact_are_enough_above_what_a_height_shows() -> None:
    signs = replace(JOLTED, height_m=SEEN_MAX_M + 0.1, climb_m_s=0.0, setpoint_below_m=0.3)
    assert is_stopped_by_pad(signs, CONFIG)
    assert not is_stopped_by_pad(replace(signs, setpoint_below_m=0.0), CONFIG)


@pytest.mark.parametrize(
    ("distance_m", "passed_m", "expected"),
    [
        (RADIUS_M - 0.01, None, True),
        (RADIUS_M + 0.01, None, False),
        (RADIUS_M + 0.5, RADIUS_M - 0.01, True),
        (RADIUS_M + 0.5, RADIUS_M + 0.01, False),
        (RADIUS_M - 0.01, RADIUS_M + 0.5, True),
        (None, 0.0, False),
    ],
)
def test_pad_stopped_it_where_it_is_or_has_just_been(
    distance_m: float | None, passed_m: float | None, *, expected: bool
) -> None:
    assert is_stopped_by_pad(replace(JOLTED, distance_m=distance_m, passed_m=passed_m), CONFIG) is expected


@given(
    x_m=st.floats(-2.0, 2.0),
    y_m=st.floats(-2.0, 2.0),
    vx_m_s=st.floats(-9.0, 9.0) | st.just(0.0),
    vy_m_s=st.floats(-9.0, 9.0) | st.just(0.0),
    age_s=st.floats(-0.1, 0.3),
)
def test_drone_has_passed_the_pad_as_near_as_its_way_since_the_jolt_came(
    x_m: float, y_m: float, vx_m_s: float, vy_m_s: float, age_s: float
) -> None:
    drone = drone_at(0.1, x_m, (vx_m_s, vy_m_s, 0.0), pad=pad_at())
    drone = replace(drone, position_enu_m=drone.position_enu_m + np.array([0.0, y_m, 0.0]), age_s=age_s)
    passed_m = signs_of(replace(situation(), drone=drone), CONFIG.touchdown).passed_m
    ago_s = np.linspace(0.0, max(JOLT_S + age_s, 0.0), 2001)
    way_m = np.hypot(x_m - vx_m_s * ago_s, y_m - vy_m_s * ago_s)
    assert passed_m == pytest.approx(way_m.min(), abs=0.002)


def test_where_it_passed_is_not_known_without_a_place() -> None:
    assert signs_of(replace(situation(), pad=None), CONFIG.touchdown).passed_m is None
    assert signs_of(replace(situation(), drone=None), CONFIG.touchdown).passed_m is None


@pytest.mark.parametrize(
    ("up_m_s2", "expected"),
    [
        (-TOUCHDOWN.falling_acceleration_m_s2 + 0.01, True),
        (-TOUCHDOWN.falling_acceleration_m_s2 - 0.01, False),
        (None, False),
        (math.nan, False),
    ],
)
def test_drone_that_is_pressed_and_does_not_fall_is_held_up(up_m_s2: float | None, *, expected: bool) -> None:
    assert does_not_fall(replace(JOLTED, acceleration_up_m_s2=up_m_s2), CONFIG) is expected
