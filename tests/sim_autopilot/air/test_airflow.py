"""The air about a box in the stream: by the laws of frictionless flow, and by the published lengths of wakes."""

from itertools import pairwise
from math import hypot, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_autopilot.air.airflow import FLOW_REACH, NO_CHANGE, TURBULENCE, Obstacle, body_of, flow_at

CAR = Obstacle(length_m=4.2, width_m=1.8, height_m=1.5)
SPHERE = Obstacle(length_m=2.0, width_m=2.0, height_m=1.0)
CUBE = Obstacle(length_m=3.0, width_m=3.0, height_m=3.0)
AHEAD_M_S = (-10.0, 0.0)
"""Of the air against a vehicle that drives 10 m/s through calm."""


def left_over(way_m: float, height_m: float, left_m: float) -> float:
    """Return the share of the stream from ahead that is left at a way behind the car, none where the air flows back."""
    flow = flow_at(CAR, (-0.5 * CAR.length_m - way_m, left_m, height_m), AHEAD_M_S)
    return 1.0 - flow.turbulence_m_s / (TURBULENCE * hypot(*AHEAD_M_S))


def test_air_over_a_sphere_is_half_as_fast_again() -> None:
    flow = flow_at(SPHERE, (0.0, 0.0, 1.0), AHEAD_M_S)
    np.testing.assert_allclose(flow.change_m_s, (-5.0, 0.0, 0.0), atol=1e-6)


@given(st.floats(1.0, FLOW_REACH * SPHERE.length_m, exclude_max=True))
def test_flow_about_a_sphere_fades_with_the_cube_of_the_distance(radii: float) -> None:
    added_m_s = flow_at(SPHERE, (0.0, 0.0, radii), AHEAD_M_S).change_m_s[0]
    assert added_m_s == pytest.approx(-5.0 / radii**3, abs=1e-6)


# Pressure coefficients of -0.4 to -0.6 are measured there: 1 - (1.18 to 1.26)^2.
def test_air_over_a_cars_roof_is_a_fifth_faster() -> None:
    assert flow_at(CAR, (0.0, 0.0, 1.5), AHEAD_M_S).change_m_s[0] == pytest.approx(-2.3, abs=0.3)


@given(st.floats(0.0, 6.3), st.floats(0.1, 1.5), st.floats(-12.0, 12.0), st.floats(-12.0, 12.0))
def test_no_air_flows_through_the_ellipsoid(yaw: float, rise: float, u: float, v: float) -> None:
    half = np.array([0.5 * CAR.length_m, 0.5 * CAR.width_m, CAR.height_m])
    unit = np.array([np.cos(yaw) * np.cos(rise), np.sin(yaw) * np.cos(rise), np.sin(rise)])
    outward = unit / half
    place, stream = 1.000001 * half * unit, np.array([u, v, 0.0])
    flow = flow_at(CAR, (float(place[0]), float(place[1]), float(place[2])), (u, v))
    through = (stream + flow.change_m_s) @ outward / np.linalg.norm(outward)
    assert abs(through) < 1e-3 * max(1.0, hypot(u, v))


def test_frictionless_flow_neither_begins_nor_turns_round_in_itself() -> None:
    place, step_m = np.array([1.9, 1.1, 1.8]), 1e-4
    slopes = np.empty((3, 3))
    for i in range(3):
        to = np.eye(3)[i] * step_m
        high, low = (flow_at(CAR, (*(place + way).tolist(),), (-9.0, 4.0)).change_m_s for way in (to, -to))
        slopes[:, i] = (np.array(high) - low) / (2.0 * step_m)
    assert abs(np.trace(slopes)) < 1e-5
    np.testing.assert_allclose(slopes, slopes.T, atol=1e-5)


# 1.4 to 1.6 heights are measured behind a cube on a wall (Martinuzzi and Tropea 1993).
def test_air_flows_back_behind_a_cube_for_one_and_a_half_of_its_heights() -> None:
    ends_m = 1.8 / 1.24 * CUBE.height_m
    along = [
        flow_at(CUBE, (-1.5 - way_m, 0.0, 0.01), AHEAD_M_S).change_m_s[0] for way_m in (ends_m - 0.1, ends_m + 0.1)
    ]
    assert along[0] > 10.0 > along[1]


@given(st.floats(0.01, 1.4), st.floats(-0.8, 0.8))
def test_wake_recovers_all_the_way(height_m: float, left_m: float) -> None:
    ways_m = np.linspace(0.05, 60.0, 50)
    shares = [left_over(way_m, height_m, left_m) for way_m in ways_m.tolist()]
    assert all(later >= earlier - 1e-9 for earlier, later in pairwise(shares))
    assert shares[-1] > 0.98


def test_wake_has_no_edge() -> None:
    for place in ((-5.0, 0.89999, 0.7), (-5.0, 0.0, 1.49999)):
        inside, outside = (flow_at(CAR, (place[0], place[1] * by, place[2] * by), AHEAD_M_S) for by in (1.0, 1.0001))
        np.testing.assert_allclose(inside.change_m_s, outside.change_m_s, atol=0.1)


def test_wake_lies_where_the_wind_blows_to() -> None:
    aside = (6.0, 8.0)
    away_m = 3.0
    lee = (0.6 * away_m, 0.8 * away_m, 0.5)
    assert flow_at(CUBE, lee, aside).turbulence_m_s > 1.0
    for beside in ((-lee[0], -lee[1], 0.5), (lee[1] * 2, -lee[0] * 2, 0.5), (*lee[:2], 3.1)):
        assert flow_at(CUBE, beside, aside).turbulence_m_s == 0.0
    u, v, _ = flow_at(CUBE, lee, aside).change_m_s
    assert u / sqrt(u * u + v * v) == pytest.approx(-0.6, abs=0.1)


@pytest.mark.parametrize("place", [(-5.0, 0.0, -0.1), (0.0, 0.0, 0.7), (-90.0, 0.0, 1.0)])
def test_nothing_changes_below_inside_and_far_away(place: tuple[float, float, float]) -> None:
    assert flow_at(CAR, place, AHEAD_M_S) is NO_CHANGE
    assert flow_at(CAR, (-5.0, 0.0, 1.0), (0.0, 0.0)) is NO_CHANGE


def test_superstructure_stands_on_its_deck() -> None:
    hangar = Obstacle(length_m=20.0, width_m=13.7, height_m=6.1, ahead_m=20.0, foot_m=6.5)
    assert flow_at(hangar, (0.0, 0.0, 7.0), AHEAD_M_S).change_m_s[0] > 9.0
    assert flow_at(hangar, (0.0, 0.0, 6.4), AHEAD_M_S) is NO_CHANGE
    assert flow_at(hangar, (0.0, 0.0, 12.7), AHEAD_M_S).turbulence_m_s == 0.0


def test_pad_on_the_road_is_not_in_the_wind() -> None:
    assert body_of((4.2, 1.8), 0.0) is None
    assert body_of((4.2, 1.8), 1.5) == CAR


@given(st.tuples(*3 * [st.floats(-200.0, 200.0)]), st.tuples(*2 * [st.floats(-60.0, 60.0)]))
def test_air_is_finite_and_no_faster_than_a_stream_about_a_body(
    place: tuple[float, float, float], stream: tuple[float, float]
) -> None:
    flow = flow_at(CAR, place, stream)
    assert 0.0 <= flow.turbulence_m_s <= TURBULENCE * hypot(*stream)
    assert np.isfinite(flow.change_m_s).all()
    # Across its length the car is a cylinder that is higher than wide: at its top 1 + 1.5 / 0.9 times as fast.
    assert hypot(*flow.change_m_s) <= 3.0 * hypot(*stream)
